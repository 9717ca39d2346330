"""What scenarios change: names of the case with arrays go in; ticks of every scenario come out, rounded as an edge run.

    ticks = nearest(seconds * ticks per second / (1 + ppm / 10^6))

Durations are whole nanoseconds, ppm are numbers as a case file writes them, seeds are whole.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.chip import NEVER
from ...core.suggest import did_you_mean
from .clock import CpuClock, IntOrInts, Ints, check_length
from .errors import BadSchedule, refuse
from .receiver import Line, line
from .structure import Structure

GHZ = 1_000_000_000
PPM = 1_000_000


@dataclass(frozen=True)
class Ratio:
    """num / den of each scenario, or of all."""

    num: IntOrInts
    den: IntOrInts

    def nearest(self, value: IntOrInts) -> Ints:
        return np.asarray((2 * value * self.num + self.den) // (2 * self.den), np.int64)

    def down(self, value: IntOrInts) -> Ints:
        return np.asarray(value * self.num // self.den, np.int64)

    def most(self, value: IntOrInts) -> int:
        """The largest product that `nearest` makes of this value, or any scenario's."""
        return 2 * int(np.max(value)) * int(np.max(self.num)) + int(np.max(self.den))


@dataclass(frozen=True)
class Inputs:
    """Of each scenario, or of all, in ticks from the begin of the run; ns_ratio of the periods.

    host_first, controller_first: when the first frame and round are due. frame, round_: ticks of a period, exact.
    cost: least and most cycles of the models. end: when the run ends.
    """

    scenarios: int
    rounds: int
    clock: CpuClock
    seeds: Ints
    line: Line
    host_first: Ints
    frame: Ratio
    host_jitter: int
    paced_by_pause: bool
    controller_first: Ints
    round_: Ratio
    controller_jitter: int
    cost: tuple[Ints, Ints]
    end: Ints

    @property
    def frames_apart(self) -> int:
        """Ticks between two frames of the host, at least."""
        return int(np.min(self.frame.down(1))) - (0 if self.paced_by_pause else self.host_jitter)

    def due(self, number: int) -> Ints:
        """When a round is due."""
        return self.controller_first + self.round_.down(number)


DURATIONS = ("host.first", "host.period", "controller.first", "controller.period")


def names_of(structure: Structure) -> tuple[str, ...]:
    """What a scenario may change."""
    cost = "model_cost" if structure.closed.case.unit[structure.unit].settings.get("model_cost") != "estimate" else ""
    models = (f"unit.{structure.unit}.settings.{cost}",) if cost else ()
    return ("seed", *DURATIONS, "host.ppm", f"unit.{structure.unit}.ppm", *models)


