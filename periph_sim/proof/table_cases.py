"""Check whether a case can have a closed table: it needs one unit with an image, and only parts with comparable states.

The glossary in `periph_sim.proof` has the terms.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from fractions import Fraction

from ..bus.uart.frame_format import UartFormat
from ..scene.case.model import Case
from ..scene.case.wiring import wiring_of
from .free_run import NotClosed
from .normal_state import LONG_PAST


def check(case: Case, with_pairs: bool = False) -> tuple[str, ...]:
    """Return the ignored attributes.

    Raise NotClosed, with all reasons, if the case can have no closed table. with_pairs: True if the case may have both
    rounds and frames.
    """
    reasons = list(_reasons(case))
    if _is_pair(case) and not with_pairs:
        reasons.insert(0, "rounds and frames start independently of each other")
    if reasons:
        raise NotClosed("; ".join(reasons))
    return ("head._number", "host._number")


def _is_pair(case: Case) -> bool:
    """Return True if the case has both rounds and frames."""
    return case.controller is not None and case.host is not None


def _reasons(case: Case) -> Iterator[str]:
    """Yield the reasons why a case can have no table."""
    if len(case.unit) > 1:
        yield "it has more than one unit, and the phases of their clocks are free"
    for name, unit in case.unit.items():
        if unit.sources:
            yield f"unit {name} runs C sources, whose times are estimates; build them for the chip, and give the image"
        elif not unit.image:
            yield f"unit {name} runs Python firmware, which has a part of its state on a stack"
        if unit.ppm:
            other = "host" if case.controller is None else "controller"
            why = "so a cycle is not a whole number of ticks; give the difference of the clocks to"
            yield f"unit.{name}.ppm is not 0, {why} {other}.ppm"
    for table in ("chip", "device", "serial", "fault", "outside", "transceiver", "rounds", "watch"):
        if getattr(case, table):
            yield f"the state of [{table}] is not compared"
    for name, length in _longest(case).items():
        if length * LONG_PAST > 1:
            yield f"{name} lasts longer than {1000 / LONG_PAST:g} ms, so its effects can outlast a rest"
    if _is_pair(case):
        for name, pins in wiring_of(case).pins.items():
            wire, count = Counter(pins.values()).most_common(1)[0]
            if count > 1:
                yield f"unit {name} has {count} pins at the wire {wire}, and could see frames at each"
    if case.host is not None and case.host.motion.get("kind") != "static":
        yield 'the bytes of the frames differ; add motion = { kind = "static" } to [host] for equal bytes'


def _longest(case: Case) -> dict[str, Fraction]:
    """Return the durations, in seconds, that decide how long a round or frame has effects after its end, by name.

    A controller waits until the bus was free for a part of a bit. A frame counts as over after two silent characters.
    """
    found: dict[str, Fraction] = {}
    if case.host is not None:
        baud = case.host.baud * (1 + Fraction(case.host.error) / 100)
        found["a character of the host"] = Fraction(UartFormat().length) / baud
    if case.controller is not None:
        one, bit = case.controller, 1 / case.controller.rate
        found["a bit of the controller"] = max(bit, (one.low or bit / 2) + (one.high or bit / 2))
        found["controller.filter"] = one.filter
    return found
