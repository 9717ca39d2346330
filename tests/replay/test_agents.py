"""Differences from a capture: those of the agents, which occur without the firmware, and those of the firmware."""

from __future__ import annotations

import re
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import pytest

from periph_sim.replay.i2c_closed_loop import I2cReplay
from periph_sim.replay.i2c_master import I2cMasterReplay
from periph_sim.replay.i2c_open_loop import I2cOpenReplay
from periph_sim.replay.report import Report
from periph_sim.replay.session import SessionReplay
from periph_sim.scene.case.load import load
from periph_sim.traces import formats
from periph_sim.traces.decode import i2c
from periph_sim.traces.formats import Capture
from tests.replay.slow import FIRMWARE, slow_case
from tests.replay.test_i2c_replay import RESPONDER, ask, captured, new_wave, traffic
from tests.scene.runs import TIMING
from tests.traces.decode.drawing import of_bytes
from tests.traces.formats.make_traces import FOLDER

FIRMWARES = TIMING.parent / "firmware" / "python"
US = Fraction(1, 10**6)
STRETCH = 400  # samples of 4 MHz: 100 us
AGENTS = "the replay's own controller and targets also differ in {} without the firmware"
THEIR_TIME, THIS_EVENT = AGENTS.format("their time"), AGENTS.format("this event")
OWN, OTHER = 0x50, 0x51


@pytest.fixture
def slow(tmp_path: Path) -> Path:
    """A case whose firmware answers reads of 0x50 with A7."""
    return slow_case(tmp_path)


def reads(*asked: tuple[int, int, int], rate: int = 4_000_000) -> Capture:
    """Return a capture of reads of one byte: (address, byte sent by the target, samples of stretch before the byte)."""
    wave = new_wave()
    for address, value, stretched in asked:
        ask(wave, address, bytes([value]), stretched)
        wave.idle(400)
    return captured(wave, rate)


def replay(capture: Capture, *changes: str, case: Path, **options) -> Report:
    return I2cReplay(load(case, list(changes)), capture, "SCL", "SDA", **options).run()


# Differences of the agents ----------------------------------------------------------------


def test_a_cut_stretch_of_another_target_is_not_attributed_to_the_firmware(slow: Path):
    """--longest-low cuts the stretch of 0x51, which an agent plays, so that all later events are 100 us early."""
    capture = reads((OTHER, 0x33, STRETCH), (OWN, 0xA7, 0))
    report = replay(capture, case=slow, addresses=[OWN], longest_low=5 * US, tolerance=20 * US)
    assert (report.verdict, report.unjudged) == ("not judged", THEIR_TIME)
    (timing,) = report.divergences
    assert timing.found == "data read 33 100.000 us earlier" and timing.cause == THEIR_TIME
    assert replay(capture, case=slow, addresses=[OWN], tolerance=20 * US).verdict == "pass"


def test_an_error_of_a_replayed_target_that_is_too_slow_is_not_attributed_to_the_firmware(slow: Path):
    """SCL is low for 200 ns, and an agent changes SDA 300 ns after its fall."""
    report = replay(reads((OTHER, 0x33, 0), (OWN, 0xA7, 0)), case=slow, addresses=[OWN], longest_low=US / 5)
    assert (report.verdict, report.unjudged) == ("not judged", THIS_EVENT)
    ack = report.divergences[0]
    assert (ack.index, ack.expected, ack.found, ack.cause) == (2, "ACK", "NACK", THIS_EVENT)


@pytest.mark.parametrize(
    ("first", "tolerance", "verdict"),
    [(OWN, 20 * US, "fail"), (OTHER, 20 * US, "not judged"), (OWN, None, "fail"), (OTHER, None, "fail")],
)
def test_the_first_difference_decides_and_times_count_only_with_a_tolerance(
    slow: Path, first: int, tolerance: Fraction | None, verdict: str
):
    """The firmware's byte is wrong in one read, and the agent's stretch is cut in the other."""
    asked = sorted([(OWN, 0xA5, 0), (OTHER, 0x33, STRETCH)], key=lambda read: read[0] != first)
    report = replay(reads(*asked), case=slow, addresses=[OWN], longest_low=5 * US, tolerance=tolerance)
    causes = {one.kind: one.cause for one in report.divergences}
    assert report.verdict == verdict
    assert causes == {"byte": f"I2CDXR = 0xA7 was written at slow.py:{line('I2CDXR')}, in main", "timing": THEIR_TIME}


