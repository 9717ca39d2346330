"""The picture of a divergence holds both sides, aligned where they last agreed, and what the chip did."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.replay.i2c_closed_loop import I2cReplay
from periph_sim.replay.i2c_master import I2cMasterReplay
from periph_sim.replay.i2c_open_loop import I2cOpenReplay
from periph_sim.replay.uart import LineFormat, UartReplay
from periph_sim.scene.case.load import load
from periph_sim.traces import formats
from tests.replay.slow import one_read, slow_case
from tests.traces.formats.make_traces import FOLDER

CASES = Path(__file__).resolve().parents[2] / "timing"


def texts(svg: str | None) -> list[str]:
    assert svg is not None
    root = ElementTree.fromstring(svg)
    return ["".join(element.itertext()) for element in root.iter() if element.tag.endswith("text")]


@pytest.mark.parametrize(("replay", "side"), [(I2cReplay, "replay"), (I2cOpenReplay, "chip would drive")])
def test_a_wrong_byte_is_drawn_with_both_values_and_the_write_that_made_it(replay, side):
    player = replay(
        load(CASES / "responder.toml", ["unit.dsp.settings.replies=['e4']"]),
        formats.read(FOLDER / "nack.sr"),
        "SCL",
        "SDA",
    )
    shown = texts(player.picture(player.run()))
    for text in ("capture", side, "SCL", "SDA", "E5", "E4", "53 read", "A", "N", "AAS", "SDIR", "XRDY", "W I2CDXR"):
        assert text in shown, text
    assert "expected data read E5, found data read E4" in shown and "last agreed" in shown
    assert "1" not in shown, "flags of one bit are lines, and not boxes with their values"


def test_a_stretch_is_drawn_with_the_event_at_both_its_times(tmp_path):
    case = load(slow_case(tmp_path), ["unit.dsp.settings.wait=100"])
    player = I2cReplay(case, one_read(), "SCL", "SDA", tolerance=Fraction(1, 10**6))
    shown = texts(player.picture(player.run()))
    assert "capture: data read A7" in shown and "replay: data read A7 85.353 us later" in shown
    assert shown.count("A7") >= 2


def test_a_master_and_a_uart_are_drawn_too():
    case = load(CASES / "captured_master.toml", ["unit.dsp.settings.script=['53 R 1']"])
    player = I2cMasterReplay(case, formats.read(FOLDER / "nack.sr"), "SCL", "SDA")
    shown = texts(player.picture(player.run()))
    assert "expected address 53 write, found address 53 read" in shown and "53 write" in shown
    assert "last agreed" in shown
    frames = formats.read(FOLDER / "host_frames.sr")
    uart = UartReplay(load(CASES / "imu_hil_published.toml"), frames, "RX", LineFormat(115200, 7))
    shown = texts(uart.picture(uart.run()))
    assert "last agreed" not in shown and "us, 0 is 0.000300 s of the capture" in shown
    assert "RX" in shown and any(text.startswith("capture: ") for text in shown)


def test_without_a_divergence_there_is_no_picture():
    player = I2cReplay(load(CASES / "responder.toml"), formats.read(FOLDER / "nack.sr"), "SCL", "SDA")
    assert player.picture(player.run()) is None
