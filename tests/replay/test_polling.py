"""A replayed controller polls a busy target until it answers, as often as the firmware needs, not as captured."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.replay.i2c_closed_loop import I2cReplay
from periph_sim.replay.report import Report
from periph_sim.replay.session import SessionReplay
from periph_sim.scene.case.load import load
from periph_sim.traces.decode.i2c import events, transfers
from periph_sim.traces.decode.uart import Line
from periph_sim.traces.formats import Capture
from tests.replay.slow import firmware_case
from tests.replay.test_i2c_replay import CASES, ask, captured, new_wave, replay, traffic
from tests.traces.decode.drawing import of_bytes

MEMORY = 0x50
RATE = 4_000_000
NINTH = 90  # us from a START to the rise of SCL for the ACK of the address
FIRST = 5 + 200 + NINTH  # us from the STOP of a write to the first ACK
US = Fraction(1, 10**6)

EEPROM = """
from dataclasses import dataclass

from periph_sim.firmware import start_i2c


@dataclass
class Settings:
    busy_us: int
    broken: bool = False
    stretch_us: int = 0


def main(dsp, settings):
    start_i2c(dsp, own_address=0x50)
    i2c = dsp.module("I2C-A")
    i2c.I2CMDR.IRS = 1
    memory, pointer = [0xFF] * 256, 0
    while True:
        dsp.spin(lambda: i2c.I2CSTR.AAS == 1)
        if i2c.I2CSTR.SDIR == 1:
            while i2c.I2CSTR.AAS == 1:
                dsp.compute(150 * settings.stretch_us)
                i2c.I2CDXR.all = memory[pointer]
                pointer += 1
                dsp.spin(lambda: i2c.I2CSTR.XRDY == 1 or i2c.I2CSTR.AAS == 0)
            continue
        received = []
        while dsp.spin_either(lambda: i2c.I2CSTR.RRDY == 1, lambda: i2c.I2CSTR.AAS == 0) == 0:
            received.append(i2c.I2CDRR.all)
        if not received:
            continue
        pointer = received[0]
        memory[pointer : pointer + len(received) - 1] = received[1:]
        if received[1:]:
            if settings.broken:
                memory[pointer] ^= 1
            i2c.I2CMDR.IRS = 0
            dsp.compute(150 * settings.busy_us)
            i2c.I2CMDR.IRS = 1
