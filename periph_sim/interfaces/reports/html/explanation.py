"""Text of the explanation of a worst occurrence for the page: steps and shares of a Chain."""

from __future__ import annotations

from dataclasses import dataclass

from ....timing.verdict import figure
from ..explain.chain import Chain, FirmwarePlace, Part

MOST = 6  # parts shown at most
NOTHING = figure(0.0, "us")


@dataclass(frozen=True)
class Step:
    """One event of the explanation.

    tick, at: its time from the begin of the occurrence, as a number and as text.
    length: its duration as text, "" for an instant.
    place: its location in the firmware, "" if unknown.
    """

    tick: int
    at: str
    length: str
    what: str
    place: str


@dataclass(frozen=True)
class Share:
    """A part of the time of an occurrence, in percent. more: the excess over the typical occurrence, or ""."""

    what: str
    length: str
    percent: float
    place: str
    more: str


@dataclass(frozen=True)
class Explanation:
    """typical: the length of the least critical occurrence, "" if unknown."""

    steps: tuple[Step, ...]
    shares: tuple[Share, ...]
    typical: str


def explanation(chain: Chain) -> Explanation:
    def length(ticks: int) -> str:
        return figure(float(chain.us(ticks)), "us")

    more = {(part.doing, part.what): part.length for part in chain.more}

    def share(part: Part) -> Share:
        ticks = more.get((part.doing, part.what), 0)
        times = f" in {part.count} times" if part.count > 1 else ""
        percent = round(100 * part.length / chain.length, 1) if chain.length else 0.0
        signed = f"{'+' * (ticks > 0)}{length(ticks)}"
        known = "" if signed.lstrip("+-") == NOTHING else signed
        return Share(f"{part}{times}", length(part.length), percent, _place(part.place), known)

    return Explanation(
        steps=tuple(
            Step(one.at, length(one.at), "" if one.length is None else length(one.length), one.what, _place(one.place))
            for one in chain.steps
        ),
        shares=tuple(share(part) for part in chain.parts[:MOST]),
        typical="" if chain.typical is None else length(chain.typical),
    )


def _place(place: FirmwarePlace | None) -> str:
    return "" if place is None else str(place)
