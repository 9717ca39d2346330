"""The F28335 as master against captured targets: its requests, their answers, and the first difference."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.replay import BadReplay
from periph_sim.replay.i2c_master import I2cMasterReplay, _cycles
from periph_sim.replay.report import Report
from periph_sim.scene.case.load import load
from periph_sim.traces import formats
from periph_sim.traces.formats import Capture
from tests.replay.slow import firmware_case
from tests.replay.test_as_master import wave_of
from tests.traces.decode.drawing import of_bytes
from tests.traces.formats.make_traces import FOLDER

CASES = Path(__file__).resolve().parents[2] / "timing"
MASTER = CASES / "captured_master.toml"


def replay(capture: Capture | str, *changes: str, case: Path = MASTER, **options) -> Report:
    if isinstance(capture, Capture):
        given = capture
    elif capture.endswith(".sr"):
        given = formats.read(FOLDER / capture)
    else:
        given = wave_of(capture).capture(4_000_000)
    return I2cMasterReplay(load(case, list(changes)), given, "SCL", "SDA", **options).run()


@pytest.mark.parametrize(
    ("trace", "events", "addresses"), [("imu_round.sr", 63, ["1E", "53", "68"]), ("nack.sr", 19, ["53"])]
)
def test_a_captured_controller_is_imitated(trace, events, addresses):
    report = replay(trace)
    assert (report.verdict, report.role, report.divergences) == ("pass", "master", [])
    assert (report.events, report.agreed, report.addresses) == (events, events, addresses)


@pytest.mark.parametrize(
    "wave",
    [
        "S A0+ 00+ 11+ 22+ P S A1+ 33+ 44+ 55- P",
        "S A0+ 00+ Sr A1+ 33- P S A0+ P",
        "S A0+ 00- P S A1- P S A0- Sr A1+ 33- P",
        "S A0+ 00+ Sr A3+ 01+ 02- Sr A1+ 33- P",
    ],
)
def test_bytes_acks_and_repeated_starts_are_as_captured(wave):
    report = replay(wave)
    assert (report.verdict, report.agreed) == ("pass", report.events)
    assert without_end_of_main(report.notes) == []


@pytest.mark.parametrize(
    ("us", "register"),
    [
        ("5", 45),
        ("5.05", 45),
        ("5.15", 47),
        ("0.6", 1),
        ("0.5", 1),
        ("6554", 65_535),
        ("6553.9", 65_534),
        ("10_000", 65_535),
    ],
)
def test_i2cclkl_and_i2cclkh_are_the_captured_low_and_high_times_within_their_range(us, register):
    """At 10 MHz the low or high time is the register plus 5 cycles, rounded half to even; it holds 1 to 65,535."""
    assert _cycles(Fraction(us.replace("_", "")) / 1_000_000) == register


def test_stretches_of_the_captured_target_are_played_with_their_duration():
    """SCL is low for 100 us before the second byte; the master waits, so the rest is as late as in the capture."""
    quick, slow = replay("S A0+ 00+ 11+ P"), replay("S A0+ 00+ ~400 11+ P")
    assert quick.verdict == slow.verdict == "pass"
    assert slow.lag_worst_us == pytest.approx(quick.lag_worst_us, abs=6), (
        "except for the cost of the wait in the module"
    )
    assert (quick.captured_stretch_us, slow.captured_stretch_us) == (0, 100)


def test_an_acknowledge_of_the_last_byte_needs_the_other_answer_to_an_open_question():
    wave = "S A1+ 12+ 34+ P S A0+ 00+ P"
    (ack,) = replay(wave).divergences
    assert (ack.kind, ack.index, ack.expected, ack.found) == ("ACK", 6, "ACK", "NACK")
    assert replay(wave, "unit.dsp.options.i2c.mr_nack_at_count0=only_with_stp").verdict == "pass"


HEAD = """
name = "head"
duration = "1 s"

[unit.head]
firmware = "sensor_head"
modules = ["I2C-A", "TIMER0"]

