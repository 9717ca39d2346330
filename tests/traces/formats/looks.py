"""How tests look at a Capture: as plain values that compare and print well."""

from __future__ import annotations

from periph_sim.traces.formats import Capture


def edges(capture: Capture) -> dict[str, list[int]]:
    """Initial level and edges of each channel, by name."""
    return {channel.name: [channel.initial, *channel.edges.tolist()] for channel in capture.channels}


def facts(capture: Capture) -> tuple[object, ...]:
    """(rate, length, sampled)"""
    return capture.rate, capture.length, capture.sampled
