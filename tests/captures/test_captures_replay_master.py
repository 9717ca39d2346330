"""Real I2C captures are replayed to a controller of firmware: the captured targets answer, and events must be equal.

every capture except NONE        the same addresses, bytes and ACKs in the same order
LEFT_OUT                         without some of the transfers
LAST_BYTE                        only with another setting of an open question
"""

from __future__ import annotations

import pytest

from periph_sim.replay import BadReplay
from periph_sim.replay.i2c_master import I2cMasterReplay
from periph_sim.replay.i2c_script import AGAINST, CUT
from periph_sim.replay.report import Report, headline
from periph_sim.scene.case.load import load as load_case
from tests.captures.test_captures_decode import load
from tests.captures.test_captures_replay_i2c import CASE, FIRST, NAMES, lines
from tests.captures.where import needs_captures
from tests.refusals import refusal

MASTER = CASE.with_name("captured_master.toml")
FEW = 20  # transfers of the million edges

# Its controller sends all bytes after a NACK of the address; this module ends a transfer with the first NACK.
NONE = {"i2c_mlx90614_5s": f"25 ({AGAINST})"}

# Transfers without a STOP or with an incomplete byte, in captures whose other transfers can be replayed.
LEFT_OUT = {
    "i2c_24aa025uid_busy_2ms": f"64 ({AGAINST})",  # it makes one clock with SDA low, then a repeated START
    "i2c_mcp23017_counter_a": f"1 ({CUT})",  # the capture ends within it
    "i2c_eeprom_busy": f"1 ({CUT})",
}

# Their controllers acknowledge the last byte of a read. TI does not document whether this module does if STP = 0.
LAST_BYTE = {"i2c_rding_temper_snippet": (6, 256), "i2c_sla24c02_powerup": (103, 129)}
ACKNOWLEDGED = "unit.dsp.options.i2c.mr_nack_at_count0=only_with_stp"


def replayed(name: str, *changes: str) -> Report:
    first = FEW if name in FIRST else None
    return I2cMasterReplay(load_case(MASTER, list(changes)), load(name), *lines(name), first=first).run()


@pytest.mark.parametrize("name", [name for name in NAMES if name not in NONE])
def test_the_master_of_firmware_acts_as_the_captured_controller(name: str):
    report = replayed(name, *([ACKNOWLEDGED] if name in LAST_BYTE else []))
    assert report.divergences == [] and report.verdict == "pass"
    assert report.agreed == report.events > 0
    left_out = [note.partition("as master: ")[2] for note in report.notes if "omitted transfers" in note]
    assert left_out == ([LEFT_OUT[name]] if name in LEFT_OUT else [])


@needs_captures
def test_the_headline_states_that_2_of_66_transfers_were_replayed():
    report = replayed("i2c_24aa025uid_busy_2ms")
    assert headline(report) == (
        "PASS for 273 of 1298 events, 2 of 66 transfers: timing and protocol only; the requests came from the capture"
    )


@needs_captures
@pytest.mark.parametrize("name", LAST_BYTE)
def test_by_default_the_last_byte_of_a_read_is_not_acknowledged(name: str):
    report = replayed(name)
    first = report.first_divergence
    assert report.verdict == "fail" and first is not None
    assert (first.expected, first.found) == ("ACK", "NACK")
    assert (first.index, report.events) == LAST_BYTE[name]


@needs_captures
@pytest.mark.parametrize("name", NONE)
def test_a_capture_that_this_module_cannot_replay_is_refused_with_the_reason(name: str):
    assert refusal(BadReplay, replayed, name).endswith(NONE[name])
