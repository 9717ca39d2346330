"""How files of time stamps were sampled: the grid their edges lie on, and what is exact."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.traces import formats
from periph_sim.traces.capture.capture import BadCapture, Capture, channel_of, channel_of_edges
from periph_sim.traces.capture.sampling import LONGEST_PAUSE, grid_of, is_exact, on_samples, sample_step, stamp_notes
from tests.traces.formats.looks import edges

PICOSECONDS = 10**12


def stamped(at: list[int], rate: int | None = 10**9, sampled: bool = False, exact: bool = False) -> Capture:
    length = at[-1] + 9 if at else 9
    line = channel_of("SCL", 0, [0, *at], [n & 1 for n in range(len(at) + 1)], length)
    return Capture(Path("stamps"), None if rate is None else Fraction(rate), length, (line,), sampled, exact=exact)


def test_the_step_is_the_coarsest_grid_that_holds_all_edges():
    """125 MHz, told in nanoseconds, from any start."""
    assert grid_of(stamped([11, 27, 67, 91]).channels) == sample_step(stamped([11, 27, 67, 91])) == 8


@pytest.mark.parametrize("at", [[], [5]])
def test_without_two_edges_the_step_is_a_position(at: list[int]):
    assert sample_step(stamped(at)) == 1


def test_times_finer_than_any_analyser_are_a_simulations():
    fine = [6_667, 13_333, 20_001]
    assert is_exact(stamped(fine, PICOSECONDS)) and sample_step(stamped(fine, PICOSECONDS)) == 1
    assert not is_exact(stamped([8_000, 24_000], PICOSECONDS))
    assert not is_exact(stamped(fine, PICOSECONDS, sampled=True))
    assert is_exact(stamped([8, 24], exact=True)) and sample_step(stamped([8, 24], exact=True)) == 1


def test_what_was_inferred_is_said():
    (note,) = stamp_notes(stamped([11, 27, 67]))
    assert note.startswith("the file gives times, not samples; all its edges are multiples of 8 ns apart")
    assert stamp_notes(stamped([8, 24], sampled=True)) == stamp_notes(stamped([8, 24], exact=True)) == []
    assert stamp_notes(stamped([8, 24], None)) == []


@given(st.sets(st.integers(1, 10**6), min_size=2, max_size=30), st.integers(1, 1000), st.integers(0, 999))
def test_no_edge_is_lost_on_the_samples_of_the_grid(at: set[int], step: int, offset: int):
    given = stamped([step * edge + offset for edge in sorted(at)])
    ready = on_samples(given)
    assert ready.sampled and len(ready.channels[0].edges) == len(at)
    times = [edge / ready.rate * 10**9 for edge in ready.channels[0].edges.tolist()]
    grid = grid_of(given.channels)
    assert all(0 <= t - (step * e + offset) < grid for t, e in zip(times, sorted(at), strict=True))
    assert ready.rate == given.rate / grid and ("samples of" in " ".join(ready.notes)) == (grid > 1)


def test_a_session_of_time_stamps_has_the_rate_of_their_grid(tmp_path: Path):
    """A second of nanoseconds on a grid of 125 MHz is 125 million samples, and not a thousand million."""
    capture = stamped([8 * n for n in (1, 5, 900, 10**5)])
    notes = formats.write(capture, tmp_path / "a.sr")
    assert notes == ("times are written as samples of 125 MHz, the slowest rate that has one at every edge",)
    again = formats.read(tmp_path / "a.sr")
    assert (again.rate, again.sampled) == (125 * 10**6, True)
    assert edges(again) == {"SCL": [0, 1, 5, 900, 10**5]}


def test_a_capture_keeps_that_it_is_exact(tmp_path: Path):
    capture = stamped([8, 24], exact=True)
    formats.write(capture, tmp_path / "a.psr")
    assert formats.read(tmp_path / "a.psr").exact
    formats.write(replace(capture, exact=False), tmp_path / "b.psr")
    assert not formats.read(tmp_path / "b.psr").exact


def test_a_pause_may_be_long_beside_as_much_of_the_rest():
    at = np.arange(1, 10**4) * 10**4
    line = channel_of_edges("SCL", 0, 1, np.append(at, at[-1] + LONGEST_PAUSE + 3))
    capture = Capture(Path("x.vcd"), Fraction(10**9), int(line.edges[-1]) + 1, (line,), sampled=False)
    assert on_samples(capture).sampled
    longer = replace(capture, length=3 * capture.length)
    with pytest.raises(BadCapture, match=f"--window 0..{capture.length}, or"):
        on_samples(longer)
    assert on_samples(replace(longer, exact=True)).sampled
