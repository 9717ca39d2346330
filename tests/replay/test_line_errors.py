"""UART lines read in a wrong format: line and SCI agree on every wrong byte, and that must not pass."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.replay import BadReplay
from periph_sim.replay.report import Report, headline
from periph_sim.replay.session import SessionReplay
from periph_sim.replay.uart import UartReplay, line_format, line_settings
from periph_sim.scene.case.load import load
from periph_sim.traces import formats
from periph_sim.traces.capture.capture import Span
from periph_sim.traces.decode.uart import Line
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
    """Frames one behind the other, `pause` bits from start to start."""
    begins = [40 + number * pause * BIT for number in range(len(frames))]
    return uart_wave(zip(begins, frames, strict=True), BIT, 40 + int((len(frames) + 1) * pause * BIT))


def text(parity: str = "none") -> list[list[int]]:
    return [frame_bits(value, parity=parity) for value in TEXT]


def test_frames_read_at_twice_their_rate_are_not_judged():
    report = replay(sent(*text()), 230_400)
    assert report.agreed == report.events and report.first_divergence is None, "the SCI misreads the line just so"
    assert report.verdict == "not judged" and report.captured_errors > 20
    share = f"{report.captured_errors} of {report.events} frames in the capture "
    assert report.unjudged.startswith(f"read at 230400 baud, 8n1, {share}(")
    assert report.unjudged.endswith("give --baud 115200 --format 8n1")


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
    """Frames whose stop bit is low, each followed by a pause."""
    frames = text()
    for number in range(wrong):
        frames[4 * number][-1] = 0
    report = replay(sent(*frames))
    assert (report.verdict, report.captured_errors, report.errors["FE"]) == (verdict, wrong, wrong)
    if verdict == "pass":
        assert headline(report) == f"PASS ({wrong} of 44 frames have errors in the capture itself)"
    else:  # words of 9 bits would fit without an error, but the SCI has none
        assert report.unjudged.endswith("errors; expected few; check rate, format and polarity of the line")


@pytest.mark.parametrize("behind", [[], [1] * 20])
def test_breaks_are_no_errors_of_the_line(behind: list[int]):
    """A LIN header each: a break of 13 bits, and two bytes. At the end one whose end the capture has or has not."""
    header = [0] * 13 + [1, 1] + frame_bits(0x55) + frame_bits(0x3C)
    report = replay(sent(header, header, [0] * 13 + behind, pause=40)[: int((40 + 2 * 40 + 14 + len(behind)) * BIT)])
    assert (report.verdict, report.captured_errors, report.errors["FE"]) == ("pass", 0, 3)
    assert any(note.startswith("low for a frame or longer, 13.0 bits at most: ") for note in report.notes)


def test_flags_of_the_receiver_are_counted():
    """A break is one to the SCI ten bits behind its missing stop bit."""
    for bits, found in ((15, 0), (25, 1)):
        report = replay(sent([0] * bits + [1, 1] + frame_bits(0x55), pause=60))
        assert report.errors == {"FE": 1, "PE": 0, "BRKDT": found, "OE": 0, "RXFFOVF": 0}


def test_a_capture_that_is_cut_within_a_frame_says_so():
    line = sent(*text())
    start = int(40 + 43 * 12 * BIT)
    report = replay(line[: start + int(4.8 * BIT)])
    assert (report.verdict, report.events) == ("pass", 43)
    (note,) = report.notes
    assert note.endswith("by the end of the capture, not compared: 1, the last with 4 data bits")


def test_a_capture_that_ends_in_the_middle_of_its_last_stop_bit_has_that_frame():
    """At 1200 baud the SCI receives it up to a quarter of a bit later, and the firmware takes it then."""
    bit = Fraction(RATE, 1200)
    line = uart_wave([(Fraction(40), frame_bits(0x41))], bit, 40 + int(Fraction(96, 10) * bit))
    report = replay(line, 1200)
    assert (report.verdict, report.events, report.agreed) == ("pass", 1, 1)


def test_what_was_not_recorded_is_told_of_a_serial_line_and_of_a_sessions():
    capture = of_bytes(bytes([1]) * 4000, ("RX",), RATE)
    holes = replace(capture, channels=(replace(capture.channels[0], unknown=(Span(1000, 3000),)),))
    said = "RX: 1 span was not recorded, 0.001000000 s in all"
    assert any(note.startswith(said) for note in replay(holes).notes)
    bus = formats.read(OURS / "imu_session.sr")
    case = load(TIMING / "imu_hil_published.toml")
    session = SessionReplay(case, bus, "SCL", "SDA", holes, "RX", wanted=line_format(BAUD), first=1).run()
    assert any(note.startswith(said) for note in session.notes)


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
def test_a_session_says_that_rx_is_read_in_a_wrong_format(baud: int, doubted: bool, changes: list[str]):
    capture = formats.read(OURS / "imu_session.sr")
    case = load(TIMING / "imu_hil_published.toml", changes)
    low = Fraction(5, 10**6)
    report = SessionReplay(
        case, capture, "SCL", "SDA", capture, "RX", wanted=line_format(baud), longest_low=low, first=2
    ).run()
    said = [text for text in (report.unjudged, *report.notes) if text.startswith(f"RX: read at {baud} baud")]
    assert len(said) == doubted
    assert report.verdict == ("fail" if changes else "not judged" if doubted else "pass")
    assert not doubted or said[0] == (report.notes[0] if changes else report.unjudged)