@pytest.mark.parametrize("microseconds", [0, 60])
def test_a_transfer_is_delayed_by_the_stretch_of_the_previous_one(slow: Path, microseconds: int):
    """The pauses between transfers are equal to those of the capture to the tick."""
    capture = reads((OWN, 0xA7, 0), (OWN, 0xA7, 0), (OWN, 0xA7, 0))
    one = I2cReplay(load(slow, [f"unit.dsp.settings.wait={microseconds}"]), capture, "SCL", "SDA")
    one.run()
    played = i2c.transfers(one.log.capture(one.timebase, one.kernel.now), "SCL", "SDA")
    wanted = i2c.transfers(capture, "SCL", "SDA")
    per_sample = one.timebase.per_second // 4_000_000

    def pauses(transfers: list[i2c.Transfer], unit: int) -> list[int]:
        return [(b.phases[0].start.at - a.stop.at) * unit for a, b in pairwise(transfers)]

    assert pauses(played, 1) == pauses(wanted, per_sample)
    assert (played[0].stop.at - played[0].phases[0].start.at > 220 * US * one.timebase.per_second) == bool(microseconds)


@pytest.mark.parametrize(("longest_low", "tolerance", "verdict"), [(US / 5, None, "not judged"), (5 * US, US, "fail")])
def test_a_session_fails_for_a_broken_budget_unless_agents_made_another_event(
    tmp_path: Path, longest_low: Fraction, tolerance: Fraction | None, verdict: str
):
    """Different events invalidate all measurements on the bus; an early event of an agent does not."""
    limit = '[[budget]]\nname = "thinking"\nmeasure = "span:thinking"\nmax = "1 us"\n'
    case = load(slow_case(tmp_path, '"I2C-A", "SCI-A"', limit), ["unit.dsp.settings.wait=2"])
    idle = of_bytes(bytes([1]) * 4000, ("RX",), 4_000_000)
    capture = reads((OTHER, 0x33, STRETCH), (OWN, 0xA7, 0))
    given = {"addresses": [OWN], "longest_low": longest_low, "tolerance": tolerance}
    report = SessionReplay(case, capture, "SCL", "SDA", idle, "RX", **given).run()
    assert report.verdict == verdict and report.divergences[0].cause in (THIS_EVENT, THEIR_TIME)


@pytest.mark.parametrize(("acked", "nacked"), [((True, True), 0), ((False, True), 1), ((False, False), 2)])
def test_a_session_without_rounds_counts_refused_transfers(tmp_path: Path, acked: tuple[bool, ...], nacked: int):
    limit = '[[budget]]\nname = "nacked"\nmeasure = "nacked"\nmax = 0\n'
    case = load(slow_case(tmp_path, '"I2C-A", "SCI-A"', limit))
    idle = of_bytes(bytes([1]) * 4000, ("RX",), 4_000_000)
    report = SessionReplay(case, polls(*acked, address=OTHER), "SCL", "SDA", idle, "RX", addresses=[OWN]).run()
    assert [(one.name, one.worst) for one in report.budgets] == [("nacked", nacked)]


def test_stretches_as_captured_do_not_make_later_transfers_late(slow: Path):
    """The firmware stretches for 80 us, the captured target for 100: each read is 20 us early, and none is late."""
    capture = reads(*[(OWN, 0xA7, STRETCH)] * 3)
    report = replay(capture, "unit.dsp.settings.wait=95", case=slow, longest_low=10 * US, tolerance=20 * US)
    assert report.verdict == "pass" and 19 < report.lag_worst_us < 20


# A controller that polls --------------------------------------------------------------


def polls(*acked: bool, data: bool = True, address: int = OWN) -> Capture:
    """Return a capture of writes to one address, 100 us apart, of which these are acknowledged."""
    asked = {False: f"{address << 1:02X}-", True: f"{address << 1:02X}+{' A5+' * data}"}
    return traffic(" ".join(f"S {asked[ack]} P .400" for ack in acked))


def test_firmware_that_is_busy_after_the_last_captured_poll_is_not_judged():
    """Nothing was written that the target could store, so only the captured polls are played."""
    report = replay(polls(True, False, False, True, data=False), "unit.dsp.settings.busy=['5 ms']", case=RESPONDER)
    assert report.verdict == "not judged" and report.divergences[0].found == "NACK"
    assert report.unjudged == (
        "the firmware refuses 50 once more than the captured target did: a controller that polls would try again, "
        "but here it polls only as often as in the capture"
    )


