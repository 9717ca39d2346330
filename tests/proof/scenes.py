"""Small scenes with windows, and the brute force that judges each of their phases in a run of its own.

The brute force shares no code with the coverage: it writes the starts of each phase as text into the case's [inputs],
runs the case, and reads the result.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from itertools import groupby
from math import floor, lcm
from pathlib import Path
from typing import NamedTuple

import pytest

from periph_sim import FirmwareError, Scene, load
from periph_sim.core.kernel import SimulationStuck
from periph_sim.interfaces.reports.coverage import Coverage, choose, run_coverage
from periph_sim.proof.stretch import Job
from periph_sim.timing.verdict import Verdict
from tests.scene.runs import TIMING

MS = Fraction(1, 1000)
CYCLE = Fraction(1, 150_000_000)
WARM_UP, IN_A_ROW = 3, 3  # periods before a phase, and periods that have it
Inputs = Callable[[int], list[str]]  # a function from a phase to changes of the case

LISTENER = '''\
"""A receiver whose loop has the period of the host's frames, and is busy at one place of it."""

from dataclasses import dataclass

from periph_sim.firmware import start_pin, start_sci

PERIOD = 15_000  # cycles
SEEN, BAD = 34, 35


@dataclass
class Settings:
    begin: int = 0  # cycles from the start of a period to the busy span
    busy: int = 0
    low: int = 0  # a character that is read from this cycle of a period to `high` leads to `then`
    high: int = 0
    first: bool = False  # only the first character of a period does so
    then: str = "pin"
    turns: int = 0  # number of periods until the pin rises


def main(dsp, settings):
    start_pin(dsp, SEEN)
    start_pin(dsp, BAD)
    sci = start_sci(dsp, "SCI-A", brr=1)
    turn, due, seen = 0, [], [0]

    def listen(end):
        while dsp.cpu.time.cycle < end:
            if not dsp.spin(lambda: sci.SCIFFRX.RXFFST > 0, timeout=end - dsp.cpu.time.cycle):
                return
            sci.SCIRXBUF.all
            dsp.set_pin(SEEN)
            dsp.clear_pin(SEEN)
            is_first = turn != seen[-1]
            seen.append(turn)
            if settings.low <= dsp.cpu.time.cycle % PERIOD < settings.high and (is_first or not settings.first):
                react()

    def react():
        if settings.then == "pin":
            due.append(turn + settings.turns)
        elif settings.then == "hang":
            dsp.spin(lambda: sci.SCIPRI.FREE == 3)
        elif settings.then == "dies":
            import multiprocessing, os, signal
            if multiprocessing.parent_process():  # a worker
                os.kill(os.getpid(), signal.SIGKILL)
        elif settings.then == "Ctrl-C":
            raise KeyboardInterrupt
        else:
            raise ValueError("a character came too late")

    while True:
        listen(turn * PERIOD + settings.begin)
        dsp.compute(max(1, settings.busy))
        listen((turn + 1) * PERIOD)
        turn += 1
        if turn - 1 in due:
            dsp.set_pin(BAD)
            dsp.clear_pin(BAD)
