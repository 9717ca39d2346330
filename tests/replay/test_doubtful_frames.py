"""UART lines read in a wrong format: the SCI agrees with the line in every wrong byte, which must not pass."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.replay import BadReplay
from periph_sim.replay.doubtful_frames import Settled, Word
from periph_sim.replay.report import Report, headline
from periph_sim.replay.session import SessionReplay
from periph_sim.replay.uart import LEAD, UartReplay, line_format, line_settings
from periph_sim.scene.case.load import load
from periph_sim.traces import formats
from periph_sim.traces.capture.capture import Span
from periph_sim.traces.decode.uart import Event, Line, UartRowKind
from periph_sim.traces.formats import Capture
from tests.captures.where import OURS
from tests.traces.decode.drawing import of_bytes
from tests.traces.formats.writers import frame_bits, uart_wave

TIMING = Path(__file__).resolve().parents[2] / "timing"
RATE, BAUD = 2_000_000, 115_200
BIT = Fraction(RATE, BAUD)  # 17.4 samples
TEXT = b"Nothing false: 42 bytes, each as it was sent"


def replay(line: bytes | Capture, baud: int = BAUD, shape: str = "8n1", *changes: str) -> Report:
    capture = of_bytes(line, ("RX",), RATE) if isinstance(line, bytes) else line
    return UartReplay(load(TIMING / "uart_logger.toml", list(changes)), capture, "RX", line_format(baud, shape)).run()


def sent(*frames: list[int], pause: int = 12) -> bytes:
    """Return a line with these frames, which start `pause` bits apart."""
    begins = [40 + number * pause * BIT for number in range(len(frames))]
    return uart_wave(zip(begins, frames, strict=True), BIT, 40 + int((len(frames) + 1) * pause * BIT))


def text(parity: str = "none") -> list[list[int]]:
    return [frame_bits(value, parity=parity) for value in TEXT]


def test_frames_read_at_twice_their_rate_are_not_judged():
    report = replay(sent(*text()), 230_400)
    assert report.agreed == report.events and report.first_divergence is None, "the SCI misreads the line as well"
    assert report.verdict == "not judged" and report.captured_errors > 20
    share = f"{report.captured_errors} of {report.events} frames in the capture "
    assert report.unjudged.startswith(f"read at 230400 baud, 8n1, {share}(")
    assert report.unjudged.endswith("give --baud 115200 --frame 8n1")


def test_a_firmware_that_sets_another_rate_than_the_line_has_is_not_judged():
    capture = formats.read(OURS / "host_frames.sr")
    case = load(TIMING / "uart_logger.toml", ["unit.dsp.settings.baud=230400"])
    report = UartReplay(case, capture, "RX").run()
    assert (report.verdict, report.captured_errors, report.events) == ("not judged", 8, 28)


def test_an_inverted_line_is_not_judged():
    line = bytes(1 - level for level in sent(*text(), pause=10))
    report = replay(line)
    assert report.agreed == report.events and report.captured_errors * 10 < report.events, "few of its frames are wrong"
    assert report.verdict == "not judged"
    assert "the line idles low, like an inverted one of 115200 baud, 8n1;" in report.unjudged


def test_a_wrong_parity_is_not_judged():
    report = replay(sent(*text(parity="odd")), BAUD, "8e1")
    assert report.verdict == "not judged" and report.captured_errors == len(TEXT) == report.errors["PE"]
    assert "fit 115200 baud, 8o1" in report.unjudged


@pytest.mark.parametrize(("wrong", "verdict"), [(1, "pass"), (4, "pass"), (5, "not judged")])
def test_single_frames_with_errors_are_counted_and_more_than_a_tenth_is_not_judged(wrong: int, verdict: str):
    """Frames with a low stop bit, each followed by a pause."""
    frames = text()
    for number in range(wrong):
        frames[4 * number][-1] = 0
    report = replay(sent(*frames))
    assert (report.verdict, report.captured_errors, report.errors["FE"]) == (verdict, wrong, wrong)
    if verdict == "pass":
        assert headline(report) == f"PASS ({wrong} of 44 frames have errors in the capture itself)"
    else:  # words of 9 bits would fit without an error, but the SCI has none
        assert report.unjudged.endswith("errors; expected few; check rate, format and polarity of the line")


@pytest.mark.parametrize("following", [[], [1] * 20])
def test_breaks_are_not_counted_as_errors_of_the_line(following: list[int]):
    """Each frame is a LIN header: a break of 13 bits and two bytes. A last break ends within the capture or not."""
    header = [0] * 13 + [1, 1] + frame_bits(0x55) + frame_bits(0x3C)
    report = replay(
        sent(header, header, [0] * 13 + following, pause=40)[: int((40 + 2 * 40 + 14 + len(following)) * BIT)]
    )
    assert (report.verdict, report.captured_errors, report.errors["FE"]) == ("pass", 0, 3)
    assert any(note.startswith("low for a frame or longer, 13.0 bits at most: ") for note in report.notes)


def test_flags_of_the_receiver_are_counted():
    """For the SCI, a low line is a break ten bits after its missing stop bit."""
    for bits, found in ((15, 0), (25, 1)):
        report = replay(sent([0] * bits + [1, 1] + frame_bits(0x55), pause=60))
        assert report.errors == {"FE": 1, "PE": 0, "BRKDT": found, "OE": 0, "RXFFOVF": 0}


def test_a_capture_that_ends_within_a_frame_is_noted():
    line = sent(*text())
    start = int(40 + 43 * 12 * BIT)
    report = replay(line[: start + int(4.8 * BIT)])
    assert (report.verdict, report.events) == ("pass", 43)
    (note,) = report.notes
    assert note.endswith("by the end of the capture, not compared: 1, the last with 4 data bits")


def test_a_capture_that_ends_in_the_middle_of_its_last_stop_bit_has_that_frame():
    """At 1200 baud the SCI receives it up to a quarter of a bit later, and then the firmware reads it."""
    bit = Fraction(RATE, 1200)
    line = uart_wave([(Fraction(40), frame_bits(0x41))], bit, 40 + int(Fraction(96, 10) * bit))
    report = replay(line, 1200)
    assert (report.verdict, report.events, report.agreed) == ("pass", 1, 1)


def test_spans_that_were_not_recorded_are_noted_for_a_serial_line_and_a_session():
    capture = of_bytes(bytes([1]) * 4000, ("RX",), RATE)
    holes = replace(capture, channels=(replace(capture.channels[0], unknown=(Span(1000, 3000),)),))
    message = "RX: 1 span was not recorded, 0.001000000 s in all"
    assert any(note.startswith(message) for note in replay(holes).notes)
    bus = formats.read(OURS / "imu_session.sr")
    case = load(TIMING / "imu_hil_published.toml")
    session = SessionReplay(case, bus, "SCL", "SDA", holes, "RX", wanted=line_format(BAUD), first=1).run()
    assert any(note.startswith(message) for note in session.notes)


@pytest.mark.parametrize(
    ("text", "given"),
    [("8n1", {}), ("7o2", {"bits": 7, "parity": "odd", "stop": 2}), (" 5E1 ", {"bits": 5, "parity": "even"})],
)
def test_a_format_in_letters(text: str, given: dict[str, object]):
    settings = {"baud": 9600, "bits": 8, "parity": "none", "stop": 1, **given}
    assert line_format(9600, text) == Line(9600, **given)
    assert line_settings(line_format(9600, text)) == settings
    with pytest.raises(BadReplay, match="0 baud; expected 1 or more"):
        line_format(0, text)
    assert line_format(1, text).baud == 1


@pytest.mark.parametrize(("baud", "doubted"), [(115_200, False), (230_400, True)])
@pytest.mark.parametrize("changes", [[], ["unit.dsp.settings.model_cost=320 us"]])
def test_a_session_reports_that_rx_is_read_in_a_wrong_format(baud: int, doubted: bool, changes: list[str]):
    capture = formats.read(OURS / "imu_session.sr")
    case = load(TIMING / "imu_hil_published.toml", changes)
    low = Fraction(5, 10**6)
    report = SessionReplay(
        case, capture, "SCL", "SDA", capture, "RX", wanted=line_format(baud), longest_low=low, first=2
    ).run()
    notes = [text for text in (report.unjudged, *report.notes) if text.startswith(f"RX: read at {baud} baud")]
    assert len(notes) == doubted
    assert report.verdict == ("fail" if changes else "not judged" if doubted else "pass")
    assert not doubted or notes[0] == (report.notes[0] if changes else report.unjudged)


LOGGER = Path(__file__).resolve().parents[2] / "timing" / "uart_logger.toml"
PLAIN = Line(100_000)  # ten samples a bit at 1 MHz


def judged(events: list[Event], *words: int, line: Line = PLAIN) -> tuple[list[str], list[str], int]:
    """Return (words expected, words found, number of ambiguous frames)."""
    found = [Word(word, False, False, Fraction(n)) for n, word in enumerate(words)]
    result = Settled(events, line, Fraction(10**6), found)
    return [e.words for e in result.expected], [f.words for f in result.found], len(result.ambiguous)


def frame(at: int, value: int, unsure: int = 0) -> Event:
    return Event(UartRowKind.FRAME, at, at + 100, value, 8, False, False, bool(unsure), unsure)


def test_without_glitches_everything_is_judged():
    events = [frame(0, 0x41), frame(100, 0x42)]
    assert judged(events, 0x41, 0x43) == (["41", "42"], ["41", "43"], 0)
    assert judged(events, 0x41) == (["41", "42"], ["41"], 0)
    assert judged(events, 0x41, 0x42, 0x43) == (["41", "42"], ["41", "42", "43"], 0)


@pytest.mark.parametrize(("word", "ambiguous"), [(0x41, 1), (0x43, 1), (0x45, 0)])
def test_an_unsure_bit_may_be_read_either_way_and_no_other_may(word: int, ambiguous: int):
    """The frame is 41 with a glitch in the second data bit."""
    events = [frame(0, 0x41, unsure=0b100), frame(100, 0x55)]
    expected, found, unsure = judged(events, word, 0x55)
    assert unsure == ambiguous
    assert (expected, found) == ((["55"], ["55"]) if ambiguous else (["41", "55"], ["45", "55"]))


def test_an_unsure_stop_bit_excuses_a_framing_error_and_any_other_bit_a_parity_error():
    even = Line(100_000, parity="even")
    stop, parity, data = 1 << 10, 1 << 9, 1 << 3
    (found,) = Settled([frame(0, 0x41, stop)], even, Fraction(10**6), [Word(0x41, True, False, Fraction(0))]).ambiguous
    assert found.value == 0x41
    (found,) = Settled(
        [frame(0, 0x41, parity)], even, Fraction(10**6), [Word(0x41, False, True, Fraction(0))]
    ).ambiguous
    assert found.value == 0x41
    (found,) = Settled([frame(0, 0x41, data)], even, Fraction(10**6), [Word(0x45, False, True, Fraction(0))]).ambiguous
    assert found.value == 0x41
    refused = Settled([frame(0, 0x41, data)], even, Fraction(10**6), [Word(0x41, True, False, Fraction(0))])
    assert not refused.ambiguous and [e.words for e in refused.expected] == ["41"]
    refused = Settled([frame(0, 0x41, stop)], even, Fraction(10**6), [Word(0x41, False, True, Fraction(0))])
    assert not refused.ambiguous, "an unsure stop bit does not excuse a parity error"


@pytest.mark.parametrize("words", [(0x41, 0x55, 0x66), (0x55, 0x66), (0x12, 0x55, 0x66), (0x12, 0xF0, 0x55, 0x66)])
def test_after_an_unsure_start_words_are_compared_from_where_they_agree_again(words: tuple[int, ...]):
    """The frame is read, missed, misread or read as two: in each case the next pause ends it."""
    events = [frame(0, 0x41, unsure=1), frame(1000, 0x55), frame(2000, 0x66)]
    expected, found, unsure = judged(events, *words)
    assert expected == found == ["55", "66"] and unsure == 1


def test_an_unsure_start_may_shift_all_of_its_burst_but_nothing_after_the_pause():
    burst = [frame(0, 0x41, unsure=1), frame(100, 0x42), frame(200, 0x43)]
    following = frame(1000, 0x55)
    assert judged([*burst, following], 0x90, 0xA1, 0x55) == (["55"], ["55"], 3)
    assert judged([*burst, following], 0x90, 0x43, 0x55) == (["43", "55"], ["43", "55"], 2)
    assert judged([*burst, following], 0x41, 0x42, 0x43, 0x54)[:2] == (["42", "43", "55"], ["42", "43", "54"])


@pytest.mark.parametrize(("at", "expected"), [(199, ["55"]), (200, ["42", "55"])])
def test_a_burst_ends_with_a_pause_as_long_as_two_frames(at: int, expected: list[str]):
    events = [frame(0, 0x41, unsure=1), frame(at, 0x42), frame(1000, 0x55)]
    assert judged(events, 0x90, 0x55)[0] == expected


def test_words_agree_up_to_the_next_unsure_start_whatever_was_read_there():
    events = [frame(0, 0x41, unsure=1), frame(100, 0x42), frame(200, 0x43, unsure=1), frame(1000, 0x55)]
    assert judged(events, 0x41, 0x42, 0x90, 0x55) == (["42", "55"], ["42", "55"], 2)


def test_of_repeated_words_those_at_the_end_of_the_line_are_compared():
    for words in ([0x55, 0x55], [0x55, 0x55, 0x55]):
        assert judged([frame(0, 0x55, unsure=1), frame(1000, 0x55)], *words) == (["55"], ["55"], 1)


def test_a_rejected_start_of_a_quarter_bit_may_be_a_frame_and_a_shorter_one_not():
    likely, short = Event(UartRowKind.REJECTED, 0, 4), Event(UartRowKind.REJECTED, 0, 2)
    events = [frame(1000, 0x55)]
    assert judged([likely, *events], 0xFF, 0x55) == judged([likely, *events], 0x55) == (["55"], ["55"], 0)
    assert judged([short, *events], 0xFF, 0x55) == (["55"], ["FF", "55"], 0)


@given(
    line=st.builds(Line, st.just(100_000), st.sampled_from([5, 8]), st.sampled_from(["none", "even"])),
    unsure=st.sets(st.sampled_from([*range(8), "parity", "stop"]), min_size=1, max_size=2),
    flipped=st.sets(st.sampled_from([*range(8), "parity", "stop"]), max_size=2),
)
@settings(max_examples=80, deadline=None)
def test_a_word_fits_a_frame_if_only_bits_that_a_glitch_made_unsure_differ(line: Line, unsure: set, flipped: set):
    """The bits of a frame are start, data, parity and stop. An unsure data bit makes the parity unsure, too."""
    places = ["start", *range(line.bits), *["parity"] * (line.parity != "none"), "stop"]
    unsure, flipped = unsure & set(places), flipped & {*places, "parity"}
    if not unsure:
        return
    mask = sum(1 << places.index(bit) for bit in unsure)
    value = sum(1 << bit for bit in flipped - {"parity", "stop"})
    word = Word(value, "stop" in flipped, "parity" in flipped, Fraction(0))
    found = Settled([frame(0, 0, mask)], line, Fraction(10**6), [word])
    is_open = unsure | ({"parity"} if unsure - {"parity", "stop"} else set())
    assert bool(found.ambiguous) == (flipped <= is_open)


# Replays on the SCI ---------------------------------------------------------------------


def glitched(sent: bytes, glitches: list[tuple[int, int]], pauses: tuple[int, ...] = ()) -> Capture:
    """Return frames at 2 MHz, with these pauses in bits after them. Each glitch is (place, length) in samples."""
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


def replayed(capture: Capture, phase: Fraction = Fraction(0)) -> Report:
    return UartReplay(load(LOGGER), capture, "RX", line_format(BAUD), lead=LEAD + phase).run()


def in_bit(bit: int) -> int:
    """Return the place of a bit's middle, for `glitched`."""
    return 20 + int((bit + Fraction(1, 2)) * BIT)


