"""Firmware that lets no simulated time pass is stopped and reported with its line; slow firmware is not."""

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
def test_an_endless_loop_is_stopped_with_its_line(tmp_path: Path, loop: str):
    result = Scene(load(case_file(tmp_path, loop))).run()
    assert result.verdict == "fail" and result.simulated_s == 0
    (message,) = result.stuck
    assert message in [
        f"dsp let no simulated time pass for 0.3 s of CPU time at line {line} of busy.py; "
        "give it an access, compute or spin"
        for line in LOOPS[loop]
    ]


def test_the_command_reports_a_stall_once_and_ends_with_status_1(periph_sim: Run, tmp_path: Path):
    came = periph_sim("run", str(case_file(tmp_path, "dsp.compute(1000)\n    while True:\n        pass")))
    assert (came.status, came.err) == (1, "") and "of busy.py" in came.out
    lines = came.out.splitlines()
    place = next(i for i, line in enumerate(lines) if "simulated; " in line)
    assert lines[place].startswith("6.667 us simulated; 0 I2C bytes, 0 SCI bytes, ")
    assert lines[place + 1].startswith("stuck: dsp let no simulated time pass")
    assert sum(line.startswith("stuck: ") for line in lines) == 1


def test_a_stall_in_another_thread_than_the_main_one_is_stopped(tmp_path: Path):
    results: list[Result] = []
    path = case_file(tmp_path, "while True:\n        pass")
    thread = threading.Thread(target=lambda: results.append(Scene(load(path)).run()))
    thread.start()
    thread.join()
    assert [result.verdict for result in results] == ["fail"] and "of busy.py" in results[0].stuck[0]


def test_a_stall_in_a_worker_process_is_stopped(tmp_path: Path):
    loop = "while True:\n        pass"
    files = [case_file(tmp_path, loop, name=name) for name in ("one", "two")]
    for one, name in zip(check(files, jobs=2), ("one", "two"), strict=True):
        assert any(f"of {name}.py" in finding.text for finding in one.findings)


def test_firmware_that_lets_time_pass_occasionally_is_not_stopped(tmp_path: Path):
    body = "for _ in range(6):\n        sum(range(3_000_000))\n        dsp.compute(10)"
    result = Scene(load(case_file(tmp_path, body, "500 ms"))).run()
    assert not any("simulated time" in message for message in result.stuck)


@pytest.mark.parametrize(("limit", "added"), [("300 ms", 1), ("0 s", 0)])
def test_firmware_is_watched_from_its_start_and_only_while_it_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, limit: str, added: int
):
    """A pending exception is delivered while the firmware runs, and not in later code of the thread."""
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


def test_continued_firmware_gets_its_full_limit_again_and_the_thread_ends_without_cpus(
    monkeypatch: pytest.MonkeyPatch,
):
    """Each check finds one more second of CPU time at the same simulated instant; more than three are too many."""

    class Busy:
        thread = 1
        stall_limit = 3.5

        def instant(self) -> tuple[int, int]:
            return 0, 0

    checks: list[int] = []
    stopped: list[int] = []
    watch = user_code._Watch()
    monkeypatch.setattr(user_code, "PERIOD", 0.001)
    monkeypatch.setattr(user_code, "_cpu_seconds", lambda thread: checks.append(thread) or float(len(checks)))
    monkeypatch.setattr(watch, "_stop", lambda cpu, at: stopped.append(len(checks)))
    busy = Busy()
    watch.add(busy)
    while len(checks) < 14:
        time.sleep(0.001)
    busy.thread = 0
    watcher = watch._thread
    assert stopped[:3] == [5, 9, 13] and watcher is not None
    del busy
    watcher.join(5)
    assert not watcher.is_alive()


@pytest.mark.parametrize("stopped", [True, False])
def test_a_pending_exception_is_raised_when_the_thread_leaves_the_firmware(
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


def test_the_cpu_time_of_the_process_is_used_if_that_of_a_thread_is_unavailable(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.delattr(time, "pthread_getcpuclockid", raising=False)
    assert 0 < user_code._cpu_seconds(threading.get_ident()) <= time.process_time()


def test_a_limit_of_0_disables_the_watch(tmp_path: Path):
    scene = Scene(load(case_file(tmp_path, "sum(range(20_000_000))", "0 s")))
    assert scene.units["dsp"].cpu.program.stall_limit == 0
    assert scene.run().simulated_s == 0.001


def test_firmware_under_a_debugger_is_recognized():
    """A debugger is recognized by the frame's own trace function; a whole scene under a tracer would take minutes."""
    frame = sys._getframe()
    assert not _debugged(frame)
    try:
        frame.f_trace = lambda *event: None
        assert _debugged(frame)
    finally:
        frame.f_trace = None
