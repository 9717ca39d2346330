"""The real I2C captures against the firmware's slave: the same STARTs, bytes, ACKs and STOPs on the wires again.

    both halves, no chip:  every capture comes out as it was, to the tick
    the F28335's slave:    every capture but those named in CANNOT

SCL's low phases are the capture's, so whatever the captured target needed the firmware is given too.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from pathlib import Path

import pytest

from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.time import Timebase
from periph_sim.replay import BadReplay
from periph_sim.replay.channels import channel_map
from periph_sim.replay.i2c_closed_loop import I2cReplay
from periph_sim.replay.report import Report
from periph_sim.replay.setup import played
from periph_sim.scene.case.load import load as load_case
from periph_sim.traces.decode import i2c
from tests.captures.test_captures_decode import TOO_LARGE, channel, load, options
from tests.captures.where import decoded, needs_captures, oracle
from tests.docs.pages import FILE
from tests.profiles import explores
from tests.replay.bus import both_halves

CASE = Path(__file__).resolve().parents[2] / "timing" / "responder.toml"
NAMES = decoded("i2c")
# Transfers of the million edges. Those behind the first 135 are busy times, as in i2c_cat24c256_ackpoll.
FIRST = {TOO_LARGE: 200 if explores() else 60}

# What no slave of this module can do: where the wires part first, and why.
CANNOT = {
    # The controller sends address 00 with the write bit and the sensor answers with data, so the bytes and their
    # acknowledges come from the wrong sides. To the F28335 00 is the general call, and it acknowledges all of it.
    "i2c_mlx90614_5s": (9, "NACK", "ACK"),
}

# The client refuses its address three times, each time after holding SCL low for 4 ms in the ACK slot. No slave of this
# module can stretch there: the controller plays the low phase, and the firmware stays out of reach.
NOBODY = "i2c_mdfu_stretch_csv"

# Captures with other devices on the bus than the one that answers most often: those an agent answers for.
SEVERAL = {
    "imu_round": [0x1E, 0x53, 0x68],
    "imu_session": [0x1E, 0x53, 0x68],
    "i2c_gigabyte_spd": [0x50, 0x69],
    "i2c_trekstor_accel_pmic_rtc": [0x15, 0x34, 0x51],
}

# Captures that begin within a transfer: clock pulses before the first START, not played.
BEGINS_WITHIN = {
    "i2c_24aa025uid_trigger_sda_low": 28,
    "i2c_24lc02b_powerup": 1,  # power-up
    "i2c_at24c16c_powerup": 1,  # power-up
    "i2c_atsha204a": 10,
    "i2c_ds1307_200khz": 82,
    "i2c_edid_le46b620r3p": 19,
    "i2c_eeprom_busy": 27,
    "i2c_sla24c02_powerup": 2,  # power-up
}

STYLES = {
    "polled": (),
    "polled, FIFO": ("unit.dsp.settings.fifo=true",),
    "interrupts": ("unit.dsp.settings.style=interrupt",),
    "interrupts, FIFO": ("unit.dsp.settings.style=interrupt", "unit.dsp.settings.fifo=true"),
}
REPLAYED = [name for name in NAMES if name not in CANNOT]


def lines(name: str) -> tuple[str, str]:
    given = options(name, "i2c")
    return channel(name, given["scl"]), channel(name, given["sda"])


@cache
def replayed(name: str, style: str = "polled", address: int | None = None) -> Report:
    scl, sda = lines(name)
    own = [] if address is None else [address]
    return I2cReplay(load_case(CASE, list(STYLES[style])), load(name), scl, sda, own, FIRST.get(name)).run()


@pytest.mark.parametrize("name", NAMES)
def test_both_halves_of_the_capture_put_together_are_the_capture(name: str):
    capture = load(name)
    transfers = [transfer for transfer in i2c.transfers(capture, *lines(name)) if transfer.phases][: FIRST.get(name)]
    outcome = both_halves(capture, transfers)
    assert outcome.divergence is None
    assert outcome.agreed == sum(len(list(i2c.events_of(transfer))) for transfer in transfers)
    assert outcome.lag < 1e-9, "less than a tick of the wires"


@pytest.mark.parametrize(
    ("name", "style"),
    [(name, style) for name in REPLAYED for style in STYLES if name not in FIRST or style == "polled"],
)
def test_the_firmwares_slave_answers_as_the_captured_target_did(name: str, style: str):
    report = replayed(name, style)
    assert report.first_divergence is None
    assert report.verdict == ("not judged" if name == NOBODY else "pass")
    assert report.events == report.agreed > 0
    assert report.stretch_total_us == 0, "the captured low phases are time enough"
    assert report.lag_samples < 0.01, "what is left is the rounding to ticks, of captures at 24 MHz"


@pytest.mark.parametrize("name", [name for name in REPLAYED if name not in FIRST])
def test_bytes_and_nacks_are_as_many_as_the_oracle_lists(name: str):
    texts = [said.text for said in oracle(name, "i2c")]
    report = replayed(name)
    assert report.bytes == sum(text.startswith(("Address", "Data")) for text in texts)
    assert report.nacks == texts.count("NACK")


@pytest.mark.parametrize("name", [name for name in REPLAYED if name not in FIRST])
def test_the_firmware_reads_from_i2cdrr_what_was_written_to_its_address(name: str):
    scl, sda = lines(name)
    capture = load(name)
    taken: list[int] = []

    def collect(record: Record) -> None:
        if record.what == "R I2C-A.I2CDRR":
            taken.append(record.value)

    def listen(recorder: Recorder, timebase: Timebase) -> None:
        recorder.subscribe([Kind.ACCESS], collect)

    report = I2cReplay(load_case(CASE), capture, scl, sda, subscribe=listen).run()
    own = int(report.addresses[0], 16)
    phases = [phase for transfer in i2c.transfers(capture, scl, sda) for phase in transfer.phases]
    written = [byte for p in phases if p.address == own and not p.read and p.bytes[0].acked for byte in p.data]
    assert taken == written


@needs_captures
@pytest.mark.parametrize("name", CANNOT)
def test_what_the_slave_cannot_do_is_where_the_wires_part(name: str):
    report = replayed(name)
    first = report.first_divergence
    assert report.verdict == "fail" and first is not None
    assert (first.index, first.expected, first.found) == CANNOT[name]


@pytest.mark.parametrize(("name", "address"), [(name, address) for name in NAMES for address in SEVERAL.get(name, [])])
def test_any_device_of_a_bus_of_several_can_be_the_firmwares(name: str, address: int):
    report = replayed(name, address=address)
    assert report.verdict == "pass" and report.addresses == [f"{address:02X}"]
    others = ", ".join(f"{other:02X}" for other in SEVERAL[name] if other != address)
    assert f"an agent answers for {others}, as captured" in report.notes


@pytest.mark.parametrize("name", NAMES)
def test_what_is_not_played_or_not_answered_by_the_firmware_is_told(name: str):
    notes = replayed(name).notes
    within = [note for note in notes if "before the capture's first START" in note]
    assert [note.rpartition(" ")[2] for note in within] == ([str(BEGINS_WITHIN[name])] if name in BEGINS_WITHIN else [])
    assert any("the firmware does not answer" in note for note in notes) == (name == NOBODY)
    assert any("an agent answers" in note for note in notes) == (name in SEVERAL)
    assert not any("cannot be set to repeat" in note for note in notes), "every refusal can be imitated"


# Their controllers ask again and again whether the target is still busy. It is so for as long as in the capture, while
# the questions come earlier, so that their number differs.
POLLED = {"i2c_24aa025uid_busy_2ms", "i2c_cat24c256_ackpoll"}


def cut_off(transfer: i2c.Transfer, usual: Fraction) -> Fraction:
    """By how much a transfer is shorter where no low phase is longer than the usual one; positions."""
    lows = [bit.low for phase in transfer.phases for byte in phase.bytes for bit in byte.bits]
    conditions = [phase.start for phase in transfer.phases[1:]]
    conditions += [] if transfer.stop is None else [transfer.stop]
    lows += [condition.low for condition in conditions]
    return sum((max(Fraction(0), low - usual) for low in lows if low is not None), Fraction(0))


@pytest.mark.parametrize("name", [name for name in REPLAYED if name not in FIRST])
def test_re_timed_the_bytes_stay_and_times_differ_by_what_was_cut_off_the_low_phases(name: str):
    """Every low phase as short as the usual one: what a target or a slow controller had made of them goes."""
    part = played(load(name), *lines(name))
    report = I2cReplay(load_case(CASE), load(name), *lines(name), longest_low=part.low / part.rate).run()
    if name in POLLED:
        assert report.verdict == "pass" and report.refusals != report.captured_refusals
        return
    assert report.first_divergence is None and report.stretch_total_us == 0
    most = max(cut_off(transfer, part.low) for transfer in part.transfers)
    assert report.lag_samples <= float(most) + 0.01


@needs_captures
def test_a_controller_in_a_hurry_leaves_the_pauses_to_the_firmware():
    """The sensor's controller holds SCL low for up to 60 us; at 5 us the firmware still answers the same bytes."""
    scl, sda = lines("i2c_sht21_nohold")
    low = Fraction(5, 10**6)
    report = I2cReplay(load_case(CASE), load("i2c_sht21_nohold"), scl, sda, longest_low=low).run()
    assert report.verdict == "pass" and report.agreed == replayed("i2c_sht21_nohold").agreed
    assert report.lag_worst_us > 100


