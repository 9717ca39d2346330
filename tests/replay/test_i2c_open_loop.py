"""Open loop: the capture does not wait. What the chip would have driven, and by how much it was late or early."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.replay.i2c_closed_loop import I2cReplay
from periph_sim.replay.i2c_open_loop import I2cOpenReplay, _edges
from periph_sim.replay.report import Report, i2c_words
from periph_sim.replay.setup import Played, events_of
from periph_sim.scene.case.load import load
from periph_sim.traces import formats
from periph_sim.traces.capture.capture import Channel
from periph_sim.traces.decode import i2c
from periph_sim.traces.formats import Capture
from tests.replay.slow import one_read, slow_case
from tests.replay.test_agents import reads
from tests.traces.formats.make_traces import FOLDER, ROUND
from tests.traces.formats.writers import I2cWave

CASES = Path(__file__).resolve().parents[2] / "timing"
RESPONDER, IMU = CASES / "responder.toml", CASES / "imu_hil_published.toml"
SERVED = [f"unit.dsp.settings.table.{address:#x}='{bytes(values).hex()}'" for address, _, values in ROUND]


def replay(capture: Capture | str, *changes: str, case: Path = RESPONDER, **options) -> Report:
    given = formats.read(FOLDER / capture) if isinstance(capture, str) else capture
    return I2cOpenReplay(load(case, list(changes)), given, "SCL", "SDA", **options).run()


def kinds(report: Report) -> list[str]:
    return [divergence.kind for divergence in report.divergences]


@pytest.mark.parametrize("style", ["polled", "interrupt"])
@pytest.mark.parametrize("fifo", ["false", "true"])
def test_firmware_that_is_in_time_would_have_driven_what_the_capture_shows(style, fifo):
    settings = (f"unit.dsp.settings.style={style}", f"unit.dsp.settings.fifo={fifo}")
    report = replay("imu_round.sr", *settings)
    assert (report.verdict, report.loop, report.divergences) == ("pass", "open", [])
    assert (report.events, report.agreed, report.late_worst_us) == (63, 63, 0)
    assert (report.stretch_worst_us, report.stretch_total_us) == (0, 0)


def test_a_firmware_of_several_addresses_and_refusals_at_the_start():
    assert replay("imu_round.sr", *SERVED, case=IMU).verdict == "pass"
    assert replay("nack.sr").verdict == "pass"


def test_a_wrong_byte_is_reported_with_both_values_and_the_write():
    report = replay("nack.sr", "unit.dsp.settings.replies=['e4']")
    (byte,) = report.divergences
    assert (byte.kind, byte.expected, byte.found, byte.index) == ("byte", "data read E5", "data read E4", 16)
    written = [change for change in byte.history if change.what == "W I2C-A.I2CDXR" and change.at_s < byte.capture_s]
    assert written[0].value == 0xE4
    raised = [change.what for change in byte.history if change.value == 1]
    assert "I2C-A.I2CSTR.AAS" in raised and "I2C-A.I2CSTR.SDIR" in raised


def test_an_address_that_the_firmware_does_not_have_is_a_wrong_ack():
    other = replay("imu_round.sr", *SERVED, "unit.dsp.settings.order=[0x53, 0x68, 0x1E]", case=IMU)
    assert other.verdict == "fail" and other.divergences[0].kind in ("byte", "ACK")
    ack = next(divergence for divergence in other.divergences if divergence.kind == "ACK")
    assert (ack.index, ack.expected, ack.found) == (2, "ACK", "NACK")


def test_a_chip_that_holds_sda_low_clears_every_bit_of_the_address_and_the_direction():
    replay = I2cOpenReplay(load(RESPONDER), formats.read(FOLDER / "imu_round.sr"), "SCL", "SDA")
    held = Channel("SDA", 1, 0, np.empty(0, np.int64))
    found = {words.words for words in i2c_words(events_of(replay._would_be(held)), replay._part.rate)}
    assert {words for words in found if words.startswith("address")} == {"address 00 write"}


def test_firmware_with_a_given_address_answers_where_the_captured_target_refused():
    """Without --address the firmware is set to be asleep for as long, and so agrees."""
    assert replay("nack.sr").verdict == "pass"
    report = replay("nack.sr", "unit.dsp.settings.address=0x50", addresses=[0x53])
    (ack,) = report.divergences
    assert report.addresses == ["53"], "--address goes before the case"
    assert (report.verdict, ack.kind, ack.index, ack.expected, ack.found) == ("fail", "ACK", 2, "NACK", "ACK")


# Late and early ---------------------------------------------------------------------


def test_an_answer_that_is_not_ready_when_scl_rises_is_late(tmp_path):
    closed = I2cReplay(load(slow_case(tmp_path), ["unit.dsp.settings.wait=100"]), one_read(), "SCL", "SDA").run()
    report = replay(one_read(), "unit.dsp.settings.wait=100", case=slow_case(tmp_path))
    assert report.verdict == "fail" and kinds(report) == ["byte", "timing"]
    assert report.late_worst_us == pytest.approx(closed.stretch_worst_us, abs=0.1), (
        "the stretch that it would have made"
    )
    assert report.late_worst_us > 80
    late = report.divergences[1]
    assert late.expected == "SCL rises for byte 1 bit 0" and late.capture_s == pytest.approx(200e-6)
    assert late.replay_s - late.capture_s == pytest.approx(report.late_worst_us * 1e-6)
    (note,) = [note for note in report.notes if "would have made and the capture lacks" in note]
    assert "capture lacks: 1; the longest 85." in note


def test_a_lateness_within_the_tolerance_passes(tmp_path):
    """The firmware releases SCL less than a microsecond after the captured rise, and its byte is right."""
    case = slow_case(tmp_path)
    within = replay(one_read(), "unit.dsp.settings.wait=15", case=case, tolerance=Fraction(1, 10**6))
    assert within.verdict == "pass" and 0 < within.late_worst_us < 1
    assert kinds(replay(one_read(), "unit.dsp.settings.wait=15", case=case, tolerance=Fraction(0))) == ["timing"]


def test_a_stretch_that_the_chip_does_not_need_is_noted_and_passes(tmp_path):
    report = replay(one_read(stretched=400), "unit.dsp.settings.wait=60", case=slow_case(tmp_path))
    assert report.verdict == "pass" and report.late_worst_us == 0
    assert 45 < report.stretch_worst_us < 55 and report.captured_stretch_us == 100
    (note,) = [note for note in report.notes if "would have ended earlier" in note]
    assert "would have ended earlier: 1 of 1; that at 0.000300 s lasts 105.000 us, and the chip needs 50." in note


def test_a_chip_that_is_not_addressed_is_neither_late_nor_early(tmp_path):
    report = replay(reads((0x51, 0x33, 0)), case=slow_case(tmp_path), addresses=[0x50])
    assert (report.late_worst_us, report.stretch_worst_us, report.stretch_total_us) == (0, 0, 0)


def test_the_longest_of_several_missing_or_unneeded_stretches_is_named(tmp_path):
    """The firmware computes for 60 us; the captured target stretched for 0, 100, 75, 50, 12.5 and 25 us."""
    capture = reads(*[(0x50, 0xA7, stretched) for stretched in (0, 400, 300, 200, 50, 100)])
    report = replay(capture, "unit.dsp.settings.wait=60", case=slow_case(tmp_path))
    unneeded, late = report.notes[-2:]
    assert unneeded.startswith(
        "long low phases of SCL that the chip would have ended earlier: 3 of 5; that at 0.000600 s"
    )
    assert "lasts 105.000 us, and the chip needs 50.3" in unneeded
    assert late.startswith("stretches that the chip would have made and the capture lacks: 3; the longest 45.3")
    assert late.endswith(" us past SCL's rise at 0.000200 s")
    assert report.late_worst_us == pytest.approx(45.36, abs=0.05)
    timing = next(one for one in report.divergences if one.kind == "timing")
    assert timing.capture_s == pytest.approx(200e-6), "the first one is the divergence"


@given(wait=st.integers(0, 300), byte=st.integers(0, 255))
def test_the_wires_of_a_closed_loop_pass_in_an_open_loop(tmp_path_factory, wait: int, byte: int):
    """Its wires include the chip's own stretch, so the chip is never late, and releases SCL as it rises."""
    case = slow_case(tmp_path_factory.mktemp("slow"))
    changes = [f"unit.dsp.settings.wait={wait}", f"unit.dsp.settings.byte={byte}"]
    closed = I2cReplay(load(case, changes), one_read(byte=byte), "SCL", "SDA")
    stretched = closed.run()
    assert stretched.verdict == "pass"
    wires = closed.log.capture(closed.timebase, closed.kernel.now)
    report = replay(wires, *changes, case=case, tolerance=Fraction(0))
    assert (report.verdict, report.late_worst_us) == ("pass", 0)
    low = 5  # us, the controller's own
    needed = stretched.stretch_worst_us + low if stretched.stretch_worst_us else report.stretch_worst_us
    assert report.stretch_worst_us == pytest.approx(needed, abs=1e-3) and report.stretch_worst_us >= 0


