"""UART lines with glitches: what can be judged of them is, what cannot is told, and a correct SCI never fails."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.replay.ambiguous import Settled, Word, settled
from periph_sim.replay.report import Report
from periph_sim.replay.uart import LEAD, UartReplay, line_format
from periph_sim.scene.case.load import load
from periph_sim.traces.decode import uart
from periph_sim.traces.decode.uart import Frame, Line, RejectedStart
from periph_sim.traces.formats import Capture
from tests.traces.decode.drawing import of_bytes
from tests.traces.formats.writers import frame_bits, uart_wave

LOGGER = Path(__file__).resolve().parents[2] / "timing" / "uart_logger.toml"
RATE, BAUD = 2_000_000, 115_200
BIT = Fraction(RATE, BAUD)  # 17.4 samples
PLAIN = Line(100_000)  # ten samples a bit at 1 MHz


def judged(events: list[uart.Event], *words: int, line: Line = PLAIN) -> tuple[list[str], list[str], int]:
    """(words expected, words found, frames that are ambiguous)"""
    found = [Word(word, False, False, Fraction(n)) for n, word in enumerate(words)]
    result: Settled = settled(events, line, Fraction(10**6), found)
    return [e.words for e in result.expected], [f.words for f in result.found], len(result.ambiguous)


def frame(at: int, value: int, unsure: int = 0) -> Frame:
    return Frame(at, at + 100, value, False, False, bool(unsure), unsure)


def test_without_glitches_everything_is_judged():
    events = [frame(0, 0x41), frame(100, 0x42)]
    assert judged(events, 0x41, 0x43) == (["41", "42"], ["41", "43"], 0)
    assert judged(events, 0x41) == (["41", "42"], ["41"], 0)
    assert judged(events, 0x41, 0x42, 0x43) == (["41", "42"], ["41", "42", "43"], 0)


@pytest.mark.parametrize(("word", "ambiguous"), [(0x41, 1), (0x43, 1), (0x45, 0)])
def test_an_unsure_bit_may_be_read_either_way_and_no_other_may(word: int, ambiguous: int):
    """41 with a glitch in the second data bit."""
    events = [frame(0, 0x41, unsure=0b100), frame(100, 0x55)]
    expected, found, unsure = judged(events, word, 0x55)
    assert unsure == ambiguous
    assert (expected, found) == ((["55"], ["55"]) if ambiguous else (["41", "55"], ["45", "55"]))


def test_an_unsure_stop_bit_leaves_a_frame_error_open_and_any_other_bit_the_parity():
    even = Line(100_000, parity="even")
    stop, parity, data = 1 << 10, 1 << 9, 1 << 3
    (found,) = settled([frame(0, 0x41, stop)], even, Fraction(10**6), [Word(0x41, True, False, Fraction(0))]).ambiguous
    assert found.value == 0x41
    (found,) = settled(
        [frame(0, 0x41, parity)], even, Fraction(10**6), [Word(0x41, False, True, Fraction(0))]
    ).ambiguous
    assert found.value == 0x41
    (found,) = settled([frame(0, 0x41, data)], even, Fraction(10**6), [Word(0x45, False, True, Fraction(0))]).ambiguous
    assert found.value == 0x41
    refused = settled([frame(0, 0x41, data)], even, Fraction(10**6), [Word(0x41, True, False, Fraction(0))])
    assert not refused.ambiguous and [e.words for e in refused.expected] == ["41"]
    refused = settled([frame(0, 0x41, stop)], even, Fraction(10**6), [Word(0x41, False, True, Fraction(0))])
    assert not refused.ambiguous, "an unsure stop bit does not excuse a parity error"


@pytest.mark.parametrize("words", [(0x41, 0x55, 0x66), (0x55, 0x66), (0x12, 0x55, 0x66), (0x12, 0xF0, 0x55, 0x66)])
def test_behind_an_unsure_start_the_words_are_followed_from_where_they_agree_again(words: tuple[int, ...]):
    """Read, not seen, read otherwise, read as two: whatever it was, the next pause ends it."""
    events = [frame(0, 0x41, unsure=1), frame(1000, 0x55), frame(2000, 0x66)]
    expected, found, unsure = judged(events, *words)
    assert expected == found == ["55", "66"] and unsure == 1


def test_an_unsure_start_in_a_burst_may_shift_all_of_it_but_nothing_behind_the_pause():
    burst = [frame(0, 0x41, unsure=1), frame(100, 0x42), frame(200, 0x43)]
    behind = frame(1000, 0x55)
    assert judged([*burst, behind], 0x90, 0xA1, 0x55) == (["55"], ["55"], 3)
    assert judged([*burst, behind], 0x90, 0x43, 0x55) == (["43", "55"], ["43", "55"], 2)
    assert judged([*burst, behind], 0x41, 0x42, 0x43, 0x54)[:2] == (["42", "43", "55"], ["42", "43", "54"])


@pytest.mark.parametrize(("at", "expected"), [(199, ["55"]), (200, ["42", "55"])])
def test_a_burst_ends_with_a_pause_as_long_as_two_frames(at: int, expected: list[str]):
    events = [frame(0, 0x41, unsure=1), frame(at, 0x42), frame(1000, 0x55)]
    assert judged(events, 0x90, 0x55)[0] == expected


def test_words_agree_up_to_the_next_unsure_start_whatever_was_read_there():
    events = [frame(0, 0x41, unsure=1), frame(100, 0x42), frame(200, 0x43, unsure=1), frame(1000, 0x55)]
    assert judged(events, 0x41, 0x42, 0x90, 0x55) == (["42", "55"], ["42", "55"], 2)


def test_of_words_that_repeat_those_are_taken_that_end_with_the_line():
    for words in ([0x55, 0x55], [0x55, 0x55, 0x55]):
        assert judged([frame(0, 0x55, unsure=1), frame(1000, 0x55)], *words) == (["55"], ["55"], 1)


def test_a_rejected_start_of_a_quarter_bit_may_be_a_frame_and_a_shorter_one_is_none():
    likely, short = RejectedStart(0, 4), RejectedStart(0, 2)
    events = [frame(1000, 0x55)]
    assert judged([likely, *events], 0xFF, 0x55) == judged([likely, *events], 0x55) == (["55"], ["55"], 0)
    assert judged([short, *events], 0xFF, 0x55) == (["55"], ["FF", "55"], 0)


@given(
    line=st.builds(Line, st.just(100_000), st.sampled_from([5, 8]), st.sampled_from(["none", "even"])),
    unsure=st.sets(st.sampled_from([*range(8), "parity", "stop"]), min_size=1, max_size=2),
    flipped=st.sets(st.sampled_from([*range(8), "parity", "stop"]), max_size=2),
)
@settings(max_examples=80, deadline=None)
def test_a_word_fits_a_frame_if_only_what_a_glitch_left_open_differs(line: Line, unsure: set, flipped: set):
    """The place of a bit in a frame: start, data, parity, stop. A data bit that is open leaves the parity open, too."""
    places = ["start", *range(line.bits), *["parity"] * (line.parity != "none"), "stop"]
    unsure, flipped = unsure & set(places), flipped & {*places, "parity"}
    if not unsure:
        return
    mask = sum(1 << places.index(bit) for bit in unsure)
    value = sum(1 << bit for bit in flipped - {"parity", "stop"})
    word = Word(value, "stop" in flipped, "parity" in flipped, Fraction(0))
    found = settled([frame(0, 0, mask)], line, Fraction(10**6), [word])
    is_open = unsure | ({"parity"} if unsure - {"parity", "stop"} else set())
    assert bool(found.ambiguous) == (flipped <= is_open)


# On the SCI ---------------------------------------------------------------------------


def glitched(sent: bytes, glitches: list[tuple[int, int]], pauses: tuple[int, ...] = ()) -> Capture:
    """Frames at 2 MHz, each behind a pause of so many bits; each glitch is (place, length) in samples."""
    at = Fraction(60)
    frames = []
    for number, value in enumerate(sent):
        frames.append((at, frame_bits(value)))
        at += (10 + (pauses[number] if number < len(pauses) else 0)) * BIT
    line = bytearray(uart_wave(frames, BIT, int(at) + 200))
    for place, length in glitches:
        for n in range(length):
            line[(40 + place + n) % (len(line) - 180)] ^= 1
    return of_bytes(bytes(line), ("RX",), RATE)


def replay(capture: Capture, phase: Fraction = Fraction(0)) -> Report:
    return UartReplay(load(LOGGER), capture, "RX", line_format(BAUD), lead=LEAD + phase).run()


def in_bit(bit: int) -> int:
    """The place of a bit's middle, for `glitched`."""
    return 20 + int((bit + Fraction(1, 2)) * BIT)


