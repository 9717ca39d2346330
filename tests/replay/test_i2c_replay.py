"""Captures replayed against firmware on the chip's model: agreement, differences, stretches, and refusals."""

from __future__ import annotations

import dataclasses
import gc
import re
from fractions import Fraction
from pathlib import Path
from weakref import ref

import pytest

from periph_sim.core.input_error import InputError
from periph_sim.replay import BadReplay
from periph_sim.replay.i2c_closed_loop import I2cReplay
from periph_sim.replay.report import Report
from periph_sim.replay.uart import UartReplay, line_format
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase
from periph_sim.traces import formats
from periph_sim.traces.formats import Capture
from tests.replay.slow import firmware_case, one_read, slow_case
from tests.traces.decode.drawing import of_bytes
from tests.traces.formats.make_traces import FOLDER, ROUND
from tests.traces.formats.writers import I2cWave

CASES = Path(__file__).resolve().parents[2] / "timing"
RESPONDER = CASES / "responder.toml"
US = Fraction(1, 10**6)


def replay(capture: Capture | str, *changes: str, case: Path = RESPONDER, **options) -> Report:
    given = formats.read(FOLDER / capture) if isinstance(capture, str) else capture
    return I2cReplay(load(case, list(changes)), given, "SCL", "SDA", **options).run()


def ask(wave: I2cWave, address: int, data: bytes, stretched: int = 0) -> None:
    """Add a read of `data` in which SCL stays low for `stretched` more samples before the first byte."""
    *others, last = (f"{byte:02X}" for byte in data)
    wave.play(f"S {address << 1 | 1:02X}+ ~{stretched} {''.join(f'{byte}+ ' for byte in others)}{last}- P")


def captured(wave: I2cWave, rate: int = 4_000_000) -> Capture:
    return wave.play(".40").capture(rate)


