"""Assignment of channels to lines: mappings, names, and messages if they are wrong."""

from __future__ import annotations

import re

import pytest

from periph_sim.core.input_error import InputError
from periph_sim.replay import BadReplay
from periph_sim.replay.channels import channel_map, serial_channel
from periph_sim.traces import formats
from tests.traces.decode.drawing import of_bytes
from tests.traces.formats.make_traces import FOLDER
from tests.traces.formats.writers import I2cWave

I2C = of_bytes(b"\x03", ("SCL", "SDA", "D2"))
PLAIN = of_bytes(b"\x03", ("D0", "D1"))


def test_channels_named_as_the_lines_need_no_map():
    assert channel_map(I2C, None) == {"scl": "SCL", "sda": "SDA"}
    assert channel_map(of_bytes(b"\x01", ("Rx",)), None) == {"rx": "Rx"}
    scoped = of_bytes(b"\x03", ("tb.bus.scl", "tb.bus.sda"))
    assert channel_map(scoped, None) == {"scl": "tb.bus.scl", "sda": "tb.bus.sda"}


def test_a_channel_is_given_by_name_or_index():
    assert channel_map(I2C, "scl=0, SDA=D2") == {"scl": "0", "sda": "D2"}
    assert channel_map(PLAIN, "rx=D1") == {"rx": "D1"}


@pytest.mark.parametrize(
    ("capture", "text", "message"),
    [
        (PLAIN, None, "samples: no channels named scl and sda, or rx; name them with --map"),
        (PLAIN, None, "it has D0 (index 0), D1 (index 1)"),
        (of_bytes(b"\x07", ("a.scl", "b.scl", "sda")), None, "no channels named scl and sda, or rx"),
        (PLAIN, "scl=7,sda=1", "--map scl=7,sda=1: samples: there is no channel '7'; it has D0, D1"),
        (PLAIN, "scl", "--map scl: scl has no value; expected scl=..."),
        (PLAIN, "sck=0,sda=1", "there is no 'sck'; did you mean scl?"),
        (PLAIN, "scl=0", "expected scl and sda, or rx, or all three; found scl"),
        (PLAIN, "scl=0,sda=1,rx=1", "two lines are one channel"),
        (PLAIN, "scl=0,sda=D0", "two lines are one channel"),
    ],
)
def test_a_wrong_map_is_refused_in_one_sentence(capture, text, message):
    with pytest.raises(InputError, match=re.escape(message)):
        channel_map(capture, text)


ALL = of_bytes(b"\x07", ("SCL", "SDA", "RX"))


def test_all_three_lines_are_a_session_only_if_one_is_requested():
    assert channel_map(ALL, None) == {"scl": "SCL", "sda": "SDA"}
    assert channel_map(ALL, None, session=True) == {"scl": "SCL", "sda": "SDA", "rx": "RX"}
    assert channel_map(I2C, None, session=True) == {"scl": "SCL", "sda": "SDA"}
    assert channel_map(ALL, "rx=2,scl=0,sda=1") == {"scl": "0", "sda": "1", "rx": "2"}


def test_the_serial_line_is_the_given_channel_or_one_named_rx_or_the_only_one():
    assert serial_channel(of_bytes(b"\x01", ("D7",)), None) == "D7"
    assert serial_channel(ALL, None) == "RX"
    assert serial_channel(PLAIN, "D1") == "D1"


@pytest.mark.parametrize(
    ("capture", "text", "message"),
    [
        (
            PLAIN,
            None,
            "which channel is RX? give --uart-file FILE,rx=CHANNEL; it has D0 (index 0), D1 (index 1)",
        ),
        (of_bytes(b"\x03", ("a.rx", "b.rx")), None, "which channel is RX?"),
        (PLAIN, "9", "--uart-file rx=9: samples: there is no channel '9'; it has D0, D1"),
    ],
)
def test_an_ambiguous_serial_line_is_refused(capture, text, message):
    with pytest.raises(InputError, match=re.escape(message)):
        serial_channel(capture, text)


@pytest.mark.parametrize("name", ["imu_round", "imu_session", "nack", "i2c_eeprom_busy"])
def test_swapped_lines_are_recognized_and_lines_in_order_are_not(name: str):
    capture = formats.read(FOLDER / f"{name}.sr")
    assert channel_map(capture, None) == {"scl": "SCL", "sda": "SDA"}
    with pytest.raises(BadReplay, match=r"SCL and SDA are swapped: 0 of \d+ STARTs .*; give --map scl=SCL,sda=SDA$"):
        channel_map(capture, "scl=SDA,sda=SCL")


def test_the_suggested_map_has_the_serial_line_too():
    with pytest.raises(BadReplay, match=r"--map scl=SCL,sda=SDA,rx=RX$"):
        channel_map(formats.read(FOLDER / "imu_session.sr"), "scl=SDA,sda=SCL,rx=RX")


def test_a_cut_transfer_and_silent_lines_are_not_taken_for_swapped_ones():
    wave = I2cWave(20, 4, idle=20).play("S 1:")
    for samples in (bytes(wave.samples), b"\x03", b"\x02\x03"):
        assert channel_map(of_bytes(samples, ("SCL", "SDA")), "scl=SDA,sda=SCL") == {"scl": "SDA", "sda": "SCL"}
