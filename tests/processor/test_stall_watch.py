"""Firmware that lets no simulated time pass is stopped, with its line, wherever it runs; what takes long is not."""

from __future__ import annotations

import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace

import pytest

from periph_sim.interfaces.reports.baselines.check import check
from periph_sim.processor import user_code
from periph_sim.processor.python import program as python_program
from periph_sim.processor.user_code import _debugged
from periph_sim.scene.case.load import load
from periph_sim.scene.result import Result
from periph_sim.scene.scene import Scene
from tests.interfaces.commands.conftest import Run, periph_sim

__all__ = ["periph_sim"]  # a fixture

CASE = """\
name = "{name}"
duration = "1 ms"
stall_limit = "{limit}"

[unit.dsp]
firmware = "{firmware}"
modules = ["I2C-A"]

[[budget]]
name = "load"
measure = "cpu load"
max = "100 %"
"""

LOOPS = {
    "while True:\n        pass": (2, 3),
    "while True:\n        dsp.compute(0)": (2, 3),
    "while True:\n        try:\n            sum(range(50))\n        except Exception:\n            pass": (
        2,
        3,
        4,
        5,
        6,
    ),
}


def case_file(folder: Path, body: str, limit: str = "300 ms", name: str = "busy") -> Path:
    firmware = folder / f"{name}.py"
    firmware.write_text(f"def main(dsp, settings):\n    {body}\n", encoding="utf-8")
    path = folder / f"{name}.toml"
    path.write_text(CASE.format(name=name, firmware=firmware, limit=limit), encoding="utf-8")
    return path


@pytest.mark.parametrize("loop", LOOPS)
def test_endless_loop_is_stopped_with_its_line(tmp_path: Path, loop: str):
    result = Scene(load(case_file(tmp_path, loop))).run()
    assert result.verdict == "fail" and result.simulated_s == 0
    (told,) = result.stuck
    assert told in [
        f"dsp let no simulated time pass for 0.3 s of CPU time at line {line} of busy.py; "
        "give it an access, compute or spin"
        for line in LOOPS[loop]
    ]


def test_the_command_tells_it_once_and_ends_with_status_1(periph_sim: Run, tmp_path: Path):
    came = periph_sim("run", str(case_file(tmp_path, "dsp.compute(1000)\n    while True:\n        pass")))
    assert (came.status, came.err) == (1, "") and "of busy.py" in came.out
    lines = came.out.splitlines()
    place = next(i for i, line in enumerate(lines) if "simulated; " in line)
    assert lines[place].startswith("6.667 us simulated; 0 I2C bytes, 0 SCI bytes, ")
    assert lines[place + 1].startswith("stuck: dsp let no simulated time pass")
    assert sum(line.startswith("stuck: ") for line in lines) == 1


def test_it_works_in_another_thread_than_the_main_one(tmp_path: Path):
    results: list[Result] = []
    path = case_file(tmp_path, "while True:\n        pass")
    thread = threading.Thread(target=lambda: results.append(Scene(load(path)).run()))
    thread.start()
    thread.join()
    assert [result.verdict for result in results] == ["fail"] and "of busy.py" in results[0].stuck[0]


def test_it_works_in_parallel_worker_processes(tmp_path: Path):
    loop = "while True:\n        pass"
    files = [case_file(tmp_path, loop, name=name) for name in ("one", "two")]
    for one, name in zip(check(files, jobs=2), ("one", "two"), strict=True):
        assert any(f"of {name}.py" in finding.text for finding in one.findings)


def test_work_that_lets_time_pass_now_and_then_is_not_stopped(tmp_path: Path):
    body = "for _ in range(6):\n        sum(range(3_000_000))\n        dsp.compute(10)"
    result = Scene(load(case_file(tmp_path, body, "500 ms"))).run()
    assert not any("simulated time" in told for told in result.stuck)


@pytest.mark.parametrize(("limit", "added"), [("300 ms", 1), ("0 s", 0)])
def test_firmware_is_watched_from_its_start_and_only_while_it_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, limit: str, added: int
):
    """An exception on its way to the thread ends with the firmware's turn, not in what the thread does next."""
    calls: list[tuple[str, object]] = []
    watch = SimpleNamespace(
        add=lambda cpu: calls.append(("add", cpu.name)),
        leave=lambda thread: calls.append(("leave", thread)),
        stops=[1],
    )
    monkeypatch.setattr(python_program, "watch", watch)
    Scene(load(case_file(tmp_path, "for _ in range(3):\n        dsp.compute(1000)", limit))).run()
    assert calls.count(("add", "dsp")) == added
    assert set(calls) == ({("add", "dsp"), ("leave", threading.get_ident())} if added else set())


def test_firmware_that_goes_on_has_its_whole_limit_again_and_a_cpu_that_is_gone_is_let_go(
    monkeypatch: pytest.MonkeyPatch,
):
    """Each look finds one more second of CPU time spent at the same instant; more than three are too much."""

    class Busy:
        thread = 1
        stall_limit = 3.5

        def instant(self) -> tuple[int, int]:
            return 0, 0

    looks: list[int] = []
    stopped: list[int] = []
    watch = user_code._Watch()
    monkeypatch.setattr(user_code, "PERIOD", 0.001)
    monkeypatch.setattr(user_code, "_cpu_seconds", lambda thread: looks.append(thread) or float(len(looks)))
    monkeypatch.setattr(watch, "_stop", lambda cpu, at: stopped.append(len(looks)))
    busy = Busy()
    watch.add(busy)
    while len(looks) < 14:
        time.sleep(0.001)
    busy.thread = 0
    looker = watch._thread
    assert stopped[:3] == [5, 9, 13] and looker is not None
    del busy
    looker.join(5)
    assert not looker.is_alive()


@pytest.mark.parametrize("stopped", [True, False])
def test_an_exception_on_its_way_ends_with_the_turn_and_no_other_turn_has_one(
    monkeypatch: pytest.MonkeyPatch, stopped: bool
):
    raised: list[int] = []

    def raise_in(thread: int, what: type[BaseException]) -> None:
        raised.append(thread)
        raise what

    watch = user_code._Watch()
    monkeypatch.setattr(user_code, "_raise_in", raise_in)
    if stopped:
        watch._stopped.add(17)
    watch.leave(17)
    assert (raised, watch._stopped) == ([17] if stopped else [], set())


def test_where_the_system_tells_no_cpu_time_of_a_thread_that_of_the_process_counts(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.delattr(time, "pthread_getcpuclockid", raising=False)
    assert 0 < user_code._cpu_seconds(threading.get_ident()) <= time.process_time()


def test_limit_of_0_is_none(tmp_path: Path):
    scene = Scene(load(case_file(tmp_path, "sum(range(20_000_000))", "0 s")))
    assert scene.units["dsp"].cpu.program.stall_limit == 0
    assert scene.run().simulated_s == 0.001


def test_firmware_under_a_debugger_is_left_alone():
    """The frame's own trace function tells: tracing a whole scene would take minutes."""
    frame = sys._getframe()
    assert not _debugged(frame)
    try:
        frame.f_trace = lambda *event: None
        assert _debugged(frame)
    finally:
        frame.f_trace = None
