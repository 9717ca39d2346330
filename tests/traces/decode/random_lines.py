"""Random lines with edges and unknown spans anywhere, for the comparison of two decoders."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
from hypothesis import strategies as st

from periph_sim.traces.capture.capture import Capture, Channel, Span

RATE = Fraction(1_000_000)


@st.composite
def captures(draw: st.DrawFn, names: tuple[str, ...]) -> Capture:
    """A capture with up to some hundred edges per line, at random densities. Lines often change at the same time."""
    steps = st.lists(
        st.tuples(st.integers(1, draw(st.sampled_from([1, 3, 12, 60]))), st.integers(0, 2 ** len(names) - 1))
    )
    at, changes = 0, []
    for step, turned in draw(steps):
        at += step
        changes.append((at, turned))
    length = at + draw(st.integers(1, 30))
    bound = st.integers(0, length)
    channels: list[Channel] = []
    for bit, name in enumerate(names):
        edges = np.array([at for at, turned in changes if turned >> bit & 1], np.int64)
        ends = sorted(draw(st.lists(bound, max_size=2, unique=True)))
        holes = tuple(Span(a, b) for a, b in zip(ends[::2], ends[1::2], strict=False))
        for hole in holes:  # no edge is within an unknown span
            inside = (edges >= hole.begin) & (edges < hole.end)
            edges = (
                edges[~inside] if np.count_nonzero(inside) % 2 == 0 else np.sort(np.append(edges[~inside], hole.end))
            )
        edges = np.unique(edges[(edges > 0) & (edges < length)])
        channels.append(Channel(name, bit, draw(st.integers(0, 1)), edges, holes))
    return Capture(Path("lines"), RATE, length, tuple(channels))