"""


def stored_and_read(refused: int, *, wait_us: int = 200, again: bool = False, writes: int = 2) -> Capture:
    """Return writes of two bytes, each followed by polls until the memory answers, and a read of the last byte.

    again: polls follow by a repeated START instead of STOP and START.
    """
    wait = f".{wait_us * RATE // 10**6}"
    polls = refused * f"A0- {'Sr' if again else f'P {wait} S'} "
    wave = new_wave()
    for number in range(writes):
        wave.play(f"S A0+ 10+ {0x20 + number:02X}+ P {wait} S {polls} A0+ 10+ P .400")
    ask(wave, MEMORY, bytes([0x20 + writes - 1]))
    return captured(wave)


@pytest.fixture
def memory(tmp_path: Path) -> Path:
    return firmware_case(tmp_path, "memory", EEPROM, more="settings = { busy_us = 0 }\n")


def replay_memory(case: Path, capture: Capture, busy_us: int, *changes: str, **options) -> Report:
    busy = f"unit.dsp.settings.busy_us={busy_us}"
    return replay(capture, busy, *changes, case=case, addresses=[MEMORY], tolerance=2 * US, **options)


@pytest.mark.parametrize("again", [False, True], ids=["by STOP", "by repeated START"])
@pytest.mark.parametrize("polls", [0, 1, 3, 7])
def test_firmware_is_polled_until_it_is_ready_and_all_other_events_agree(memory: Path, polls: int, again: bool):
    """The firmware is ready shortly before the START of a poll. A module that misses a START does not answer."""
    busy = FIRST + (105 if again else 310) * polls - NINTH - 5
    capture = stored_and_read(3, again=again)
    report = replay_memory(memory, capture, busy)
    assert report.verdict == "pass" and report.divergences == [] and report.agreed == report.events
    assert report.events == len(events(capture, "SCL", "SDA")) + 2 * (polls - 3) * (3 if again else 4)
    assert (report.refusals, report.captured_refusals) == (2 * polls, 6)
    assert report.lag_worst_us < 1
    if polls:
        refused, acknowledged = report.busy_us
        assert refused < busy < acknowledged
        assert acknowledged - refused == pytest.approx(105 if again else 310, abs=1)
    assert (report.busy_us == report.captured_busy_us) == (polls == 3)


@pytest.mark.parametrize("busy", [0, 900, 4000])
@pytest.mark.parametrize("again", [False, True])
def test_a_wrong_byte_has_its_time_in_the_capture_however_long_the_firmware_is_busy(memory, busy, again):
    capture = stored_and_read(3, again=again)
    report = replay_memory(memory, capture, busy, "unit.dsp.settings.broken=true")
    reference = replay_memory(memory, capture, 1000, "unit.dsp.settings.broken=true")
    (wrong,), (same,) = report.divergences, reference.divergences
    assert (report.verdict, wrong.expected, wrong.found) == ("fail", "data read 21", "data read 20")
    assert wrong.capture_s == same.capture_s == pytest.approx(float(capture.length) / RATE, abs=250e-6)
    assert (report.refusals > 6) == (wrong.replay_s > wrong.capture_s + 1e-6)
    assert wrong.history, "the second run polls as the first one did"


def polled_at_first(again: bool) -> Capture:
    """Return three writes, polled once after 200 us, once after 500 us, and not at all, and a read of the last byte."""
    wave = new_wave()
    for number, wait in enumerate((800, 2000)):
        poll = f"A0- ~{wait} Sr" if again else f"A0- P .{wait} S"
        wave.play(f"S A0+ 10+ {0x40 + number:02X}+ P .400 S {poll} A0+ 10+ P .400")
    return captured(wave.play("S A0+ 10+ 42+ P .400 S A0+ 10+ P .400 S A1+ 42- P"))


@pytest.mark.parametrize("again", [False, True])
def test_a_controller_polls_with_the_pause_of_its_last_polls(memory: Path, again: bool):
    capture = polled_at_first(again)
    (wrong,) = replay_memory(memory, capture, 300, "unit.dsp.settings.broken=true").divergences
    report = replay_memory(memory, capture, 2000, "unit.dsp.settings.broken=true")
    (later,) = report.divergences
    assert (later.expected, later.found, later.capture_s) == (wrong.expected, wrong.found, wrong.capture_s)
    assert later.capture_s == pytest.approx(capture.length / RATE - 110e-6, abs=1e-6), (
        "of the capture, not of the replay"
    )
    assert report.refusals == 7 + 4 + 4, "every 310 us after the first write, every 610 us after the others"


def test_an_address_that_was_never_polled_is_not_polled(memory: Path):
    capture = traffic("S A0+ 10+ 33+ P .400 S A0- P .400 S A0+ 10+ 33+ P .400 S A1+ 33- P")
    report = replay_memory(memory, capture, 2000)
    assert report.verdict == "fail" and report.divergences[0].found == "NACK" and report.refusals > 3


def test_a_memory_that_never_answers_ends_the_replay_after_patience(memory: Path):
    report = replay_memory(memory, stored_and_read(1), 10**6, patience=Fraction(1, 100))
    assert report.verdict == "fail" and 30 < report.refusals < 36
    assert report.notes[0] == (
        "the firmware refuses 50 where it is acknowledged in the capture, since 990.000 us: the replay ends there, "
        "after 10.000 ms; --patience sets this limit"
    )


@pytest.mark.parametrize(
    "words",
    [
        "S A0- P .400 S A0+ 10+ P",  # no write before, so not busy
        "S A0+ 10+ 33+ P .400 S A0- P .400 S A2- P .400 S A2+ 10+ P .400 S A0+ 10+ P",  # another target in between
        "S A2+ 10+ 33+ P .400 S A0- P .400 S A0+ 10+ P",  # a write to another target does not make this one busy
        "S A1+ FF- P .400 S A0- P .400 S A0+ 10+ P",  # after a read
        "S A0+ 10+ 33+ P .400 S A0- P .400 S A0- 10- P",  # a refusal with data, at the end
    ],
)
def test_other_refusals_than_polls_of_a_busy_target_are_played_as_captured(memory: Path, words: str):
    report = replay_memory(memory, traffic(words), 0)
    assert report.verdict == "fail" and report.divergences[0].found == "ACK"


def test_polls_of_another_target_in_between_are_played_as_captured(memory: Path):
    words = "S A0+ 10+ 33+ P .400 S A0- P .400 S A2- P .400 S A2+ 10+ P .400 S A0+ 10+ P"
    assert replay_memory(memory, traffic(words), 400).verdict == "pass"


def test_a_read_of_another_target_does_not_end_the_busy_time_of_a_target(memory: Path):
    capture = traffic("S A0+ 10+ 33+ P .400 S A3+ FF- P .400 S A0- P .400 S A0+ 10+ P")
    for busy, polls in ((0, 0), (1000, 3)):
        report = replay_memory(memory, capture, busy)
        assert report.verdict == "pass" and (report.captured_refusals, report.refusals) == (1, polls)


def test_polls_are_added_before_the_first_captured_poll(memory: Path):
    capture = traffic("S A0+ 10+ 33+ P .800 S A0+ 10+ P .400 S A0+ 10+ 33+ P .800 S A0- P .800 S A0+ 10+ P .400")
    report = replay_memory(memory, capture, 800)
    assert report.verdict == "pass" and (report.refusals, report.captured_refusals) == (4, 1)


def test_patience_is_a_limit_for_each_write(memory: Path):
    report = replay_memory(memory, stored_and_read(1), 5000, patience=Fraction(6, 1000))
    assert report.verdict == "pass" and report.busy_us[1] > 5000


def test_a_session_keeps_the_captured_polls(memory: Path):
    case = load(memory, ["unit.dsp.settings.busy_us=3000", 'unit.dsp.modules=["I2C-A", "SCI-A"]'])
    idle = of_bytes(bytes([1]) * 4000, ("RX",), RATE)
    capture = stored_and_read(3)
    report = SessionReplay(
        case, capture, "SCL", "SDA", idle, "RX", wanted=Line(Fraction(115200)), addresses=[MEMORY]
    ).run()
    assert report.verdict == "not judged" and "polls only as often as in the capture" in report.unjudged


def test_firmware_with_the_captured_busy_times_is_polled_as_captured(memory: Path):
    """The responder takes its busy times from the capture, so it refuses exactly the captured polls."""
    report = I2cReplay(load(CASES / "responder.toml", []), stored_and_read(3), "SCL", "SDA").run()
    assert report.verdict == "pass" and report.refusals == report.captured_refusals == 6
    assert report.busy_us == pytest.approx(report.captured_busy_us, abs=0.2)


def test_polls_as_captured_are_not_limited_by_patience(memory: Path):
    report = replay_memory(memory, stored_and_read(20), 195 + 310 * 20, patience=Fraction(1, 1000))
    assert report.verdict == "pass" and report.refusals == 40


@pytest.mark.parametrize("stretch", [0, 150, 300, 500, 1000])
@pytest.mark.parametrize(("busy", "polls"), [(0, 0), (400, 2), (600, 4), (1000, 7)])
def test_time_that_longest_low_removes_at_polls_compensates_for_a_stretch(memory, busy, polls, stretch):
    """SCL is low for 205 us before each repeated START of two polls, of which 20 us are played.

    The time removed before each played poll compensates for the stretch in the same transfer. The next transfer is late
    by the rest.
    """
    capture = traffic("S A0+ 10+ 33+ P .800 S A0- ~800 Sr A0- ~800 Sr A0+ 10+ Sr A1+ 33- P .400 S A0+ 10+ P")
    changes = (f"unit.dsp.settings.busy_us={busy}", f"unit.dsp.settings.stretch_us={stretch}")
    replayed = I2cReplay(load(memory, changes), capture, "SCL", "SDA", addresses=[MEMORY], longest_low=20 * US)
    report = replayed.run()
    assert (report.verdict, report.refusals) == ("pass", polls)
    wires = replayed.log.capture(replayed.timebase, replayed.kernel.now)
    begun = transfers(wires, "SCL", "SDA")[-1].phases[0].start.at - replayed.origin
    due = 1695 + 305 * (polls - 2)
    late = max(0, max(0, stretch - 14.6) - 185 * polls)  # 14.6 us: ACK and the low phase of the first bit
    assert begun * 1_000_000 / replayed.timebase.per_second == pytest.approx(due + late, abs=0.1)


# Captures that end before an answer ---------------------------------------------


def unanswered(refused: int, *, again: bool = False, bits: int | None = None) -> Capture:
    """Return a write of two bytes, and polls until the end of the capture.

    again: polls follow by a repeated START instead of STOP and START.
    bits: the capture ends after this number of bits of a further poll; None to end it after the last whole poll.
    """
    between = " Sr " if again else " P .800 S "
    wave = new_wave().play(f"S A0+ 10+ 20+ P .800 S {between.join(refused * ['A0-'])}")
    if bits is None:
        return captured(wave.play("P"))
    return wave.play(between + (f"{MEMORY << 1:08b}"[:bits] + ":" if bits else "")).capture(RATE)


@pytest.mark.parametrize("bits", [None, 0, 3, 8], ids=str)
@pytest.mark.parametrize("again", [False, True], ids=["by STOP", "by repeated START"])
@pytest.mark.parametrize("polls", [0, 1, 3])
def test_firmware_that_answers_a_poll_that_is_never_answered_in_the_capture_passes(memory, polls, again, bits):
    busy = FIRST + (105 if again else 310) * polls - NINTH - 5
    report = replay_memory(memory, unanswered(4, again=again, bits=bits), busy)
    assert (report.verdict, report.divergences) == ("pass", [])
    assert (report.refusals, report.captured_refusals) == (polls, 4)
    stop = 1 if bits is None or not again else 0
    assert report.agreed == report.events == 8 + (3 if again else 4) * polls + 3 + stop
    assert report.notes[-1] == (
        "the firmware answers a poll of 50, but the capture ends before the captured target answers: "
        "the remaining polls are not played"
    )


@pytest.mark.parametrize("again", [False, True])
def test_firmware_that_is_still_busy_at_the_end_of_the_capture_passes(memory: Path, again: bool):
    report = replay_memory(memory, unanswered(4, again=again), 10**5)
    assert report.verdict == "pass" and report.refusals == 4 and report.agreed == report.events
    assert not any("answers" in note for note in report.notes)
