"""Every real capture can be read, and is unchanged after it is written and read again in each format."""

from __future__ import annotations

import re
from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from periph_sim.traces import formats
from periph_sim.traces.decode import i2c, uart
from periph_sim.traces.formats import Capture
from tests.captures.where import FOLDER, captures, decoded, needs_captures, remarks
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


MOST_EDGES = 150_000
MOST_SAMPLES = 20_000_000  # of .sr, which contains each sample
BAUD = re.compile(r"baudrate=(\d+)")

Decode = Callable[[Capture], list[object]]


def decoders(path: Path) -> list[Decode]:
    """Return decoders for the lines that the oracle names; the file may have other channel names."""
    found: list[Decode] = []
    name = path.stem.removesuffix("_bin")
    if name in decoded("i2c"):
        scl, sda = re.findall(r"(?:scl|sda)=([^:' ]+)", remarks(name, "i2c"))[:2]
        found.append(lambda capture: list(i2c.events(capture, scl, sda)))
    if name in decoded("uart"):
        said = remarks(name, "uart")
        line = uart.Line(int(BAUD.findall(said)[0]))
        for channel in re.findall(r"[rt]x=([^:']+?)(?=[:' ])", said):
            found.append(lambda capture, channel=channel: list(uart.events(capture, channel, line)))
    return found


@pytest.mark.parametrize("suffix", [".vcd", ".csv", ".psr", ".sr"])
@pytest.mark.parametrize("path", captures(), ids=lambda path: path.name)
def test_a_capture_is_unchanged_after_writing_and_reading(tmp_path: Path, path: Path, suffix: str):
    out = tmp_path / f"x{suffix}"
    given = formats.ready_for(out, formats.read(path))
    if sum(len(channel.edges) for channel in given.channels) > MOST_EDGES:
        pytest.skip("too many edges for a quick test; the benchmark has them")
    if suffix == ".sr" and given.length > MOST_SAMPLES:
        pytest.skip("a .sr of it would hold too many samples for a quick test")
    formats.write(given, out)
    again = formats.read(out, given.rate)
    by_index = again.channels if suffix != ".vcd" else _in_order(given, again)
    assert [(c.initial, c.edges.tolist()) for c in by_index] == [(c.initial, c.edges.tolist()) for c in given.channels]
    assert (again.length, again.rate) == (given.length, given.rate)
    for decode in decoders(path):
        try:
            events = decode(given)
        except LookupError:  # its channels have other names than in the oracle's source file
            continue
        try:
            assert decode(again) == events
        except LookupError:
            assert suffix == ".vcd" and any(" " in channel.name for channel in given.channels)


def _in_order(given: Capture, again: Capture) -> tuple[formats.Channel, ...]:
    """Return the channels of a VCD, which sorts them by scope and has no blanks in names."""
    by_name = {channel.name: channel for channel in again.channels}
    return tuple(by_name[channel.name.replace(" ", "_")] for channel in given.channels)