# Edges as captured --------------------------------------------------------------------


def test_a_capture_that_begins_with_sda_low_gives_the_chip_no_start():
    wave = I2cWave(20, 4)
    wave.samples += bytes([0b01]) * 400  # SCL high, SDA low; then a STOP
    assert replay(wave.play(".400 S A1+ 42- P .400").capture(4_000_000)).verdict == "pass"


def test_edges_of_both_lines_in_one_sample_are_no_start_or_stop():
    wave = I2cWave(20, 0, idle=400)  # SDA changes with SCL's fall
    report = replay(wave.play("S A1+ 42- P .400").capture(4_000_000))
    assert report.verdict == "pass" and any("edge of both lines" in note for note in report.notes)


def line(*edges: int, initial: int = 1) -> Channel:
    return Channel("", 0, initial, np.array(edges, np.int64))


@pytest.mark.parametrize(
    ("half", "end", "scl", "sda"),
    [
        (Fraction(1, 2), 21, [(10, 0), (20, 1)], [(5, 0), (Fraction(21, 2), 1), (Fraction(39, 2), 0), (21, 1)]),
        (Fraction(1, 2), 20, [(10, 0), (20, 1)], [(5, 0), (Fraction(21, 2), 1), (Fraction(39, 2), 0)]),
        (Fraction(1, 2), 10, [(10, 0)], [(5, 0)]),  # half a sample after SCL's fall is after the end
        (2, 18, [(10, 0)], [(5, 0), (12, 1), (18, 0)]),  # and two positions before its rise are not
        (2, 17, [(10, 0)], [(5, 0), (12, 1)]),
    ],
)
def test_edges_of_both_lines_in_one_sample_are_moved_into_the_low_phase(half, end, scl, sda):
    """SCL falls at 10 and rises at 20, SDA falls at 5, rises at 10, falls at 20, and rises at 21."""
    assert _edges(line(10, 20), line(5, 10, 20, 21), half, end) == (scl, sda)


