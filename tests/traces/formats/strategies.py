"""Random captures for property tests, with any edges, unknown spans and rates."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

from hypothesis import strategies as st

from periph_sim.traces.capture.capture import channel_of
from periph_sim.traces.formats import Capture, Channel

RATES = [1, 1000, 115_200, 4_000_000, 12_000_000, 24_000_000, 500_000_000, 3_000_000_000, Fraction(10**8, 3)]
NAMES = ["SCL", "SDA", "tb.bus.scl", "D0", "clock, slow", 'say "hi"', "Empfänger", "a b", "bus[3]"]


@st.composite
def channels(draw: st.DrawFn, name: str, index: int, length: int, holes: bool) -> Channel:
    at = sorted(draw(st.sets(st.integers(1, length - 1), max_size=20))) if length > 1 else []
    values = [0, 1, None] if holes else [0, 1]
    states = [draw(st.sampled_from(values)) for _ in range(len(at) + 1)]
    return channel_of(name, index, [0, *at], states, length)


@st.composite
def captures(draw: st.DrawFn, holes: bool = True) -> Capture:
    """A capture with up to four channels of different names. holes: True if there can be unknown spans."""
    length = draw(st.one_of(st.integers(1, 50), st.integers(1, 10**12)))
    names = draw(st.lists(st.sampled_from(NAMES), min_size=1, max_size=4, unique=True))
    lines = tuple(draw(channels(name, index, length, holes)) for index, name in enumerate(names))
    return Capture(Path("drawn"), Fraction(draw(st.sampled_from(RATES))), length, lines)