def test_a_byte_that_a_glitch_makes_ambiguous_is_neither_right_nor_wrong():
    """A real capture had this: 4F was sent; a receiver that samples once reads 5F, and one that votes reads 4F."""
    report = replayed(glitched(b"\x41\x4f\x42", [(in_bit(10 + 5), 1)]))
    assert report.verdict == "ambiguous" and report.divergences == []
    assert (report.events, report.agreed, report.ambiguous, report.bytes) == (3, 2, 1, 3)
    (note,) = [note for note in report.notes if "glitch" in note]
    assert "1 of 3, the first at 0.000117 s, 5F where each bit is sampled once" in note


def test_a_glitch_beside_the_middle_of_its_bit_is_judged():
    report = replayed(glitched(b"\x41\x42", [(20 + int(Fraction(51, 10) * BIT), 1)]))
    assert (report.verdict, report.agreed, report.ambiguous) == ("pass", 2, 0)


def test_a_line_without_a_frame_is_not_judged():
    report = replayed(glitched(b"", []))
    assert report.verdict == "not judged" and report.unjudged.startswith("there is no frame on the line")


@given(
    st.binary(min_size=1, max_size=4),
    st.lists(st.tuples(st.integers(0, 800), st.integers(1, 4)), min_size=1, max_size=4),
    st.tuples(*[st.sampled_from([0, 0, 1, 5, 25])] * 3),
    st.integers(0, 399),
)
@settings(max_examples=25, deadline=None)
def test_a_correct_sci_never_fails_for_glitches_of_up_to_a_quarter_bit(sent, glitches, pauses, phase):
    """The phase of its sampling clock is arbitrary. With BRR = 40 a sample takes 41 LSPCLK cycles."""
    assert replayed(glitched(sent, glitches, pauses), Fraction(41 * phase, 37_500_000 * 400)).verdict != "fail"
