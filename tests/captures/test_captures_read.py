"""Every real capture reads, and the same levels in several formats are the same edges."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from periph_sim.traces import formats
from periph_sim.traces.formats import Capture
from tests.captures.where import FOLDER, captures, needs_captures
from tests.traces.formats.looks import facts


def levels(capture: Capture) -> list[tuple[int, list[int]]]:
    return [(channel.initial, channel.edges.tolist()) for channel in capture.channels]


@pytest.mark.parametrize("path", captures(), ids=lambda path: path.name)
def test_every_file_reads(path: Path):
    capture = formats.read(path)
    assert capture.rate is not None and capture.length > 0 and capture.channels
    assert any(len(channel.edges) for channel in capture.channels)
    for channel in capture.channels:
        states = [channel.initial, *channel.levels.tolist()]
        assert channel.edges.dtype == np.int64 and channel.levels.dtype == np.uint8
        assert all(a != b for a, b in pairwise(states))
        assert (np.diff(channel.edges, prepend=0) > 0).all()
        assert not len(channel.edges) or channel.edges[-1] < capture.length
        assert not channel.unknown


@needs_captures
def test_the_three_saleae_exports_of_one_capture_have_the_same_edges():
    for rate in (None, Fraction(50 * 10**6)):
        exports = [
            formats.read(FOLDER / "saleae_cap1" / name, rate) for name in ("digital.csv", "digital_iso.csv", ".")
        ]
        assert [len(channel.edges) for channel in exports[0].channels] == [925, 926]
        assert levels(exports[0]) == levels(exports[1]) == levels(exports[2])


@needs_captures
def test_a_single_binary_file_is_one_channel_of_its_folder():
    folder = formats.read(FOLDER / "saleae_cap1")
    alone = formats.read(FOLDER / "saleae_cap1" / "digital_1.bin")
    assert levels(alone) == levels(folder)[1:]
    assert alone.channel("digital_1").index == 1


@needs_captures
@pytest.mark.parametrize(
    ("name", "source", "rate"),
    [
        ("i2c_ad5258_busy_pvcsv.csv", "i2c_ad5258_eeprom_busy_nack.sr", None),
        ("i2c_ds3231_ex2_vcd.vcd", "i2c_ds3231_ex2.sr", 4_000_000),
        ("i2c_nunchuk_init_simvcd.vcd", "i2c_nunchuk_init.sr", 1_000_000),
        ("uart_hello_8n1_115200_vcd.vcd", "uart_hello_8n1_115200.sr", 1_000_000),
        ("uart_count_5n1_pvcsv_time.csv", "uart_count_5n1.sr", None),
    ],
)
def test_a_converted_file_has_the_edges_and_the_length_of_its_source(name: str, source: str, rate: int | None):
    converted = formats.read(FOLDER / name, None if rate is None else Fraction(rate))
    original = formats.read(FOLDER / source)
    columns = len(converted.channels)
    assert levels(converted) == levels(original)[:columns]
    assert facts(converted) == facts(original)


@needs_captures
def test_a_table_of_decoded_bytes_is_refused():
    with pytest.raises(formats.BadCapture, match=r"found b'name,type,start_time,dur', expected .*, Saleae CSV, "):
        formats.read(FOLDER / "uart_async115200_csv.saleae.csv")
