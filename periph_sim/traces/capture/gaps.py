"""The spans that were not recorded of some channels of a Capture, also as a note."""

from __future__ import annotations

from itertools import pairwise

from ...core.shorten import shorten
from .capture import Capture, Channel, Span

MOST_LISTED = 3  # spans with their times


def gaps(capture: Capture, *channels: Channel) -> list[Span]:
    """Return the spans in which the level of at least one of the channels is unknown, in order, neighbours joined."""
    known = [Span(0, 0), *capture.known(*channels), Span(capture.length, capture.length)]
    between = (Span(before.end, behind.begin) for before, behind in pairwise(known))
    return [span for span in between if span.begin < span.end]


def gap_notes(capture: Capture, *channels: Channel) -> list[str]:
    """Return one note on where and for how long the channels were not recorded, or none."""
    found = gaps(capture, *channels)
    if not found:
        return []
    names = " and ".join(shorten(channel.name, 60) for channel in channels)
    total = _length(capture, sum(span.end - span.begin for span in found))
    places = [f"{_at(capture, span.begin)} to {_at(capture, span.end)}" for span in found[:MOST_LISTED]]
    if len(found) > MOST_LISTED:
        places.append(f"and {len(found) - MOST_LISTED} more")
    spans = "1 span was" if len(found) == 1 else f"{len(found)} spans were"
    return [f"{names}: {spans} not recorded, {total} in all, {', '.join(places)}; nothing is decoded across them"]


def _at(capture: Capture, position: int) -> str:
    return f"sample {position}" if capture.rate is None else f"{float(position / capture.rate):.9f} s"


def _length(capture: Capture, positions: int) -> str:
    return f"{positions} samples" if capture.rate is None else f"{float(positions / capture.rate):.9f} s"
