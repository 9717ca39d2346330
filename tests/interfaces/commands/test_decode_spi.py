"""`periph-sim decode --spi`: a row for each word of each data line, in every format, and compared with sigrok."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

import pytest

from periph_sim.traces import formats
from periph_sim.traces.decode.spi import SpiFormat
from tests.interfaces.commands.conftest import Run
from tests.interfaces.commands.test_decode_exports import needs_sigrok, needs_tshark, tshark, written
from tests.traces.decode.test_spi import capture_of, wave

LINES = "clk=CLK,mosi=MOSI,miso=MISO,cs=CS"
EIGHT = SpiFormat()


def recorded(folder: Path, format_: SpiFormat, *words: tuple[int, int], half: int = 3) -> str:
    """Write a capture of two selections with these words. A position is 1 ns; half a period of SPICLK is `half` ns."""
    path = folder / "spi.vcd"
    formats.write(capture_of(wave(format_, list(words), half) * 2), path)
    return str(path)


@pytest.fixture
def flash(tmp_path: Path) -> str:
    return recorded(tmp_path, EIGHT, (0x9F, 0x00), (0x12, 0x34))


def rows(text: str) -> list[list[str]]:
    return [line.split() for line in text.splitlines()]


def test_each_data_line_has_its_words_and_selections(periph_sim: Run, flash: str):
    out = periph_sim.passes("decode", flash, "--spi", LINES)
    assert [row[1:] for row in rows(out)][:9] == [
        ["bus", "event", "value"],
        ["spi", "MOSI", "select"],
        ["spi", "MISO", "select"],
        ["spi", "MOSI", "word", "0x9F"],
        ["spi", "MISO", "word", "0x00"],
        ["spi", "MOSI", "word", "0x12"],
        ["spi", "MISO", "word", "0x34"],
        ["spi", "MOSI", "deselect"],
        ["spi", "MISO", "deselect"],
    ]
    assert periph_sim("decode", flash, "--spi", "clk=CLK,simo=MOSI,somi=MISO,ste=CS").out == out


def test_a_selection_is_a_transfer(periph_sim: Run, flash: str):
    result = periph_sim("decode", flash, "--spi", LINES, "--transfers")
    assert [row[1:] for row in rows(result.out)][1:3] == [
        ["spi", "MOSI", "select", "9F", "12", "deselect"],
        ["spi", "MISO", "select", "00", "34", "deselect"],
    ]
    assert len(rows(result.out)) == 5
    found = [json.loads(line) for line in periph_sim("decode", flash, "--spi", LINES, "--json").out.splitlines()]
    assert [(one["bus"], [word["value"] for word in one["words"]]) for one in found] == [
        ("spi MOSI", [0x9F, 0x12]), ("spi MISO", [0x00, 0x34]),
    ] * 2  # fmt: skip
    assert found[0]["words"][0].keys() == {"time_s", "position", "value", "bits"}
    assert (found[0]["words"][0]["position"], found[0]["words"][0]["bits"], found[0]["cut"]) == (9, 8, None)


def test_bits_of_a_word_that_ended_early_are_cut(periph_sim: Run, tmp_path: Path):
    path = recorded(tmp_path, SpiFormat(11), (0b101_1100_0101, 0))
    (first, *_) = periph_sim("decode", path, "--spi", LINES, "--json").out.splitlines()
    found = json.loads(first)
    assert ([word["value"] for word in found["words"]], found["cut"]) == ([0b1011_1000], "101")
    assert found["transfer"] == "select B8 [101] deselect"


def test_without_a_chip_select_a_pause_longer_than_a_word_ends_a_burst(periph_sim: Run, tmp_path: Path):
    samples = wave(EIGHT, [(1, 0), (2, 0)], 2)
    path = tmp_path / "spi.vcd"
    idle = bytes([samples[-1]]) * 40
    formats.write(capture_of(samples + idle + samples), path)
    result = periph_sim("decode", str(path), "--spi", "clk=CLK,mosi=MOSI", "--transfers")
    assert [row[1:] for row in rows(result.out)] == [["transfer"], ["01", "02"], ["01", "02"]]


def test_a_capture_may_begin_while_the_line_is_selected(periph_sim: Run, tmp_path: Path):
    samples = wave(EIGHT, [(0xA5, 0)], 2)
    path = tmp_path / "spi.vcd"
    formats.write(capture_of(samples[3:] + samples), path)
    result = periph_sim("decode", str(path), "--spi", "clk=CLK,mosi=MOSI,cs=CS", "--transfers")
    assert [row[1:] for row in rows(result.out)][1:] == [["A5", "deselect"], ["select", "A5", "deselect"]]


def test_glitches_of_the_clock_are_filtered_on_request(periph_sim: Run, tmp_path: Path):
    samples = bytearray(wave(EIGHT, [(0xA5, 0)], 4))
    samples[9] ^= 1  # one sample of CLK
    path = tmp_path / "spi.vcd"
    formats.write(capture_of(bytes(samples)), path)
    command = ("decode", str(path), "--spi", "clk=CLK,mosi=MOSI,cs=CS", "--transfers")
    assert [row[1:] for row in rows(periph_sim(*command).out)][1:] == [["select", "D2", "[1]", "deselect"]]
    assert [row[1:] for row in rows(periph_sim(*command, "--glitch", "2").out)][1:] == [["select", "A5", "deselect"]]


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ("mosi=MOSI", "clk is missing; expected clk=CHANNEL,mosi=CHANNEL,..."),
        ("clk=CLK,cs=CS", "mosi or miso is missing; expected clk=CHANNEL,mosi=CHANNEL,..."),
        ("clk=CLK,mosi=MOSI,simo=MISO", "simo and mosi are one line; give one of them"),
        ("clk=CLK,mosi=0", "two lines are one channel; expected a channel each"),
        ("clk=CLK,mosi=MOSI,cpol=2", "cpol is 2; expected 0 or 1"),
        ("clk=CLK,mosi=MOSI,bitorder=msb", "bitorder is msb; expected msb-first or lsb-first"),
        ("clk=CLK,mosi=MOSI,wordsize=33", "wordsize is 33; expected 1 to 32 bits"),
        ("clk=CLK,mosi=MOSI,wordsize=0", "wordsize is 0; expected 1 to 32 bits"),
        ("clk=CLK,mosi=MOSI,mode=3", "there is no 'mode'; "),
    ],
)
def test_a_wrong_option_is_one_error_message(periph_sim: Run, flash: str, options: str, sentence: str):
    assert periph_sim.refused("decode", flash, "--spi", options).startswith(f"--spi {options}: {sentence}")


def test_a_missing_channel_is_an_error(periph_sim: Run, flash: str):
    assert "there is no channel 'SCK'" in periph_sim.refused("decode", flash, "--spi", "clk=SCK,mosi=MOSI")


def test_a_hex_dump_has_a_packet_per_selection_and_words_in_whole_bytes(periph_sim: Run, tmp_path: Path):
    path = recorded(tmp_path, SpiFormat(12), (0xABC, 0), (0x123, 0))
    result = periph_sim("decode", path, "--spi", "clk=CLK,mosi=MOSI,cs=CS,wordsize=12", "--format", "hexdump")
    first = result.out.split("\n\n")[0].splitlines()
    assert first[0] == "# select ABC 123 deselect" and first[2] == "000000  0a bc 01 23"


@needs_tshark
def test_tshark_reads_the_words_of_a_line_as_packets(flash: str):
    path = written(Path(flash), "pcapng", "--spi", LINES)
    shown = tshark(path, "frame.interface_name", "data.data")
    assert shown == [["spi MOSI", "9f12"], ["spi MISO", "0034"]] * 2


@needs_sigrok
@pytest.mark.parametrize(
    ("format_", "options"),
    [
        (EIGHT, {}),
        (SpiFormat(16, 1, 1), {"cpol": "1", "cpha": "1", "wordsize": "16"}),
        (SpiFormat(5, 0, 1, lsb_first=True), {"cpha": "1", "bitorder": "lsb-first", "wordsize": "5"}),
        (SpiFormat(32, active_high=True), {"cs_polarity": "active-high", "wordsize": "32"}),
    ],
    ids=["mode 0", "mode 3", "mode 1", "32 bits"],
)
def test_words_equal_those_of_sigrok_cli(periph_sim: Run, tmp_path: Path, format_: SpiFormat, options: dict[str, str]):
    mask = (1 << format_.bits) - 1
    path = recorded(tmp_path, format_, (0xC0FF_EE11 & mask, 0x1234_5679 & mask), (1, mask))
    ours = periph_sim(
        "decode", path, "--spi", ",".join([LINES, *(f"{k}={v}" for k, v in options.items())]), "--format", "sigrok"
    ).out
    command = ["sigrok-cli", "-I", "vcd", "-i", path, "--protocol-decoder-samplenum"]
    for line in ("mosi", "miso"):  # one decoder for each line
        words = ["spi", "clk=CLK", "cs=CS", f"{line}={line.upper()}", *(f"{k}={v}" for k, v in options.items())]
        command += ["-P", ":".join(words)]
    theirs = subprocess.run(
        [*command, "-A", "spi=mosi-data:miso-data"], capture_output=True, text=True, check=True
    ).stdout

    def beginnings(text: str) -> list[tuple[str, ...]]:
        return sorted(re.findall(r"^(\d+)-\d+ (spi-\d): (\w+)$", text, re.MULTILINE))

    assert beginnings(ours) == beginnings(theirs) and len(beginnings(ours)) == 8
