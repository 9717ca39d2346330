"""A scene that is deleted or closed: its firmware ends where it waits, without an effect, and its memory is freed."""

from __future__ import annotations

import gc
import subprocess
import sys
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from threading import Thread, get_ident
from typing import Any
from weakref import ref

import pytest

from periph_sim import Dsp, Scene, load
from periph_sim.core.records import Kind
from periph_sim.core.sampler import watch
from periph_sim.processor.image.program import ImageProgram
from tests.scene.runs import TIMING, recorded
from tests.scene.small import case, given, scene_with, unit

CASES = sorted(path.name for path in TIMING.glob("*.toml"))
LENGTH = Fraction(1, 1000)


def run(firmware: Callable[[Dsp], None], **more: Any) -> Scene:
    """Return a scene that has run for a short time."""
    scene = scene_with(firmware, ["I2C-A"], **more)
    scene.run(LENGTH)
    return scene


def waiting_firmware(at_end: Callable[[], object]) -> Callable[[Dsp], None]:
    """Return firmware that waits for ever, and calls `at_end` when it is ended."""

    def main(dsp: Dsp) -> None:
        try:
            dsp.spin(lambda: False)
        finally:
            at_end()

    return main


@pytest.mark.parametrize("name", CASES)
def test_the_parts_of_a_case_do_not_keep_its_scene_alive(name: str) -> None:
    scene = Scene(load(TIMING / name), keep_values=True)
    units, gone = list(scene.units.values()), ref(scene)
    scene.run(LENGTH)
    assert gone() is scene
    del scene
    gc.collect()
    assert gone() is None
    python = [dsp.program for dsp in units if not isinstance(dsp.program, ImageProgram)]  # an image has no stack
    assert [program.place() for program in python] == [None] * len(python)


def test_firmware_of_a_deleted_scene_ends_where_it_waits_without_records() -> None:
    ended: list[int] = []

    def works(dsp: Dsp) -> None:
        try:
            with dsp.span("work"):
                dsp.spin(lambda: False)
        finally:
            ended.append(dsp.processor.time.cycle)
            dsp.compute(1000)  # takes no time any more
            ended.append(-1)

    scene, records = recorded(case(unit={"dsp": unit("I2C-A")}), [Kind.SPAN, Kind.WAIT], given(dsp=works))
    scene.run(LENGTH)
    count = len(records)
    assert count and not ended
    now = scene.units["dsp"].clock.cycle_at(scene.kernel.now)
    del scene
    assert len(ended) == 1 and ended[0] <= now
    assert len(records) == count


def test_firmware_that_catches_its_end_does_not_prevent_the_deletion() -> None:
    tried: list[int] = []

    def stubborn(dsp: Dsp) -> None:
        while True:
            try:
                dsp.spin(lambda: False)
            except BaseException:
                tried.append(1)
                if len(tried) > 3:
                    raise

    scene = run(stubborn)
    del scene  # returns
    assert tried


def test_a_scene_may_be_deleted_during_the_run_of_another() -> None:
    ended: list[str] = []

    def dropping(dsp: Dsp) -> None:
        dsp.compute(1000)
        held.clear()
        dsp.compute(1000)
        ended.append("second")

    held = [run(waiting_firmware(lambda: ended.append("first")))]
    run(dropping)
    assert ended == ["first", "second"]


def in_its_own_thread(work: Callable[[], object]) -> None:
    thread = Thread(target=work)
    thread.start()
    thread.join()


def test_firmware_of_a_scene_freed_in_another_thread_ends_when_its_own_thread_builds_the_next() -> None:
    ended: list[int] = []
    firmware = waiting_firmware(lambda: ended.append(get_ident()))
    held = [run(firmware)]
    in_its_own_thread(held.clear)
    assert not held and not ended
    held.append(scene_with(firmware, ["I2C-A"]))
    assert ended == [get_ident()]


def test_firmware_ends_at_the_latest_with_the_thread_that_runs_it() -> None:
    ended: list[int] = []
    held: list[Scene] = []

    def build() -> None:
        for _ in range(3):
            held.append(run(waiting_firmware(lambda: ended.append(1))))
        in_its_own_thread(held.pop)

    in_its_own_thread(build)
    assert len(held) == 2 and len(ended) == 3


def test_an_endless_finally_is_stopped_when_the_scene_is_deleted() -> None:
    begun: list[int] = []

    def endless() -> None:
        begun.append(1)
        while True:
            pass

    scene = run(waiting_firmware(endless), stall_limit="100 ms")
    del scene
    assert begun


def test_a_closed_scene_is_free_although_its_subscriber_refers_to_it() -> None:
    levels: list[int] = []

    def run_one() -> ref[Scene]:
        scene = Scene(load(TIMING / "responder.toml"))
        watch([scene.wires["SDA"]], lambda tick, level: levels.append(scene.measured.wire("SCL").level))
        scene.run(LENGTH)
        return ref(scene)

    gone = run_one()
    gc.collect()
    scene = gone()
    assert levels and scene is not None
    scene.close()
    scene.close()  # has no effect
    del scene
    gc.collect()
    assert gone() is None


DEVICE = """
class Device:
    def __init__(self, bus):
        self.bus = bus

    def on_write(self, byte):
        for _ in range(10_000):
            self.bus.after("1 s", self.later)
        return True

    def later(self): ...
"""
CASE = """
name = "chain"
duration = "60 ms"

[device.mine]
model = "mine.py"
address = 0x42

[controller]
first = "1 ms"
period = "{period}"
rate = "400 kHz"

[[controller.request]]
name = "mine"
address = 0x42
count = 0
write = "{written}"

[[budget]]
name = "until the end"
measure = "from edge SCL fall to bus NACK"
max = "1 s"
"""
RELEASE = """
import sys, threading
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene

scene = Scene(load(sys.argv[1]))
result = scene.run()
print(result.verdict, result.events, flush=True)
held = [scene]
del scene, result
threading.stack_size(256 * 1024)
thread = threading.Thread(target=held.clear)
thread.start()
thread.join()
print("released")
"""


@pytest.mark.parametrize(
    ("device", "period", "written"),
    [
        (DEVICE, "30 ms", "01"),
        (DEVICE.replace("10_000", "0"), "1 ms", " ".join(["01"] * 20)),
    ],
    ids=["20 000 calls that are due after the end", "10 000 edges that nothing ends"],
)
def test_a_scene_is_released_without_recursion(tmp_path: Path, device: str, period: str, written: str):
    (tmp_path / "mine.py").write_text(device, "utf-8")
    (tmp_path / "case.toml").write_text(CASE.format(period=period, written=written), "utf-8")
    done = subprocess.run(
        [sys.executable, "-c", RELEASE, str(tmp_path / "case.toml")], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout.splitlines()[-1:], done.stderr) == (0, ["released"], "")
