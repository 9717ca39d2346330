"""The real I2C captures against the firmware's slave: the same STARTs, bytes, ACKs and STOPs on the wires again.

    both halves, no chip:  every capture comes out as it was, to the tick
    the F28335's slave:    every capture but those named in CANNOT

SCL's low phases are the capture's, so whatever the captured target needed the firmware is given too.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest

from periph_sim.case.load import load as load_case
from periph_sim.decode import i2c
from periph_sim.replay.i2c import I2cReplay
from periph_sim.replay.report import Report
from tests.captures.test_captures_decode import TOO_LARGE, channel, load, options
from tests.captures.where import decoded, needs_captures, oracle
from tests.replay.bus import both_halves

pytestmark = needs_captures

CASE = Path(__file__).resolve().parents[2] / "timing" / "responder.toml"
NAMES = decoded("i2c")
FIRST = {TOO_LARGE: 60}  # transfers played of it, with more than 1400 refused polls among them

# What no slave of this module can do.
CANNOT = {
    "i2c_mlx90614_5s": (
        "address 00 with the write bit is answered with data: the F28335 knows 00 as general call alone, to be written to"
    ),
}

# Captures in which the firmware answers nothing, and why.
NOBODY = {
    "i2c_mdfu_stretch_csv": "the client refuses each time; its stretch in the ACK slot is played by the controller",
}


def lines(name: str) -> tuple[str, str]:
    given = options(name, "i2c")
    return channel(name, given["scl"]), channel(name, given["sda"])


@cache
def replayed(name: str) -> Report:
    scl, sda = lines(name)
    return I2cReplay(load_case(CASE), load(name), scl, sda, first=FIRST.get(name)).run()


@pytest.mark.parametrize("name", NAMES)
def test_both_halves_of_the_capture_put_together_are_the_capture(name: str):
    capture = load(name)
    transfers = [transfer for transfer in i2c.transfers(capture, *lines(name)) if transfer.phases][: FIRST.get(name)]
    outcome = both_halves(capture, transfers)
    assert outcome.divergence is None
    assert outcome.agreed == sum(len(list(i2c.events_of(transfer))) for transfer in transfers)
    assert outcome.lag < 1e-9, "less than a tick of the wires"


@pytest.mark.parametrize("name", [name for name in NAMES if name not in CANNOT])
def test_the_firmwares_slave_answers_as_the_captured_target_did(name: str):
    report = replayed(name)
    assert report.first_divergence is None, report
    assert report.verdict == "pass" and report.events == report.agreed > 0


@pytest.mark.parametrize("name", [name for name in NAMES if name not in CANNOT and name not in FIRST])
def test_bytes_and_nacks_are_as_many_as_the_oracle_lists(name: str):
    texts = [said.text for said in oracle(name, "i2c")]
    report = replayed(name)
    assert report.bytes == sum(text.startswith(("Address", "Data")) for text in texts)
    assert report.nacks == texts.count("NACK")
