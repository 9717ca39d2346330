"""Decoder of SPI: every format, chip selects, cut words, unknown spans, and a comparison with sigrok's decoder."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.traces import formats
from periph_sim.traces.capture.capture import Capture
from periph_sim.traces.decode import spi
from periph_sim.traces.decode.spi import Event, SpiFormat
from tests.traces.decode.drawing import drawn, of_bytes

THREE = SpiFormat(3)

# 1 0 1 on MOSI, 0 1 1 on MISO; each bit is stable at its latching edge, at 6, 10 and 14.
DATA = """MOSI ____----____----______
MISO ________--------______
CS ---________________---"""
CLOCKS = {
    (0, 0): "______--__--__--______",
    (0, 1): "____--__--__--________",
    (1, 0): "------__--__--__------",
    (1, 1): "----__--__--__--------",
}


@pytest.mark.parametrize("mode", CLOCKS)
def test_one_word(mode: tuple[int, int]):
    capture = drawn(f"CLK {CLOCKS[mode]}\n{DATA}")
    assert spi.events(capture, SpiFormat(3, *mode)) == [
        Event("select", 3, 3),
        Event("word", 6, 14, 0b101, 0b011, 3),
        Event("deselect", 19, 19),
    ]


def test_the_least_significant_bit_can_be_first():
    capture = drawn(f"CLK {CLOCKS[0, 0]}\n{DATA}")
    assert spi.events(capture, SpiFormat(3, lsb_first=True))[1] == Event("word", 6, 14, 0b101, 0b110, 3)


def test_the_chip_select_can_be_active_high():
    capture = drawn(f"CLK {CLOCKS[0, 0]}\n{DATA}\nSS ___----------------___")
    wanted = [Event("select", 3, 3), Event("word", 6, 14, 0b101, 0b011, 3), Event("deselect", 19, 19)]
    assert spi.events(capture, SpiFormat(3, active_high=True), cs="SS") == wanted
    assert spi.events(capture, SpiFormat(3, active_high=True)) == [Event("deselect", 3, 3), Event("select", 19, 19)]


@pytest.mark.parametrize(("mosi", "miso", "word"), [("MOSI", None, (0b101, None)), (None, "MISO", (None, 0b011))])
def test_one_data_line_is_enough(mosi: str | None, miso: str | None, word: tuple[int | None, int | None]):
    capture = drawn(f"CLK {CLOCKS[0, 0]}\n{DATA}")
    assert spi.events(capture, THREE, mosi=mosi, miso=miso, cs=None) == [Event("word", 6, 14, *word, 3)]
    assert spi.events(capture, SpiFormat(4), mosi=mosi, miso=miso, cs=None) == [Event("cut", 6, 14, *word, 3)]


@pytest.mark.parametrize(
    ("drawing", "cs", "events"),
    [
        pytest.param(
            """
            CLK  _-_-_-_-_-_-__
            MOSI ---____----___
            MISO ______________
            CS   ___________---
            """,
            "CS",
            [
                Event("word", 1, 3, 0b10, 0, 2),
                Event("word", 5, 7, 0b01, 0, 2),
                Event("cut", 9, 9, 1, 0, 1),
                Event("deselect", 11, 11),
            ],
            id="words follow each other, and the chip select cuts the last",
        ),
        pytest.param(
            """
            CLK  _-_-_-_-_-_-_
            MOSI -------------
            MISO _____________
            CS   ------____---
            """,
            "CS",
            [Event("select", 6, 6), Event("word", 7, 9, 0b11, 0, 2), Event("deselect", 10, 10)],
            id="edges while the chip select is inactive are ignored",
        ),
        pytest.param(
            """
            CLK  __-__-__-__
            MOSI __------___
            MISO --___------
            CS   --______---
            """,
            "CS",
            [Event("select", 2, 2), Event("word", 2, 5, 0b11, 0b01, 2), Event("deselect", 8, 8)],
            id="data that change at the latching edge have the new levels",
        ),
        pytest.param(
            """
            CLK  _-_-_-????_-_-_-
            MOSI ----------------
            MISO ________________
            """,
            None,
            [
                Event("word", 1, 3, 3, 0, 2),
                Event("cut", 5, 5, 1, 0, 1),
                Event("word", 11, 13, 3, 0, 2),
                Event("cut", 15, 15, 1, 0, 1),
            ],
            id="no word is decoded in an unknown span",
        ),
    ],
)
def test_words_of_two_bits(drawing: str, cs: str | None, events: list[Event]):
    assert spi.events(drawn(drawing), SpiFormat(2), cs=cs) == events


@pytest.mark.parametrize(
    ("kind", "text"),
    [
        ({"bits": 0}, "0 bits of a word; expected 1 to 64"),
        ({"bits": 65}, "65 bits of a word; expected 1 to 64"),
        ({"polarity": 2}, "polarity is 2; expected 0 or 1"),
        ({"phase": -1}, "phase is -1; expected 0 or 1"),
    ],
)
def test_invalid_formats_are_rejected(kind: dict[str, int], text: str):
    with pytest.raises(ValueError, match=text):
        SpiFormat(**kind)


def test_missing_lines_are_rejected():
    capture = drawn(f"CLK {CLOCKS[0, 0]}\n{DATA}")
    with pytest.raises(ValueError, match="no data line; expected mosi, miso or both"):
        spi.events(capture, THREE, mosi=None, miso=None)
    with pytest.raises(LookupError, match="SCK"):
        spi.events(capture, THREE, clk="SCK")


def wave(format_: SpiFormat, words: list[tuple[int, int]], half: int, active: bool = True) -> bytes:
    """Samples of words within one chip select. Bits from 0: CLK, MOSI, MISO, CS."""
    idle = format_.polarity
    selected = int(format_.active_high)
    out = [(idle, 0, 0, 1 - selected)] * half
    out += [(idle, 0, 0, selected)] * (half if active else 0)
    order = range(format_.bits) if format_.lsb_first else range(format_.bits - 1, -1, -1)
    for mosi, miso in words:
        for n in order:
            bits = (mosi >> n & 1, miso >> n & 1, selected)
            first = idle if format_.phase == 0 else 1 - idle
            out += [(first, *bits)] * half + [(1 - first, *bits)] * half
    out += [(idle, 0, 0, selected)] * half + [(idle, 0, 0, 1 - selected)] * half
    return bytes(clk | mosi << 1 | miso << 2 | cs << 3 for clk, mosi, miso, cs in out)


def capture_of(samples: bytes) -> Capture:
    return of_bytes(samples, ("CLK", "MOSI", "MISO", "CS"))


formats_ = st.builds(SpiFormat, st.integers(1, 64), st.integers(0, 1), st.integers(0, 1), st.booleans(), st.booleans())


@given(format_=formats_, half=st.integers(1, 5), data=st.data())
def test_generated_words_are_decoded(format_: SpiFormat, half: int, data: st.DataObject):
    number = st.integers(0, (1 << format_.bits) - 1)
    words = data.draw(st.lists(st.tuples(number, number), max_size=4))
    found = spi.events(capture_of(wave(format_, words, half)), format_)
    assert [(e.mosi, e.miso) for e in found if e.kind == "word"] == words
    assert [e.kind for e in found] == ["select", *["word"] * len(words), "deselect"]
    ends = [e.end - e.at for e in found if e.kind == "word"]
    assert ends == [2 * half * (format_.bits - 1)] * len(words)


# Comparison with sigrok.

SIGROK = shutil.which("sigrok-cli")


def sigrok_words(path: Path, format_: SpiFormat) -> list[tuple[int, int, int]]:
    """(sample of the first latching edge, MOSI, MISO) of each word."""
    options = {
        "clk": "CLK", "cs": "CS", "cpol": format_.polarity, "cpha": format_.phase, "wordsize": format_.bits,
        "bitorder": "lsb-first" if format_.lsb_first else "msb-first",
        "cs_polarity": "active-high" if format_.active_high else "active-low",
    }  # fmt: skip
    command = [str(SIGROK), "-I", "vcd", "-i", str(path), "--protocol-decoder-samplenum"]
    for line in ("mosi", "miso"):  # one decoder each, spi-1 and spi-2
        command += ["-P", ":".join(["spi", f"{line}={line.upper()}", *(f"{k}={v}" for k, v in options.items())])]
    command += ["-A", "spi=mosi-data:miso-data"]
    said = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    rows: dict[str, list[tuple[int, int]]] = {"1": [], "2": []}
    for begin, decoder, value in re.findall(r"^(\d+)-\d+ spi-([12]): ([0-9A-F]+)$", said, re.MULTILINE):
        rows[decoder].append((int(begin), int(value, 16)))
    assert [at for at, _ in rows["1"]] == [at for at, _ in rows["2"]]
    return [(at, mosi, miso) for (at, mosi), (_, miso) in zip(rows["1"], rows["2"], strict=True)]


@pytest.mark.skipif(SIGROK is None, reason="sigrok-cli is not installed")
@pytest.mark.parametrize(
    "format_",
    [
        SpiFormat(8, 0, 0),
        SpiFormat(5, 0, 1, lsb_first=True),
        SpiFormat(16, 1, 0, active_high=True),
        SpiFormat(1, 1, 1),
    ],
)
def test_sigrok_reads_the_same_words(tmp_path: Path, format_: SpiFormat):
    """After three regular bursts, the samples are random, with simultaneous edges and cut words."""
    random = Random(31)
    burst = [(random.getrandbits(format_.bits), random.getrandbits(format_.bits)) for _ in range(3)]
    samples = wave(format_, burst, 2) * 3 + bytes(random.choices(range(16), [4] * 8 + [1] * 8, k=400))
    capture = capture_of(samples)
    formats.write(capture, tmp_path / "x.vcd")
    words = [(e.at, e.mosi, e.miso) for e in spi.events(capture, format_) if e.kind == "word"]
    assert len(words) >= 9 and sigrok_words(tmp_path / "x.vcd", format_) == words