'''
LISTENER_CASE = """\
name = "listener"
duration = "1 ms"
[unit.dsp]
firmware = "listener.py"
modules = ["SCI-A", "GPIO"]
pins = { SEEN = 34, BAD = 35 }
[host]
baud = 2343750
period = "100 us"
[[budget]]
name = "late"
measure = "from frame RX end to edge SEEN rise"
max = "1 us"
[[budget]]
name = "bad"
measure = "count of edge BAD rise"
max = 0
[[budget]]
name = "high-water"
measure = "fifo high-water"
max = 2
"""


def settings_of(**values: object) -> tuple[str, ...]:
    """Return changes of a case that set settings of its unit."""
    return tuple(f"unit.dsp.settings.{key}={value}" for key, value in values.items())


def listener(folder: Path) -> Path:
    """Write the listener and its case to a folder, and return the case. A period has 15,000 phases."""
    (folder / "listener.py").write_text(LISTENER, encoding="utf-8")
    (folder / "listener.toml").write_text(LISTENER_CASE, encoding="utf-8")
    return folder / "listener.toml"


def node(folder: Path) -> Path:
    """Write the RS-485 node of docs/serial.md to a folder, and return its case."""
    text = (TIMING.parent / "docs" / "serial.md").read_text(encoding="utf-8")
    for name, content in re.findall(r"<!-- file: (node\.\w+) -->\n```\w*\n(.*?)```", text, re.DOTALL):
        (folder / name).write_text(content, encoding="utf-8")
    return folder / "node.toml"


def covered(
    case: Path, changes: Sequence[str] = (), phases: range | None = None, step: int = 1, cycle: Fraction = CYCLE
) -> Coverage:
    """Cover phases of a case in this process. phases: all of a period if it is None."""
    job = Job(str(case), tuple(changes), rounds=3)
    only = None if phases is None else (phases[0] * cycle, phases[-1] * cycle)
    found = choose(job, step, only)
    run_coverage(found, 1)
    return found


class Alone(NamedTuple):
    """The result of a run with one phase. failures: the names of the broken budgets, "stuck", "ended by an error"."""

    failures: frozenset[str]
    verdicts: dict[str, Verdict]


def in_row(key: str, first: Fraction, period: Fraction, cycle: Fraction = CYCLE) -> Inputs:
    """Return the inputs of a case whose frames or rounds all have one phase, after periods without any.

    first: the time from which the phase of the first period is counted, in seconds.
    """

    per_second = lcm(10**9, int(1 / cycle))  # ticks

    def due(number: int, phase: int) -> Fraction:
        return Fraction(round(first * per_second) + floor(number * period * per_second), per_second) + phase * cycle

    def inputs(phase: int) -> list[str]:
        starts = [in_seconds(due(WARM_UP + number, phase)) for number in range(IN_A_ROW)]
        end = due(WARM_UP + IN_A_ROW, phase) - Fraction(1, per_second)
        return [f"inputs.{key}={starts}", f"duration={in_seconds(end)}"]

    return inputs


def in_seconds(time: Fraction) -> str:
    return f"{time.numerator}/{time.denominator} s"


def each_alone(case: Path, changes: Sequence[str], inputs: Inputs, phases: Iterable[int]) -> dict[int, Alone]:
    """Run each phase in a run of its own."""
    return {phase: _alone(case, [*changes, *inputs(phase)]) for phase in phases}


def _alone(case: Path, changes: list[str]) -> Alone:
    try:
        result = Scene(load(case, changes)).run()
    except (FirmwareError, SimulationStuck):
        return Alone(frozenset({"ended by an error"}), {})
    failures = {verdict.name for verdict in result.budgets if verdict.broken}
    if result.stuck and result.verdict == "fail":
        failures.add("stuck")
    return Alone(frozenset(failures), {verdict.name: verdict for verdict in result.budgets})


Ends = tuple[str, int, int, bool]  # name, first and last phase of a window, True if both neighbours hold


def windows_in(alone: dict[int, Alone], left_out: Iterable[str] = ()) -> set[Ends]:
    """Return the windows of consecutive phases."""
    found: set[Ends] = set()
    low, high = min(alone), max(alone)
    for name in {name for one in alone.values() for name in one.failures}.difference(left_out):
        for fails, group in groupby(sorted(alone), lambda phase, name=name: name in alone[phase].failures):  # type: ignore[misc]
            ends = [*group]
            if fails:
                found.add((name, ends[0], ends[-1], low < ends[0] and ends[-1] < high))
    return found


def ends_of(coverage: Coverage) -> set[Ends]:
    """Return the windows of a coverage."""
    return {(one.name, one.first, one.last, one.is_closed) for one in coverage.windows}


def assert_same(coverage: Coverage, alone: dict[int, Alone], near: float = 0) -> None:
    """Raise AssertionError unless a coverage has the verdicts, windows and worst values of the brute force.

    near: the difference of worst values, in microseconds, between a run of one phase and one of many, in which a wait
        is in another of its passes.
    """
    found = coverage.found
    assert ends_of(coverage) == windows_in(alone, coverage.case.left_out)
    assert not found.drifting
    names = {budget.name for budget in coverage.case.case.budget}
    assert not any(alone[phase].failures & names for phase in set(found.held) - found.failed.keys())
    for phase, failures in found.failed.items():
        assert failures == alone[phase].failures - coverage.case.left_out.keys()
    for name in names:
        values = {phase: one.verdicts[name] for phase, one in alone.items() if name in one.verdicts}
        assert bool(found.judged.get(name)) == any(one.passed or one.broken for one in values.values())
        if any(left.endswith(f" of {name}") for left in coverage.case.left_out):
            continue  # brute force judges its percentiles, too
        run = [one for phase, one in values.items() if phase in found.failed or phase in found.held]
        margins = [one.margin for one in run if one.margin is not None]
        if margins:
            assert found.worst[name].verdict.margin == pytest.approx(min(margins), abs=near), name
