"""The real I2C captures are replayed to a slave of firmware: START, bytes, ACK and STOP must occur as captured.

    both halves, no chip:  every capture is reproduced, exact to the tick
    the F28335's slave:    every capture except those in CANNOT

The low phases of SCL are those of the capture, so the firmware has as much time as the captured target had.
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
# Transfers of the million edges. Those after the first 135 are busy times, as in i2c_cat24c256_ackpoll.
FIRST = {TOO_LARGE: 200 if explores() else 60}

# Captures that no slave with this module can answer: index and values of the first divergence, with the reason.
CANNOT = {
    # The controller sends address 00 with the write bit and the sensor answers with data, so the bytes and their
    # acknowledges come from the wrong sides. For the F28335, 00 is the general call, which it acknowledges as a whole.
    "i2c_mlx90614_5s": (9, "NACK", "ACK"),
}

# The client does not acknowledge its address three times, each time after holding SCL low for 4 ms before the ACK.
# A slave with this module cannot stretch there: the controller drives the low phase, and firmware is not addressed.
NOBODY = "i2c_mdfu_stretch_csv"

# Captures with several devices on the bus: an agent answers for those other than the most frequent one.
SEVERAL = {
    "imu_round": [0x1E, 0x53, 0x68],
    "imu_session": [0x1E, 0x53, 0x68],
    "i2c_gigabyte_spd": [0x50, 0x69],
    "i2c_trekstor_accel_pmic_rtc": [0x15, 0x34, 0x51],
}

# Captures that begin within a transfer: the number of clock pulses before the first START, which are not replayed.
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
def test_both_halves_of_a_capture_reproduce_it(name: str):
    capture = load(name)
    transfers = [transfer for transfer in i2c.transfers(capture, *lines(name)) if transfer.phases][: FIRST.get(name)]
    outcome = both_halves(capture, transfers)
    assert outcome.divergence is None
    assert outcome.agreed == sum(len(list(i2c.events_of(transfer))) for transfer in transfers)
    assert outcome.lag < 1e-9, "the lag is less than a tick of the wires"


@pytest.mark.parametrize(
    ("name", "style"),
    [(name, style) for name in REPLAYED for style in STYLES if name not in FIRST or style == "polled"],
)
def test_the_slave_of_firmware_answers_as_the_captured_target(name: str, style: str):
    report = replayed(name, style)
    assert report.first_divergence is None
    assert report.verdict == ("not judged" if name == NOBODY else "pass")
    assert report.events == report.agreed > 0
    assert report.stretch_total_us == 0, "the captured low phases are long enough"
    assert report.lag_samples < 0.01, "only the rounding to ticks of captures at 24 MHz is left"


@pytest.mark.parametrize("name", [name for name in REPLAYED if name not in FIRST])
def test_counts_of_bytes_and_nacks_equal_those_of_the_oracle(name: str):
    texts = [said.text for said in oracle(name, "i2c")]
    report = replayed(name)
    assert report.bytes == sum(text.startswith(("Address", "Data")) for text in texts)
    assert report.nacks == texts.count("NACK")


@pytest.mark.parametrize("name", [name for name in REPLAYED if name not in FIRST])
def test_the_firmware_reads_the_bytes_written_to_its_address_from_i2cdrr(name: str):
    scl, sda = lines(name)
    capture = load(name)
    taken: list[int] = []

    def collect(record: Record) -> None:
        if record.what == "R I2C-A.I2CDRR":
            taken.append(record.value)

    def subscribe(recorder: Recorder, timebase: Timebase) -> None:
        recorder.subscribe([Kind.ACCESS], collect)

    report = I2cReplay(load_case(CASE), capture, scl, sda, subscribe=subscribe).run()
    own = int(report.addresses[0], 16)
    phases = [phase for transfer in i2c.transfers(capture, scl, sda) for phase in transfer.phases]
    written = [byte for p in phases if p.address == own and not p.read and p.bytes[0].acked for byte in p.data]
    assert taken == written


@needs_captures
@pytest.mark.parametrize("name", CANNOT)
def test_the_first_divergence_is_the_one_that_the_slave_cannot_avoid(name: str):
    report = replayed(name)
    first = report.first_divergence
    assert report.verdict == "fail" and first is not None
    assert (first.index, first.expected, first.found) == CANNOT[name]


@pytest.mark.parametrize(("name", "address"), [(name, address) for name in NAMES for address in SEVERAL.get(name, [])])
def test_firmware_can_replace_any_device_of_a_bus(name: str, address: int):
    report = replayed(name, address=address)
    assert report.verdict == "pass" and report.addresses == [f"{address:02X}"]
    others = ", ".join(f"{other:02X}" for other in SEVERAL[name] if other != address)
    assert f"an agent answers for {others}, as captured" in report.notes


@pytest.mark.parametrize("name", NAMES)
def test_notes_list_what_is_not_replayed_or_not_answered_by_the_firmware(name: str):
    notes = replayed(name).notes
    within = [note for note in notes if "before the capture's first START" in note]
    assert [note.rpartition(" ")[2] for note in within] == ([str(BEGINS_WITHIN[name])] if name in BEGINS_WITHIN else [])
    assert any("the firmware does not answer" in note for note in notes) == (name == NOBODY)
    assert any("an agent answers" in note for note in notes) == (name in SEVERAL)
    assert not any("cannot be set to repeat" in note for note in notes), "every NACK can be repeated"


# Their controllers poll until the target is no longer busy. It is busy as long as in the capture, but with shorter low
# phases the polls come earlier, so their number differs.
POLLED = {"i2c_24aa025uid_busy_2ms", "i2c_cat24c256_ackpoll"}


def cut_off(transfer: i2c.Transfer, usual: Fraction) -> Fraction:
    """Return by how much a transfer is shorter, in positions, if no low phase is longer than the usual one."""
    lows = [bit.low for phase in transfer.phases for byte in phase.bytes for bit in byte.bits]
    conditions = [phase.start for phase in transfer.phases[1:]]
    conditions += [] if transfer.stop is None else [transfer.stop]
    lows += [condition.low for condition in conditions]
    return sum((max(Fraction(0), low - usual) for low in lows if low is not None), Fraction(0))


@pytest.mark.parametrize("name", [name for name in REPLAYED if name not in FIRST])
def test_shorter_low_phases_keep_the_bytes_and_shift_times_by_the_removed_time(name: str):
    """No low phase is longer than the usual one, which removes delays of a target or a slow controller."""
    part = played(load(name), *lines(name))
    report = I2cReplay(load_case(CASE), load(name), *lines(name), longest_low=part.low / part.rate).run()
    if name in POLLED:
        assert report.verdict == "pass" and report.refusals != report.captured_refusals
        return
    assert report.first_divergence is None and report.stretch_total_us == 0
    most = max(cut_off(transfer, part.low) for transfer in part.transfers)
    assert report.lag_samples <= float(most) + 0.01


@needs_captures
def test_a_controller_with_short_low_phases_is_stretched_by_the_firmware():
    """The sensor's controller holds SCL low for up to 60 us; with 5 us the firmware answers with the same bytes."""
    scl, sda = lines("i2c_sht21_nohold")
    low = Fraction(5, 10**6)
    report = I2cReplay(load_case(CASE), load("i2c_sht21_nohold"), scl, sda, longest_low=low).run()
    assert report.verdict == "pass" and report.agreed == replayed("i2c_sht21_nohold").agreed
    assert report.lag_worst_us > 100


@needs_captures
@pytest.mark.parametrize(("busy_us", "refused"), [(3500, 64), (1500, 0), (5000, 127)])
def test_the_memory_of_the_first_slave_page_brackets_a_real_busy_time(tmp_path: Path, busy_us: int, refused: int):
    """Its controller waits 2 ms after each write and each NACK, but 20 ms after the last one."""
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
