"""Why a worst occurrence was as it was, in texts for the page: a Chain goes in; steps and shares come out."""

from __future__ import annotations

from dataclasses import dataclass

from ...explain.chain import Chain, FirmwarePlace, Part
from ...timing.format_value import figure

MOST = 6  # parts
NOTHING = figure(0.0, "us")


@dataclass(frozen=True)
class Step:
    """tick, at: from the begin of the occurrence; length: "" of an instant; place: in the firmware, "" if not known."""

    tick: int
    at: str
    length: str
    what: str
    place: str


@dataclass(frozen=True)
class Share:
    """What a part of the time went into. percent: of the occurrence; more: than in the typical occurrence, or ""."""

    what: str
    length: str
    percent: float
    place: str
    more: str


@dataclass(frozen=True)
class Explanation:
    """typical: the length of the least critical occurrence, "" where it is not known."""

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
