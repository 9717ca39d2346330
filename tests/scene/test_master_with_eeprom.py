"""A unit that is the master of an EEPROM: rounds with polling, pages, a stuck line, and sigrok's decoder."""

from __future__ import annotations

import re
import shutil
import subprocess
from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim import Dsp, Scene, load
from periph_sim.core.records import Kind, Record
from periph_sim.records.recording import recording
from tests.scene.runs import TIMING, run_case, run_file
from tests.scene.small import command, scene_with, started_i2c

LOG = "eeprom_log"
QUICK = ("unit.dsp.settings.period=8 ms", "rounds.period=8 ms", "device.eeprom.write_time=300 us")
OFF = 'device.eeprom.fault=[{kind="off", after="1 ms"}]'
HELD = 'device.eeprom.fault=[{kind="hold", access="read", bytes=[3], length="5 ms"}]'


def test_a_record_across_the_end_of_a_page_is_stored_in_two_writes():
    ran = run_file(LOG, "0.016", *QUICK)
    assert ran.broken() == [] and ran.result.verdict == "pass"
    memory = ran.scene.devices["eeprom"].target.memory  # type: ignore[attr-defined]
    assert memory[0x38:0x48] == bytes(range(0xA0, 0xB0)) and memory[0x20:0x38] == b"\xff" * 0x18


def test_a_record_in_one_write_overruns_the_page():
    ran = run_file("eeprom_overrun", "0.016", *QUICK)
    assert ran.broken() == ["record read back"]
    assert ran.result.first_wrong.startswith("read back read a0 a1 a2 a3 a4 a5 a6 a7 ff ff ff ff ff ff ff ff where")
    assert [note for note in ran.result.notes if "went beyond its page's end, 0x003f, on to 0x0020" in note]


def test_acknowledge_polls_count_as_requests_if_the_case_says_so():
    refused = "budget.both pages written.measure=nacked rounds"
    assert "both pages written" not in run_file(LOG, "0.016", *QUICK, refused).broken()
    assert "both pages written" in run_file(LOG, "0.016", *QUICK, refused, "rounds.ack_polling=false").broken()


def test_a_device_without_power_and_a_held_line_break_their_budgets():
    assert "stored" in run_file(LOG, "0.017", *QUICK, OFF).broken()
    ran = run_file(LOG, "0.017", *QUICK, HELD, "rounds.stuck_after=2 ms")
    assert "bus stuck" in ran.broken()
    assert ran.result.stuck[0].startswith("SDA is held low by eeprom at ")


def test_the_busy_time_equals_that_of_the_acknowledges_of_a_recorded_run():
    """It is the time from the STOP of each write to the next acknowledged address: the stored time and up to a poll."""
    case = load(TIMING / f"{LOG}.toml", [*QUICK, "budget.stored.measure=busy time of 0x50", "budget.stored.max=450 us"])
    seen: list[Record] = []
    ran = run_case(case, "0.024", lambda recorder, timebase: recorder.subscribe([Kind.BUS], seen.append))
    times: list[int] = []
    writes, stored_at = "", 0
    for record in seen:
        if record.what == "address" and not record.value & 1:
            times += [record.tick - stored_at] if stored_at else []
            writes, stored_at = "" if record.value & 2 else "address", 0
        elif record.what == "byte" and writes:
            writes = "data"
        elif record.what == "STOP":
            stored_at, writes = record.tick if writes == "data" else stored_at, ""
    busy = ran.result.budgets[2]
    assert (busy.word, busy.count) == ("seen", len(times)) and len(times) >= 4
    assert busy.worst == pytest.approx(max(times) / ran.scene.timebase.per_second * 1e6, abs=0.001)
    assert 300 < busy.worst < 300 + 150


def test_a_busy_time_over_its_limit_or_without_an_end_breaks_its_budget():
    budget = ("budget.stored.measure=busy time of 0x50", "budget.stored.max=450 us")
    for slow in ("device.eeprom.write_time=600 us", "device.eeprom.write_time=1 s"):
        busy = run_file(LOG, "0.016", *QUICK, *budget, slow).result.budgets[2]
        assert busy.broken and busy.found == "0x50 was not acknowledged again before the run ended" * ("1 s" in slow)
    other = run_file(LOG, "0.016", *QUICK, "budget.stored.measure=busy time of 0x51").result.budgets[2]
    assert other.verdict == "not judged"
    assert other.found == "no write to 0x51 was over before its address was acknowledged again"


def test_refused_acknowledge_polls_are_not_counted_for_stretch():
    """Most polls are refused. Every acknowledged phase is measured."""
    stretch = run_file(LOG, "0.016", *QUICK, "budget.stored.measure=stretch").result.budgets[2]
    assert (stretch.word, stretch.measured) == ("seen", stretch.occasions)
    counted = (*QUICK, "rounds.ack_polling=false")
    stretch = run_file(LOG, "0.016", *counted, "budget.stored.measure=stretch").result.budgets[2]
    nacked = ("budget.stored.measure=nacked", "budget.stored.max=0")
    refused = run_file(LOG, "0.016", *counted, *nacked).result.budgets[2].count
    assert refused and stretch.occasions >= stretch.measured + refused


SIGROK = shutil.which("sigrok-cli")


@pytest.mark.skipif(SIGROK is None, reason="sigrok-cli is not installed")
def test_the_eeprom_decoder_of_sigrok_reads_the_same(tmp_path: Path):
    """eeprom24xx of libsigrokdecode is independent of this project and knows the pages of the 24LC64."""
    case = load(TIMING / f"{LOG}.toml", list(QUICK))
    file = tmp_path / "run.sr"
    with recording(file, case.recorded_modules) as (subscribe, ended_at):
        scene = Scene(case, subscribe)
        scene.run(Fraction(8, 1000))
        ended_at(scene.kernel.now, {})
    decoder = "i2c:scl=SCL:sda=SDA,eeprom24xx:chip=microchip_24lc64"
    output = subprocess.run(
        [SIGROK, "-i", str(file), "-P", decoder, "-A", "eeprom24xx=ops"], capture_output=True, text=True, check=True
    ).stdout
    operations = re.findall(r"(Page write|Sequential random read)[^\n]*", output)
    assert operations == ["Page write", "Page write", "Sequential random read"], output
    assert re.search(r"Page write \(addr=0038, 8 bytes\): A0 A1 A2 A3 A4 A5 A6 A7", output), output
    assert re.search(r"read \(addr=0038, 16 bytes\): A0 A1 .* AF", output), output


@pytest.mark.parametrize("disable", ["bits", ()])
def test_a_refused_address_counts_although_the_master_hangs_without_a_stop(disable: object):
    def reads_from_a_missing_device(dsp: Dsp) -> None:
        i2c = started_i2c(dsp)
        command(i2c, 0x50, 2, 0x6420)  # FREE, STT, MST, IRS: no STOP by itself
        dsp.spin(lambda: i2c.I2CSTR.RRDY == 1)

    budget = [{"name": "there", "measure": "nacked", "max": 0}]
    scene = scene_with(reads_from_a_missing_device, ["I2C-A"], duration="1 ms", budget=budget, disable=disable)
    (there,) = scene.run().budgets
    assert (there.word, there.worst, there.count) == ("broken", 1, 1)
