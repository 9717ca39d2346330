"""Check of a stated baud rate: a wrong rate is doubted and the correct one named; a correct one is never doubted."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from random import Random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.traces.capture.capture import Capture
from periph_sim.traces.decode import uart_doubt
from periph_sim.traces.decode.uart_doubt import rate_doubt
from periph_sim.traces.decode.uart_guess import SHAPES
from periph_sim.traces.decode.uart_line import Line, line_of
from tests.profiles import examples
from tests.traces.decode.drawing import drawn, of_bytes
from tests.traces.decode.test_uart_guess import TEXT, sent
from tests.traces.formats.writers import frame_bits, uart_wave

RATES = st.integers(300, 3_000_000)
FACTORS = st.one_of(st.sampled_from([0.25, 0.5, 2, 3, 4]), st.floats(0.25, 0.93), st.floats(1.07, 4))


def rate_named(capture: Capture, line: Line) -> float | None:
    doubt = rate_doubt(capture, "RX", line)
    return None if doubt is None else float(doubt[1].baud)


@given(RATES, FACTORS, st.sampled_from(["8n1", "8n1", "7e1", "8e1", "8o1", "8n2"]), st.integers(0, 10**6))
@settings(max_examples=examples(30), deadline=None)
def test_a_wrong_rate_is_doubted_and_the_correct_one_named(baud: int, factor: float, shape: str, seed: int):
    capture = sent(baud, shape, Random(seed).randbytes(60), rate=10 * baud)
    # The named rate is a usual one if there is one within 3.5 %.
    assert rate_named(capture, line_of(str(round(baud * factor)))) == pytest.approx(baud, rel=0.0375)


@pytest.mark.parametrize("factor", [Fraction(93, 100), Fraction(107, 100)])
@pytest.mark.parametrize("pause", [0, 3, 20])
def test_a_rate_that_is_off_by_seven_percent_is_doubted(factor: Fraction, pause: int):
    capture = sent(9600, "8n1", TEXT, pause=pause, rate=960_000)
    said, other = rate_doubt(capture, "RX", line_of(str(int(9600 * factor)))) or ("", None)
    assert f" have errors or edges between bits at {int(9600 * factor)} baud, 8n1" in said
    assert other == line_of("9600")


def impaired(capture: Capture, kind: str, random: Random, bit: int) -> Capture:
    """The capture with noise, late rising edges, or without its beginning."""
    (wire,) = capture.channels
    edges = wire.edges
    if kind == "noise":
        at = random.randrange(capture.length - bit)
        short = np.array([at, at + 1 + random.randrange(bit // 3)])
        edges = edges[~np.isin(edges, short)]
        edges = np.sort(np.append(edges, short[~np.isin(short, wire.edges)]))
        edges = edges[(edges > 0) & (edges < capture.length)]
    elif kind == "late rise":
        edges = edges + np.where(wire.levels == 1, bit // 4, 0)
    elif kind == "cut":
        begin = 12 * bit + random.randrange(60 * bit)
        initial = int(wire.at(np.array([begin]))[0])
        later = replace(wire, initial=initial, edges=edges[edges > begin] - begin)
        return replace(capture, length=capture.length - begin, channels=(later,))
    return replace(capture, channels=(replace(wire, edges=edges),))


@given(
    RATES,
    st.sampled_from(SHAPES),
    st.one_of(st.binary(min_size=1, max_size=60), st.sampled_from([TEXT, b"U" * 20, b"\0" * 20, b"\xf0" * 20])),
    st.sampled_from(["", "noise", "late rise", "cut"]),
    st.floats(0.975, 1.025),
    st.integers(0, 10**6),
)
@settings(max_examples=examples(60), deadline=None)
def test_a_correct_rate_is_not_doubted(baud: int, shape: str, values: bytes, kind: str, off: float, seed: int):
    random = Random(seed)
    capture = impaired(sent(baud, shape, values, random.randrange(20), rate=12 * baud), kind, random, 12)
    assert rate_doubt(capture, "RX", line_of(str(round(baud * off) if not kind else baud), shape)) is None


@pytest.mark.parametrize(
    "frames",
    [
        [[0] * 14 + [1] * 2, frame_bits(0x55), frame_bits(0x3C)] * 5,  # LIN headers
        [[0] * 14 + [1] * 20] * 20,  # breaks alone
        [frame_bits(0x41)] * 2,  # autobaud
        [frame_bits(value) for value in (0xFE, 0xF8, 0xE0, 0x80) * 8],  # no low pulse is a single bit
        [],
    ],
)
def test_breaks_and_bytes_without_single_bits_cause_no_doubt(frames: list[list[int]]):
    begin, placed = Fraction(40), []
    for bits in frames:
        placed.append((begin, bits))
        begin += 10 * len(bits)
    capture = of_bytes(uart_wave(placed, Fraction(10), int(begin) + 200), ("RX",), 192_000)
    assert rate_doubt(capture, "RX", line_of("19200")) is None


@pytest.mark.parametrize(
    ("true", "stated", "bits"),
    [(9600, 115200, "12 to 38"), (115200, 9600, "0.083 to 0.25"), (1200, 115200, "96 to 310")],
)
def test_a_rate_many_times_too_high_or_low_is_doubted_because_of_the_low_pulses(true: int, stated: int, bits: str):
    """At such a rate nearly all frames begin with a break, or all bytes are in one or two frames."""
    capture = sent(true, "8n1", TEXT if stated > true else TEXT[:16], pause=0, rate=1_843_200)
    said, other = rate_doubt(capture, "RX", line_of(str(stated))) or ("", None)
    assert (said, other) == (f"most low pulses are {bits} bits long at {stated} baud, 8n1", line_of(str(true)))


def test_short_pulses_alone_are_not_a_faster_line():
    drawing = "".join("-" * (7 + n % 5) + "_" * (1 + n % 2) for n in range(40))
    assert rate_doubt(drawn(f"RX {drawing}----"), "RX", line_of("9600")) is None


def test_no_other_rate_is_named_for_a_line_of_the_other_polarity():
    assert rate_doubt(sent(9600, "8n1", TEXT, pause=30, invert=True), "RX", line_of("9600")) is None
    assert rate_named(sent(9600, "8n1", TEXT, invert=True), line_of("19200", invert=True)) == 9600


def test_only_the_beginning_of_a_long_capture_is_checked(monkeypatch: pytest.MonkeyPatch):
    """The line has half the rate after the first third of its edges."""
    first, second = (sent(baud, "8n1", TEXT, rate=153_600) for baud in (19200, 9600))
    edges = [first.channels[0].edges, first.length + second.channels[0].edges]
    edges += [first.length + second.length + second.channels[0].edges]
    wire = replace(first.channels[0], edges=np.concatenate(edges))
    both = replace(first, length=first.length + 2 * second.length, channels=(wire,))
    assert rate_named(both, line_of("19200")) is None
    assert rate_named(both, line_of("9600")) is None
    monkeypatch.setattr(uart_doubt, "LOOKED_AT", len(edges[0]))
    assert rate_named(both, line_of("19200")) is None
    assert rate_named(both, line_of("9600")) == 19200


def test_a_capture_that_is_too_coarse_or_has_no_rate_is_rejected():
    with pytest.raises(ValueError, match="samples a bit"):
        rate_doubt(drawn("RX --__--__--"), "RX", line_of("900000"))
    with pytest.raises(ValueError, match="need a time base"):
        rate_doubt(drawn("RX --__--__--", rate=None), "RX", line_of("9600"))
    with pytest.raises(LookupError):
        rate_doubt(drawn("RX --__--__--"), "TX", line_of("9600"))
