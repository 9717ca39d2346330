"""Every real capture but the largest, written in every format and read again: the same edges, the same events."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from periph_sim.traces import formats
from periph_sim.traces.decode import i2c, uart
from periph_sim.traces.formats import Capture
from tests.captures.where import captures, decoded, remarks

MOST_EDGES = 150_000
MOST_SAMPLES = 20_000_000  # of .sr, which holds each sample
BAUD = re.compile(r"baudrate=(\d+)")

Decode = Callable[[Capture], list[object]]


def decoders(path: Path) -> list[Decode]:
    """How the capture is decoded: by the oracle's channels, where they are called so in this file."""
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
def test_written_and_read_again_it_is_the_same(tmp_path: Path, path: Path, suffix: str):
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
        except LookupError:  # its channels have other names than in the oracle's source
            continue
        try:
            assert decode(again) == events
        except LookupError:
            assert suffix == ".vcd" and any(" " in channel.name for channel in given.channels)


def _in_order(given: Capture, again: Capture) -> tuple[formats.Channel, ...]:
    """The channels of a VCD, which orders them by scope and has no blanks in names."""
    by_name = {channel.name: channel for channel in again.channels}
    return tuple(by_name[channel.name.replace(" ", "_")] for channel in given.channels)