def test_a_byte_that_a_glitch_makes_ambiguous_is_neither_right_nor_wrong():
    """As in a real capture: 4F was sent, a receiver that looks once reads 5F, one that votes 4F."""
    report = replay(glitched(b"\x41\x4f\x42", [(in_bit(10 + 5), 1)]))
    assert report.verdict == "ambiguous" and report.divergences == []
    assert (report.events, report.agreed, report.ambiguous, report.bytes) == (3, 2, 1, 3)
    (note,) = [note for note in report.notes if "glitch" in note]
    assert "1 of 3, the first at 0.000117 s, 5F where each bit is sampled once" in note


def test_a_glitch_beside_the_middle_of_its_bit_is_judged():
    report = replay(glitched(b"\x41\x42", [(20 + int(Fraction(51, 10) * BIT), 1)]))
    assert (report.verdict, report.agreed, report.ambiguous) == ("pass", 2, 0)


def test_a_line_without_a_frame_proves_nothing():
    report = replay(glitched(b"", []))
    assert report.verdict == "not judged" and report.unjudged.startswith("there is no frame on the line")


@given(
    st.binary(min_size=1, max_size=4),
    st.lists(st.tuples(st.integers(0, 800), st.integers(1, 4)), min_size=1, max_size=4),
    st.tuples(*[st.sampled_from([0, 0, 1, 5, 25])] * 3),
    st.integers(0, 399),
)
@settings(max_examples=25, deadline=None)
def test_a_correct_sci_never_fails_for_glitches_of_up_to_a_quarter_bit(sent, glitches, pauses, phase):
    """At any phase of its sampling clock: BRR = 40, so that a sample is 41 LSPCLK cycles."""
    assert replay(glitched(sent, glitches, pauses), Fraction(41 * phase, 37_500_000 * 400)).verdict != "fail"
