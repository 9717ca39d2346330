"""Contents of a Capture as plain values, which can be compared and printed."""

from __future__ import annotations

from periph_sim.traces.formats import Capture


def edges(capture: Capture) -> dict[str, list[int]]:
    """Return the initial level and the edges of each channel by name."""
    return {channel.name: [channel.initial, *channel.edges.tolist()] for channel in capture.channels}


def facts(capture: Capture) -> tuple[object, ...]:
    """Return (rate, length, sampled)."""
    return capture.rate, capture.length, capture.sampled