@needs_captures
@pytest.mark.parametrize(("busy_us", "refused"), [(3500, 64), (1500, 0), (5000, 127)])
def test_the_memory_of_the_first_page_brackets_the_busy_time_of_a_real_one(tmp_path: Path, busy_us: int, refused: int):
    """Its controller waits 2 ms after each write and each refusal, but 20 ms after the last one."""
    page = (CASE.parents[1] / "docs" / "first_slave.md").read_text(encoding="utf-8")
    for name, text in FILE.findall(page):
        (tmp_path / name).write_text(text, encoding="utf-8")
    case = load_case(tmp_path / "memory.toml", [f"unit.dsp.settings.busy_us={busy_us}"])
    report = I2cReplay(case, load("i2c_24aa025uid_busy_2ms"), "SCL", "SDA").run()
    assert report.verdict == "pass" and report.agreed == report.events
    assert (report.refusals, report.captured_refusals) == (refused, 64)
    assert report.captured_busy_us == [2030.5, 4064.5]


@pytest.mark.parametrize("name", NAMES)
def test_swapped_lines_are_recognized_and_lines_in_order_are_not(name: str):
    scl, sda = lines(name)
    capture = load(name)
    channel_map(capture, f"scl={scl},sda={sda}")
    with pytest.raises(BadReplay, match=f"SCL and SDA are swapped: .*; give --map scl={scl},sda={sda}$"):
        channel_map(capture, f"scl={sda},sda={scl}")
