"""A hook or file of a user's device that never returns ends the run with its line and status 1."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim.processor.user_code import FirmwareStalled, NoProgress, UserCode
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene
from tests.interfaces.commands.conftest import Run, periph_sim
from tests.processor.user_case import write_case

__all__ = ["periph_sim"]  # a fixture

DEVICE = """\
class Device:
    def __init__(self, bus):
        self.bus = bus

    def again(self):
        {again}

    def on_write(self, byte):
        {on_write}

    def on_read(self):
        {on_read}
"""
LOOP = "while True: pass"
CAUGHT = "while True:\n            try: sum(range(50))\n            except Exception: pass"


def case_of(folder: Path, **hooks: str) -> Path:
    text = DEVICE.format(**{"again": "pass", "on_write": "pass", "on_read": "return 1"} | hooks)
    still = "def main(dsp, settings):\n    pass\n"
    return write_case(folder, "busy", still, text, keys='duration = "10 ms"\nstall_limit = "300 ms"')


@pytest.mark.parametrize(
    ("hooks", "lines"),
    [
        ({"on_write": LOOP}, (9,)),
        ({"on_read": LOOP}, (12,)),
        ({"on_read": CAUGHT}, (12, 13, 14)),
        ({"on_write": "self.bus.after('1 us', self.again)", "again": LOOP}, (6,)),
    ],
    ids=["on_write", "on_read", "that catches", "after"],
)
def test_a_hook_that_never_returns_is_stopped_with_its_line(tmp_path: Path, hooks: dict[str, str], lines: tuple[int]):
    result = Scene(load(case_of(tmp_path, **hooks))).run()
    assert result.verdict == "fail" and 0.001 < result.simulated_s < 0.002
    (message,) = result.stuck
    assert message in [
        f"device mine did not return within 0.3 s of CPU time at line {line} of mine.py" for line in lines
    ]


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [("class Device:", "while True: pass\nclass Device:", 1), ("self.bus = bus", LOOP, 3)],
    ids=["the file", "__init__"],
)
def test_a_file_or_constructor_that_never_returns_ends_the_run_at_its_start(
    periph_sim: Run, tmp_path: Path, old: str, new: str, line: int
):
    case = case_of(tmp_path)
    device = tmp_path / "mine.py"
    device.write_text(device.read_text("utf-8").replace(old, new), "utf-8")
    message = f"device mine did not return within 0.3 s of CPU time at line {line} of mine.py"
    result = Scene(load(case)).run()
    assert (result.verdict, result.simulated_s, result.stuck) == ("fail", 0, [message])
    came = periph_sim("run", str(case))
    assert (came.status, came.err) == (1, "") and f"stuck: {message}" in " ".join(came.out.split())


def test_a_hook_that_returns_in_time_is_not_stopped(tmp_path: Path):
    result = Scene(load(case_of(tmp_path, on_read="return sum(range(100_000)) & 0xFF"))).run()
    assert result.stuck == [] and result.counts["rounds"] == 2


def test_a_limit_of_0_disables_the_watch_of_a_hook():
    guard = UserCode("device mine", 0.0)
    seen: list[int] = []
    assert guard(lambda: seen.append(guard.thread)) is None
    assert seen == [0], "no thread is registered with the watch"


def test_each_call_is_a_new_instant_and_a_nested_hook_belongs_to_the_outer_call():
    guard = UserCode("device mine", 10.0)
    seen: list[tuple[int, int]] = []
    guard(lambda: guard(lambda: seen.append(guard.instant())))
    guard(lambda: seen.append(guard.instant()))
    assert seen == [(1, 0), (2, 0)] and guard.thread == 0


def test_a_stall_detected_by_the_caller_is_reported():
    def stopped() -> None:
        raise NoProgress

    with pytest.raises(FirmwareStalled, match="device mine did not return within 10 s of CPU time"):
        UserCode("device mine", 10.0)(stopped)