def new_wave(half: int = 20) -> I2cWave:
    return I2cWave(half, half // 5, idle=400)


def traffic(words: str) -> Capture:
    """Return a capture at 100 kHz; see `I2cWave.play`."""
    return captured(new_wave().play(words))


# Agreement ----------------------------------------------------------------------


@pytest.mark.parametrize("style", ["polled", "interrupt"])
@pytest.mark.parametrize("fifo", ["false", "true"])
@pytest.mark.parametrize("address", [0x68, 0x53, 0x1E])
def test_the_responder_replaces_any_device_of_a_round(address, style, fifo):
    settings = (f"unit.dsp.settings.style={style}", f"unit.dsp.settings.fifo={fifo}")
    report = replay("imu_round.sr", *settings, addresses=[address])
    assert report.verdict == "pass" and report.first_divergence is None
    assert (report.events, report.agreed, report.bytes, report.nacks) == (63, 63, 27, 3)
    assert report.addresses == [f"{address:02X}"]
    others = ", ".join(f"{other:02X}" for other in sorted({0x68, 0x53, 0x1E} - {address}))
    assert report.notes == [f"an agent answers for {others}, as captured"]
    assert report.stretch_total_us == report.lag_worst_us == 0, "at 100 kHz this firmware does not need to stretch"


def i2c_replay() -> I2cReplay:
    return I2cReplay(load(RESPONDER), formats.read(FOLDER / "imu_round.sr"), "SCL", "SDA")


def uart_replay() -> UartReplay:
    frames = of_bytes(bytes([1] * 100), ("RX",), 1_000_000)
    return UartReplay(load(CASES / "uart_logger.toml"), frames, "RX", line_format(9600))


@pytest.mark.parametrize("made", [i2c_replay, uart_replay])
def test_a_replay_and_its_scene_are_freed(made):
    held = made()
    held.run()
    replay_gone, scene_gone = ref(held), ref(held.scene)
    del held
    gc.collect()
    assert (replay_gone(), scene_gone()) == (None, None)


SERVED = [f"unit.dsp.settings.table.{address:#x}='{bytes(values).hex()}'" for address, _, values in ROUND]


def test_firmware_that_answers_several_addresses_answers_all_of_them():
    report = replay("imu_round.sr", *SERVED, case=CASES / "imu_hil_published.toml")
    assert report.verdict == "pass" and report.agreed == 63
    assert report.addresses == ["1E", "53", "68"] and report.notes == []


def test_without_the_wait_for_sdir_that_firmware_sends_a_byte_too_early():
    report = replay("imu_round.sr", *SERVED, "unit.dsp.settings.sdir_wait=false", case=CASES / "imu_hil_published.toml")
    first = report.first_divergence
    assert report.verdict == "fail" and first is not None
    assert (first.index, first.expected, first.found) == (8, "data read 00", "data read 12")
    assert first.capture_s == first.replay_s == pytest.approx(395e-6)


@pytest.mark.parametrize("style", ["polled", "interrupt"])
def test_refusals_before_the_first_answer_are_imitated_by_the_firmware(style):
    report = replay("nack.sr", f"unit.dsp.settings.style={style}")
    assert report.verdict == "pass" and report.nacks == 3 and report.addresses == ["53"]


@pytest.mark.parametrize("style", ["polled", "interrupt"])
def test_refusals_after_a_write_are_imitated_by_busy_firmware(style):
    capture = traffic("S A0+ A5+ P .200 S A0- P .200 S A0- P .200 S A0+ A5+ P .200 S A1+ 12- P")
    report = replay(capture, f"unit.dsp.settings.style={style}")
    assert report.verdict == "pass" and report.nacks == 3


def test_refusals_that_no_setting_can_imitate_are_noted():
    """After a read, or a write ended by a repeated START, it is unknown how long the target was busy."""
    report = replay(traffic("S A1+ 12- P .200 S A0- P .200 S A0- P .200 S A0+ P"))
    assert report.notes == [
        "NACKs of 50 that the firmware cannot be set to repeat, because they follow neither a write with a STOP nor "
        "the start of the capture: 2"
    ]


def test_the_firmware_has_the_address_that_the_case_sets():
    report = replay("imu_round.sr", "unit.dsp.settings.address=0x1E")
    assert report.addresses == ["1E"] and report.verdict == "pass"


# Divergence -----------------------------------------------------------------------


def test_settings_of_the_case_are_kept_and_a_wrong_byte_is_reported_with_its_time():
    report = replay("nack.sr", "unit.dsp.settings.replies=['e4']")
    first = report.first_divergence
    assert report.verdict == "fail" and first is not None
    assert (first.expected, first.found) == ("data read E5", "data read E4")
    assert (first.index, report.agreed, report.events) == (16, 18, 19)
    assert first.capture_s == first.replay_s


def test_an_address_that_is_not_in_the_capture_is_not_judged():
    report = replay("nack.sr", "unit.dsp.settings.address=0x50")
    assert report.verdict == "not judged" and report.addresses == ["50"]
    assert report.unjudged == "nothing was required of the firmware: 50 is not acknowledged in the capture"
    assert report.notes == ["the capture does not ask 50", "an agent answers for 53, as captured"]


def refused(times: int) -> Capture:
    """Return a capture of a controller that repeatedly addresses 0x50, which is not acknowledged."""
    return traffic(times * "S A0- P .100 ")


def test_a_capture_of_refusals_only_is_not_judged():
    report = replay(refused(20))
    assert report.verdict == "not judged" and (report.agreed, report.nacks) == (80, 20)
    assert report.unjudged == "nothing was required of the firmware: 50 is not acknowledged in the capture"
    assert report.notes == ["50 is not acknowledged in the capture: the firmware does not answer"]


IDLE = """
def main(dsp, settings):
    dsp.spin(lambda: False)
"""


@pytest.fixture
def idle(tmp_path: Path) -> Path:
    """A case whose firmware never enables its I2C module."""
    return firmware_case(tmp_path, "deaf", IDLE)


@pytest.mark.parametrize("addresses", [[], [0x50]])
def test_without_firmware_on_the_bus_refusals_are_not_judged(idle, addresses):
    assert replay(refused(3), case=idle, addresses=addresses).verdict == "not judged"
    assert replay("nack.sr", case=idle).verdict == "fail", "an answer is missing here"


def test_firmware_with_a_given_address_answers_so_that_a_wrong_acknowledge_shows():
    report = replay(refused(2), addresses=[0x50])
    (ack,) = [divergence for divergence in report.divergences if divergence.kind == "ACK"]
    assert report.verdict == "fail" and (ack.index, ack.expected, ack.found) == (2, "NACK", "ACK")
    assert replay("nack.sr", addresses=[0x53]).verdict == "fail"


# Settings of the firmware ---------------------------------------------------------


HOMONYMS = """
from dataclasses import dataclass

from periph_sim.firmware import start_i2c

REPLAY = {declared}


@dataclass
class Settings:
    address: int = 0x50
    busy: bool = False
    replies: int = 7


def main(dsp, settings):
    assert isinstance(settings.busy, bool) and settings.replies == 7
    start_i2c(dsp, settings.address)
    dsp.spin(lambda: False)
"""


def homonyms(folder: Path, declared: str) -> Path:
    return firmware_case(folder, "homonyms", HOMONYMS.format(declared=declared))


def test_settings_that_the_firmware_does_not_declare_are_not_set_and_are_named(tmp_path):
    report = replay(one_read(), case=homonyms(tmp_path, "()"))
    assert report.filled == [] and report.addresses == ["50"]
    (note,) = [note for note in report.notes if "REPLAY" in note]
    assert note.startswith("settings of ") and note.endswith("name them in REPLAY: address, replies, busy")
    declared = replay(one_read(), case=homonyms(tmp_path, '("address",)'))
    assert declared.filled == [] and declared.notes[-1].endswith("name them in REPLAY: replies, busy")


@pytest.mark.parametrize(
    ("declared", "note_text"),
    [
        ('("adress",)', "REPLAY names 'adress', which is no setting; did you mean address?"),
        ("7", "REPLAY is 7; expected a tuple"),
    ],
)
def test_an_invalid_declaration_of_settings_is_refused(tmp_path, declared: str, note_text: str):
    with pytest.raises(BadCase, match=re.escape(note_text)):
        replay(one_read(), case=homonyms(tmp_path, declared))


# Settings from the capture -------------------------------------------------------------


def test_settings_filled_in_from_the_capture_are_listed():
    assert replay("imu_round.sr").filled == ["replies"]
    assert replay("nack.sr").filled == ["replies", "asleep"]
    assert replay("nack.sr", "unit.dsp.settings.replies=['e5']").filled == ["asleep"]
    assert replay("imu_round.sr", *SERVED, case=CASES / "imu_hil.toml").filled == []


# Stretching -------------------------------------------------------------------------


@pytest.fixture
def slow(tmp_path: Path) -> Path:
    return slow_case(tmp_path)


def test_slow_firmware_stretches_and_later_events_are_late_by_the_same_time(slow):
    report = replay(one_read(), "unit.dsp.settings.wait=100", case=slow)
    assert report.verdict == "pass" and report.first_divergence is None
    # AAS is set at the eighth falling SCL; ACK and the first bit's low phase would have taken 15 us.
    assert 84 < report.stretch_worst_us < 86
    assert report.stretch_total_us == pytest.approx(report.lag_worst_us, abs=0.001) == report.stretch_worst_us


def test_a_capture_with_a_stretch_gives_the_firmware_that_time(slow):
    report = replay(one_read(stretched=400), "unit.dsp.settings.wait=100", case=slow)
    assert report.captured_stretch_us == 100
    assert report.verdict == "pass" and report.stretch_total_us == 0


def test_with_longest_low_the_stretch_is_that_of_the_firmware(slow):
    report = replay(one_read(stretched=400), "unit.dsp.settings.wait=100", case=slow, longest_low=5 * US)
    assert report.verdict == "pass"
    assert 84 < report.stretch_worst_us < 86
    assert 14 < report.lag_worst_us < 16, "the end comes earlier than captured"


def test_a_stretch_of_65_ms_is_replayed(slow):
    report = replay(one_read(), "unit.dsp.settings.wait=65000", case=slow)
    assert report.verdict == "pass" and report.agreed == report.events
    assert 64_900 < report.stretch_worst_us == report.stretch_total_us < 65_000


def test_firmware_that_never_answers_ends_the_replay(slow):
    report = replay(one_read(), "unit.dsp.settings.wait=300000", case=slow)
    assert report.verdict == "fail" and report.agreed == 3
    assert report.first_divergence is not None and report.first_divergence.found == "nothing more"
    assert re.fullmatch(
        r"SCL is held low by dsp\.SCLA since 200\.000 us: the replay ends there, after 200\.000 ms; "
        "--patience sets this limit",
        report.notes[0],
    )
    assert report.stretch_worst_us == report.stretch_total_us == 200_000, "the stretch that does not end counts"


def test_patience_limits_the_stretch(slow):
    for patience, verdict in ((Fraction(10, 1000), "fail"), (Fraction(40, 1000), "pass")):
        report = replay(one_read(), "unit.dsp.settings.wait=30000", case=slow, patience=patience)
        assert report.verdict == verdict


# Limits of the capture -----------------------------------------------------------------


@pytest.mark.parametrize(
    ("bits", "note"),
    [
        (1, "in the middle of a byte, after 1 bit"),
        (3, "in the middle of a byte, after 3 bits"),
        (9, "before a STOP"),
        (0, ""),
    ],
)
def test_a_capture_that_ends_within_a_transfer_is_noted(slow, bits: int, note: str):
    """The capture ends within a write, or with its STOP."""
    end = f"{'101001110'[:bits]}:" if bits else "P .40"
    report = replay(new_wave().play(f"S A0+ {end}").capture(4_000_000), case=slow)
    note_text = f"the capture ends {note}: the rest of its last transfer is not compared"
    assert (note_text in report.notes) == bool(note) and any("the capture ends" in one for one in report.notes) == bool(
        note
    )


# Captures that are refused --------------------------------------------------------------


def test_captures_that_cannot_be_replayed_are_refused_in_one_sentence():
    with pytest.raises(BadReplay, match="firmware responder answers one address; 2 are given"):
        replay("imu_round.sr", addresses=[0x53, 0x68])
    with pytest.raises(InputError, match="a replay needs a time base and the file states no rate"):
        replay(dataclasses.replace(one_read(), rate=None))
    with pytest.raises(BadReplay, match="no whole address byte; the capture may be cut or its lines swapped"):
        replay(traffic("S 1:"))