@pytest.mark.parametrize(
    ("asked", "busy"),
    [
        (polls(True, True), ["5 ms"]),
        (polls(True, True, data=False), ["5 ms"]),
        (polls(False, False, True), []),
    ],
    ids=["no refusal", "no refusal and no data", "never answered"],
)
def test_firmware_that_refuses_without_an_answer_and_a_captured_refusal_before_fails(asked: Capture, busy: list[str]):
    asleep = "1 s" if not busy else "0 s"
    changes = f"unit.dsp.settings.busy={busy}", f"unit.dsp.settings.asleep='{asleep}'"
    assert replay(asked, *changes, case=RESPONDER).verdict == "fail"


# Differences of the firmware, with its statement --------------------------------------


def line(text: str, source: str = FIRMWARE) -> int:
    """Return the number of the only line with a text."""
    (number,) = (number for number, words in enumerate(source.splitlines(), 1) if text in words)
    return number


def shipped(name: str, text: str) -> str:
    """Return a place in shipped firmware, as a report names it."""
    return f"{name}:{line(text, (FIRMWARES / name).read_text(encoding='utf-8'))}"


def round_of(case: str, player: type[I2cReplay] | type[I2cMasterReplay] | type[I2cOpenReplay], *changes: str) -> Report:
    return player(load(TIMING / case, list(changes)), formats.read(FOLDER / "imu_round.sr"), "SCL", "SDA").run()


@pytest.mark.parametrize("player", [I2cReplay, I2cOpenReplay])
def test_a_wrong_byte_names_the_statement_that_wrote_it(tmp_path: Path, player: type[I2cReplay] | type[I2cOpenReplay]):
    """The next byte is written while the wrong byte is on the wires."""
    case = slow_case(tmp_path)
    write = "i2c.I2CDXR.all = settings.byte"
    more = f"{write}\n        dsp.spin(lambda: i2c.I2CSTR.XRDY == 1)\n        i2c.I2CDXR.all = 0x33"
    (tmp_path / "slow.py").write_text(FIRMWARE.replace(write, more))
    (wrong,) = player(load(case, []), reads((OWN, 0xA5, 0)), "SCL", "SDA").run().divergences
    assert wrong.found == "data read A7"
    assert wrong.cause == f"I2CDXR = 0xA7 was written at slow.py:{line(write)}, in main"


def test_a_wrong_acknowledge_names_the_statement_that_was_executed():
    first = round_of("imu_hil_published.toml", I2cReplay, "unit.dsp.settings.order=[0x1e]").divergences[0]
    assert (first.expected, first.found) == ("ACK", "NACK")
    assert first.cause == f"the firmware was at {shipped('imu_hil.py', 'I2CSTR.AAS == 1)')}, in batch_read"


def test_a_master_names_the_statement_that_wrote_its_byte_or_address():
    wrong = {"68 W 1E": ("I2CDXR = 0x1E", "I2CDXR.all"), "67 W 1D": ("I2CSAR = 0x67", "I2CSAR.all")}
    for script, (value, text) in wrong.items():
        first = round_of("captured_master.toml", I2cMasterReplay, f"unit.dsp.settings.script=['{script}']").divergences[
            0
        ]
        assert first.cause.startswith(f"{value} was written at captured_master.py:")
        number = int(first.cause.partition(":")[2].partition(",")[0])
        source = (FIRMWARES / "captured_master.py").read_text(encoding="utf-8").splitlines()
        assert text in source[number - 1]


def test_a_master_names_the_statement_that_was_executed_where_only_its_time_differs():
    (timing,) = (
        I2cMasterReplay(
            load(TIMING / "captured_master.toml"), reads((OWN, 0xA5, 0)), "SCL", "SDA", tolerance=Fraction(0)
        )
        .run()
        .divergences
    )
    assert timing.kind == "timing" and timing.cause.startswith("the firmware was at captured_master.py:")


def test_an_image_names_file_line_and_address():
    """The image sends zeros because no host frame has arrived, and it is not ready at the first captured request."""
    first = round_of("imu_hil_image.toml", I2cReplay).divergences[0]
    assert re.fullmatch(r"the firmware was at \w+ \(\w+\.\w+:\d+, 0x\w{6}\)", first.cause)


def test_an_answer_that_is_late_names_the_statement_that_is_executed(slow: Path):
    report = I2cOpenReplay(load(slow, ["unit.dsp.settings.wait=100"]), reads((OWN, 0xA7, 0)), "SCL", "SDA").run()
    late = next(one for one in report.divergences if one.kind == "timing")
    assert late.found.startswith("SCL held for another")
    assert late.cause == f"the firmware was at slow.py:{line('thinking')}, in main"