def simultaneous() -> Capture:
    """Return a read at 100 kHz, sampled at 4 MHz, in which SDA always changes in the sample in which SCL falls."""
    wave = I2cWave(20, 0)
    wave.idle(401)  # an edge off the raster of the others, and
    wave.samples[7] ^= 2  # a spike: edges are multiples of 250 ns apart, not of 5 us
    return wave.play("S A1+ 42- P .400").capture(4_000_000)


@pytest.mark.parametrize("suffix", [".sr", ".vcd", ".csv"])
@pytest.mark.parametrize("stated", [None, Fraction(4_000_000)], ids=["inferred", "stated"])
def test_one_verdict_whether_the_rate_is_stated_or_inferred_from_time_stamps(tmp_path: Path, suffix: str, stated):
    """Half a sample is 125 ns in each of the formats, not half a tick of the file's time scale."""
    formats.write(simultaneous(), tmp_path / f"read{suffix}")
    capture = formats.read(tmp_path / f"read{suffix}", stated)
    assert capture.sampled == (suffix == ".sr" or stated is not None)
    report = replay(capture)
    assert (report.verdict, report.agreed, report.divergences) == ("pass", 8, [])
    assert report.tolerance_us == pytest.approx(0.25 + 1 / 150)
    closed = I2cReplay(load(RESPONDER), capture, "SCL", "SDA").run()
    assert (closed.verdict, closed.agreed, closed.lag_worst_us) == ("pass", 8, pytest.approx(0, abs=1e-6))
    inferred = [note for note in report.notes if "all its edges are multiples of 250 ns apart" in note]
    assert len(inferred) == (not capture.sampled)


def test_equal_distances_of_ideal_edges_are_not_taken_for_a_sample_rate(tmp_path: Path):
    """All ideal edges are multiples of 5 us apart. They are replayed to the tick, so a late answer is still late."""
    wave = I2cWave(20, 0, idle=400).play("S A1+ 42- P .400")
    formats.write(wave.capture(4_000_000), tmp_path / "ideal.vcd")
    report = replay(formats.read(tmp_path / "ideal.vcd"))
    assert report.verdict == "pass" and report.tolerance_us < 0.3


@pytest.mark.parametrize("first", [1, 2])
def test_only_the_first_transfers_are_played(first: int):
    """The replay goes to 0.1 ms after the last STOP, and the firmware starts 1 ms before the capture."""
    capture = formats.read(FOLDER / "imu_round.sr")
    stop = i2c.transfers(capture)[first - 1].stop
    report = replay(capture, first=first)
    assert report.verdict == "pass" and report.events == 21 * first
    assert (report.captured_events, report.transfers, report.captured_transfers) == (63, first, 3)
    assert report.simulated_s == pytest.approx(0.0011 + stop.at / float(capture.rate), abs=1e-8)


def test_the_number_of_passes_over_the_capture_is_constant(monkeypatch: pytest.MonkeyPatch):
    reads_of_bits: list[Played] = []
    bits = Played.bits
    monkeypatch.setattr(Played, "bits", lambda part: reads_of_bits.append(part) or bits(part))
    assert replay("imu_round.sr").events == 63
    assert len(reads_of_bits) <= 3


def test_two_equal_replays_have_equal_results():
    first, second = (replay("nack.sr", "unit.dsp.settings.replies=['e4']") for _ in range(2))
    assert first.divergences == second.divergences and first.kernel_events == second.kernel_events