def inputs_of(structure: Structure, changes: Mapping[str, Any], rounds: int, end: int | None = None) -> Inputs:
    """BadSchedule for a name that no scenario can change, or arrays that do not fit.

    end: the tick at which all runs end; None: a tick before one more round is due.
    """
    if type(rounds) is not int or rounds < 1:
        raise BadSchedule(f"rounds is {rounds!r}; expected a whole number above 0")
    given, scenarios = _arrays(structure, changes)
    controller, host, per_second = structure.controller, structure.host, structure.per_second

    def value(name: str, of_case: Fraction) -> IntOrInts:
        return given[name] if name in given else _nanoseconds(name, of_case)

    of_controller = _ratio(per_second, _fractions(None, controller.ppm))
    of_host = _ratio(per_second, _fractions(given.get("host.ppm"), host.ppm))
    cycle = _cycle(structure, given.get(f"unit.{structure.unit}.ppm"))
    first, period = value("controller.first", controller.first), value("controller.period", controller.period)
    frame, host_first = value("host.period", host.period), value("host.first", host.first)
    for ratio, length in ((of_controller, first), (of_host, host_first), (of_controller, period), (of_host, frame)):
        if ratio.most(length) >= NEVER:
            raise BadSchedule("a duration is so long, or a ppm has so many digits, that its ticks do not fit int64")
    round_, frames = Ratio(period * of_controller.num, of_controller.den), Ratio(frame * of_host.num, of_host.den)
    controller_first = np.broadcast_to(of_controller.nearest(first), scenarios)
    longest = min(cycle.longest, *((NEVER - 1) // int(np.max(ratio.den)) for ratio in (round_, frames)))
    most = int(np.max(controller_first)) + (rounds + 1) * (int(np.max(round_.num)) // int(np.min(round_.den)) + 1)
    host_first = np.broadcast_to(of_host.nearest(host_first), scenarios)
    cost = _cost(structure, given, scenarios)
    reads = sum(bus.stop + structure.terms.gap for bus in structure.terms.bus)
    models = cycle.most(int(cost[1].max()))
    check_length(max(most, int(np.max(host_first))) + reads + models, longest, per_second)
    if abs(structure.case.seed) >= NEVER:
        raise BadSchedule(f"seed is {structure.case.seed}; expected less than 2^62")
    ends = controller_first + round_.down(rounds) - 1 if end is None else np.full(scenarios, end, np.int64)
    jitter = int(np.max(of_host.nearest(_nanoseconds("host.jitter", host.jitter))))
    made = Inputs(
        scenarios,
        rounds,
        cycle,
        np.broadcast_to(np.asarray(given.get("seed", structure.case.seed), np.int64), scenarios),
        line(host, per_second),
        host_first,
        frames,
        jitter,
        host.paced_by == "pause",
        controller_first,
        round_,
        int(of_controller.nearest(_nanoseconds("controller.jitter", controller.jitter))),
        cost,
        ends,
    )
    _check_frames(structure, made)
    return made


def _arrays(structure: Structure, changes: Mapping[str, Any]) -> tuple[dict[str, NDArray[Any]], int]:
    known, given = names_of(structure), {}
    for name, values in changes.items():
        if name not in known:
            raise BadSchedule(f"scenarios cannot change {name!r}; {did_you_mean(name, known)}")
        array = np.atleast_1d(np.asarray(values))
        ppm = name.endswith(".ppm")
        if array.ndim != 1 or not array.size or array.dtype.kind not in ("iuf" if ppm else "iu"):
            kind = "numbers" if ppm else "whole numbers (of nanoseconds, where it is a time)"
            raise BadSchedule(f"changes[{name!r}] is {array.dtype} of shape {array.shape}; expected one row of {kind}")
        if not ppm and array.max() >= NEVER:
            raise BadSchedule(f"changes[{name!r}] holds {array.max()}; expected less than 2^62")
        if name != "seed" and not ppm and array.min() < 0:
            raise BadSchedule(f"changes[{name!r}] holds {array.min()}; expected 0 ns or more")
        given[name] = array if ppm else array.astype(np.int64)
    sizes = {array.size for array in given.values() if array.size > 1} or {1}
    if len(sizes) > 1:
        told = ", ".join(f"{name}: {array.size}" for name, array in given.items())
        raise BadSchedule(f"changes have different numbers of scenarios ({told}); give each the same, or one")
    return given, sizes.pop()


def _nanoseconds(name: str, seconds: Fraction) -> int:
    exact = seconds * GHZ
    if exact.denominator != 1:
        raise BadSchedule(f"{name} of the case is {seconds} s, which is no whole number of nanoseconds")
    return exact.numerator


def _fractions(values: NDArray[Any] | None, of_case: Fraction) -> tuple[Ints | None, list[Fraction]]:
    """Which of the different values each scenario has; None: all have the one."""
    if values is None:
        return None, [of_case]
    unique, place = np.unique(values, return_inverse=True)
    found = [Fraction(str(value)) for value in unique.tolist()]
    return (None if len(found) == 1 else place.astype(np.int64)), found


def _spread(place: Ints | None, ratios: list[Fraction]) -> tuple[IntOrInts, IntOrInts]:
    if place is None:
        return ratios[0].numerator, ratios[0].denominator
    if any(max(ratio.numerator, ratio.denominator) >= NEVER for ratio in ratios):
        raise BadSchedule("a ppm has so many digits that its ticks do not fit int64")
    num = np.array([ratio.numerator for ratio in ratios], np.int64)
    den = np.array([ratio.denominator for ratio in ratios], np.int64)
    return num[place], den[place]


def _ratio(per_second: int, ppm: tuple[Ints | None, list[Fraction]]) -> Ratio:
    """Ticks of a nanosecond of clocks that are off."""
    place, values = ppm
    return Ratio(*_spread(place, [Fraction(per_second, GHZ) / (1 + value / PPM) for value in values]))


def _cycle(structure: Structure, ppm: NDArray[Any] | None) -> CpuClock:
    place, values = _fractions(ppm, structure.case.unit[structure.unit].ppm)
    nominal = structure.sysclk
    return CpuClock(*_spread(place, [structure.per_second / (nominal * (1 + value / PPM)) for value in values]))


def _cost(structure: Structure, given: Mapping[str, NDArray[Any]], scenarios: int) -> tuple[Ints, Ints]:
    name = f"unit.{structure.unit}.settings.model_cost"
    hz = structure.sysclk
    if name in given:
        most = int(given[name].max())
        check_length(most, (NEVER - 1) // hz.numerator, GHZ)
        cycles = -(-given[name] * hz.numerator // (GHZ * hz.denominator))
        one = np.broadcast_to(cycles, scenarios)
        return one, one
    least, most = (-int(-cost * hz // 1) for cost in (structure.cost.least, structure.cost.most))
    return np.full(scenarios, least, np.int64), np.full(scenarios, most, np.int64)


def _check_frames(structure: Structure, made: Inputs) -> None:
    """Frames may neither overlap nor come so close that two interrupts meet one piece of code."""
    terms, case = structure.terms, structure.case
    apart = made.frames_apart
    longest = max(table.length for code in terms.reads for table in (code.clear, code.after, *code.more))
    busy = (terms.service + max(longest, terms.start.length) + terms.poll_two) * terms.cycle
    if apart <= made.line.end + 1:
        raise refuse(case.name, "a host frame may be due while the one before is still sent")
    if apart - structure.receiver.period * terms.cycle <= busy:
        raise refuse(case.name, "service routines of host frames come so close that two meet in one piece of code")