[unit.head.settings]
period = "1 ms"
"""


@pytest.mark.parametrize(
    ("order", "outcome"),
    [
        ("[0x68, 0x53, 0x1E]", "pass"),
        ("[0x53, 0x68, 0x1E]", "expected address 68 write, found address 53 write"),
    ],
)
def test_firmware_without_a_script_makes_its_own_requests(tmp_path, order, outcome):
    """The sensor head reads the three chips of the trace in the configured order."""
    case = tmp_path / "head.toml"
    case.write_text(HEAD)
    report = replay("imu_round.sr", f"unit.head.settings.order={order}", case=case)
    first = report.first_divergence
    found = report.verdict if first is None else f"expected {first.expected}, found {first.found}"
    assert found == outcome


def test_the_simulated_time_does_not_depend_on_the_start_of_the_case():
    assert 0 < replay("S A0+ 00+ P").simulated_s == replay("S A0+ 00+ P", "start=10 s").simulated_s < 0.03


def test_firmware_without_a_script_runs_for_the_duration_of_the_capture(tmp_path):
    """One transfer in 75 ms, and a head with rounds every 10 ms; the progress is reported every 25 ms or more."""
    case, progress = tmp_path / "head.toml", []
    case.write_text(HEAD.replace("1 ms", "10 ms"))
    wave = wave_of("S A0+ 00+ P")
    wave.idle(300_000 - len(wave.samples))
    capture = wave.capture(4_000_000)
    report = I2cMasterReplay(load(case), capture, "SCL", "SDA").run(progress.append)
    assert len(progress) == 3 and progress == pytest.approx([25 / 75, 50 / 75, 1.0], abs=0.1)
    assert 0.075 < report.simulated_s < 0.1


def without_end_of_main(notes: list[str]) -> list[str]:
    """Return the notes except that on the end of the script, which is before the end of some captures."""
    return [note for note in notes if not note.startswith("dsp: main returned at ")]


def test_omitted_transfers_are_noted_and_a_capture_without_others_is_refused():
    report = replay("S A0+ 00+ P S A1+ P")
    assert report.verdict == "pass" and report.events == 6
    assert (report.captured_events, report.transfers, report.captured_transfers) == (10, 1, 2)
    (note,) = without_end_of_main(report.notes)
    assert note == (
        "omitted transfers, which this module cannot do as master: "
        "1 (a read of no byte, whose address was acknowledged)"
    )
    with pytest.raises(BadReplay, match=r"no transfer that this module can do as master: 1 \(the capture, or its"):
        replay("S A0+ 00+")


def test_events_that_agree_are_counted_also_after_one_that_differs():
    report = replay("S A0+ 00+ P S A0+ 07+ 08+ P", "unit.dsp.settings.script=['50 W 01', '50 W 07 08']")
    assert report.verdict == "fail" and (report.events, report.agreed) == (14, 13)


def test_a_script_that_was_filled_in_is_listed():
    assert "script" in replay("S A0+ 00+ P").filled
    assert "script" not in replay("S A0+ 00+ P", "unit.dsp.settings.script=['50 W 00']").filled


def test_a_wrong_byte_of_the_master_is_reported_with_its_write():
    report = replay("S A0+ 00+ P", "unit.dsp.settings.script=['50 W 01']")
    (byte,) = report.divergences
    assert (byte.expected, byte.found) == ("data write 00", "data write 01")
    assert any(change.what == "W I2C-A.I2CDXR" and change.value == 1 for change in byte.history)


SCRIPTED = """
from firmware.python.captured_master import REPLAY, Settings, main as script

def main(dsp, settings: Settings):
    script(dsp, settings)
    {then}
"""


def endless_case(folder: Path, then: str) -> Path:
    """Write a case whose firmware executes its script and then this statement."""
    return firmware_case(folder, "endless", SCRIPTED.format(then=then))


@pytest.mark.parametrize(
    ("then", "differs", "ends"),
    [
        (
            "dsp.spin(lambda: dsp.module('I2C-A').I2CSTR.AAS == 1)",
            False,
            "waits for I2C-A.I2CSTR.AAS since 296.100 us",
        ),
        ("dsp.spin(lambda: False)", False, ", after 50.100 ms without an edge; --patience sets this limit"),
        (
            "while True: dsp.compute(1000)",
            False,
            "computes at line 6 of endless.py: the replay ends there, after 50.",
        ),
        ("while True: script(dsp, settings)", True, "ends there, with more than twice the edges that its script needs"),
    ],
)
def test_firmware_that_does_not_return_after_its_script_fails(tmp_path, then, differs, ends):
    """After S 50W 00 P, as captured, the firmware polls, computes, or repeats the script for ever."""
    report = replay("S A0+ 00+ P", case=endless_case(tmp_path, then), patience=Fraction(50, 1000))
    assert (report.verdict, report.agreed, report.events) == ("fail", 6, 6)
    assert ends in report.notes[0]
    found = [(one.expected, one.found) for one in report.divergences]
    assert found == [("nothing more", "START")] * differs


ENDLESS_SCRIPT = "while True: script(dsp, settings)"  # endless edges
SILENT = "dsp.spin(lambda: False)"


def endless(folder: Path, then: str, **options) -> I2cMasterReplay:
    capture = of_bytes(bytes(wave_of("S A0+ 00+ P").samples), ("SCL", "SDA"), 4_000_000)
    return I2cMasterReplay(load(endless_case(folder, then)), capture, "SCL", "SDA", **options)


def test_a_replay_ends_after_the_longest_silence_or_the_maximum_of_edges(tmp_path):
    """Each limit is set to the value that the replay reached, and to one less."""
    silent = endless(tmp_path, SILENT, patience=Fraction(50, 1000))
    silent.run()
    silent._silence = silent.kernel.now - silent.log.last_edge
    assert silent._endless() == ""
    silent._silence -= 1
    assert "without an edge" in silent._endless()
    busy = endless(tmp_path, ENDLESS_SCRIPT)
    busy.run()
    busy._most_edges = busy.log.edge_count
    assert busy._endless() == ""
    busy._most_edges -= 1
    assert "more than twice the edges" in busy._endless()


@pytest.mark.parametrize("tolerance", [None, Fraction(0), Fraction(3, 10**6)])
def test_the_report_has_the_tolerance(tolerance: Fraction | None):
    assert replay("S A0+ 00+ P", tolerance=tolerance).tolerance_us == (3 if tolerance else 0)


def test_the_longest_pause_of_a_script_is_waited_for():
    """Three transfers, 50W 00, 50W 01 and 50W 02, with 60 ms of silence between them, whatever the patience."""
    waves = [wave_of(f"S A0+ {byte:02X}+ P") for byte in range(3)]
    for wave in waves[:2]:
        wave.idle(240_000)
    capture = of_bytes(b"".join(bytes(wave.samples) for wave in waves), ("SCL", "SDA"), 4_000_000)
    report = replay(capture, patience=Fraction(1, 1000))
    assert (report.verdict, report.agreed, without_end_of_main(report.notes)) == ("pass", 18, [])
