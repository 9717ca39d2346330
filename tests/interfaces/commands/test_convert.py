"""`periph-sim convert`: the files that it writes, its output, and the inputs that it rejects."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.traces import formats
from periph_sim.traces.decode import i2c, uart
from periph_sim.traces.formats import saleae_csv
from tests.interfaces.commands.conftest import Run
from tests.traces.formats.looks import edges, facts

TRACES = Path(__file__).resolve().parents[3] / "traces"
NACK = str(TRACES / "nack.sr")


def test_one_line_says_what_was_written(periph_sim: Run, desk: Path):
    assert periph_sim("convert", NACK, "nack.vcd") == (
        0,
        "nack.vcd: 2 channels, 158 edges, 0.001165 s in samples of 4 MHz\n",
        "",
    )


NAMES = ("imu_round.sr", "nack.sr", "host_frames.sr")


@pytest.mark.parametrize(
    ("name", "suffix"),
    [*((name, suffix) for name in NAMES for suffix in (".vcd", ".psr", ".csv")), ("imu_round.sr", ".fst")],
)
def test_a_capture_is_unchanged_after_conversion_there_and_back(periph_sim: Run, desk: Path, name: str, suffix: str):
    given = formats.read(TRACES / name)
    for source, out in ((str(TRACES / name), f"a{suffix}"), (f"a{suffix}", "b.psr"), ("b.psr", f"c{suffix}")):
        assert "note:" not in periph_sim.passes("convert", source, out, "--rate", f"{given.rate}")
        again = formats.read(out, given.rate)
        assert edges(again) == edges(given) and facts(again) == facts(given)
        assert events(again) == events(given)


def events(capture: formats.Capture) -> list[object]:
    if "RX" in edges(capture):
        return list(uart.events(capture, "RX", uart.Line(115200)))
    return list(i2c.events(capture))


def test_selected_channels_are_written_in_the_given_order(periph_sim: Run, desk: Path):
    periph_sim("convert", NACK, "x.psr", "--channels", "SDA, 0")
    assert [channel.name for channel in formats.read("x.psr").channels] == ["SDA", "SCL"]


@pytest.mark.parametrize("window", ["250 us..400 us", "1000..1600", "0.25ms..400us"])
def test_a_window_begins_at_position_0(periph_sim: Run, desk: Path, window: str):
    assert "0.00015 s in samples of 4 MHz" in periph_sim.passes("convert", NACK, "x.csv", "--window", window)
    cut, given = formats.read("x.csv", Fraction(4 * 10**6)), formats.read(NACK)
    assert cut.length == 600
    for part, full in zip(cut.channels, given.channels, strict=True):
        inside = full.edges[(full.edges > 1000) & (full.edges < 1600)] - 1000
        assert part.edges.tolist() == inside.tolist()


def test_a_window_is_written_as_a_wavedrom_diagram(periph_sim: Run, desk: Path):
    periph_sim.passes("convert", NACK, "x.wavedrom.json", "--window", "90 us..200 us")
    shown = json.loads(Path("x.wavedrom.json").read_text())
    assert [lane["name"] for lane in shown["signal"]] == ["SCL", "SDA"]
    assert shown["foot"] == {"text": "110 bricks, 1 us each"}


def test_resampling_reports_the_pulses_that_are_lost(periph_sim: Run, desk: Path):
    result = periph_sim("convert", NACK, "x.psr", "--sample", "1 MHz")
    assert "x.psr: 2 channels, 158 edges, 0.001165 s in samples of 1 MHz" in result.out
    assert formats.read("x.psr").rate == 10**6
    lossy = periph_sim("convert", NACK, "y.psr", "--sample", "100 kHz")
    assert "note: channel SCL: pulses that fall between two samples of 100 kHz are lost: 57\n" in lossy.out


def test_a_recorded_run_converts_to_every_format(periph_sim: Run, desk: Path):
    assert periph_sim("run", "small.toml", "--record", "run.psr").status == 0
    for out, message in (
        ("run.perfetto.json", "run.perfetto.json: "),
        ("run.vcd", "run.vcd: "),
        ("run.sr", "run.sr: "),
        ("run.fst", "run.fst: "),
        ("run.jsonl", "run.jsonl: "),
    ):
        result = periph_sim("convert", "run.psr", out)
        assert result.status == 0 and result.out.startswith(message) and " records, 0.03 s" in result.out
    result = periph_sim("convert", "run.psr", "wires.csv")
    assert result.out.startswith(
        "wires.csv: 2 channels, 56 edges, 0.03 s in ticks of 3 GHz\nnote: times are rounded to 11"
    )
    wires = periph_sim("convert", "run.psr", "wires.vcd", "--channels", "SDA,SCL", "--sample", "10 MHz")
    assert wires.out.startswith("wires.vcd: 2 channels, 56 edges, 0.03 s in samples of 10 MHz")


def test_a_session_of_a_125_mhz_export_has_that_sample_rate(periph_sim: Run, desk: Path):
    """Times have nine decimals, but all edges are on the 8 ns grid, so the session has 125 MHz and not 1 GHz."""
    rows = ["Time [s],SCL", "0.000000000,1", "0.000000504,0", "0.000000640,1", "0.013200008,0", "0.013200016,0"]
    Path("logic2.csv").write_text("\n".join(rows) + "\n")
    assert periph_sim.passes("convert", "logic2.csv", "a.sr").splitlines() == [
        "a.sr: 1 channel, 3 edges, 0.0132 s in samples of 125 MHz",
        "note: times are written as samples of 125 MHz, the slowest rate that has one at every edge",
    ]
    assert formats.read("a.sr").channels[0].edges.tolist() == [63, 80, 1_650_001]
    assert periph_sim("convert", "logic2.csv", "b.sr", "--rate", "125 MHz").out.startswith("b.sr: 1 channel, 3 edges, ")
    assert formats.read("b.sr").channels[0].edges.tolist() == [63, 80, 1_650_001]


def test_information_that_a_format_cannot_hold_is_a_note(periph_sim: Run, desk: Path):
    gap = b"Time [s],My SDA\n0.0,1\n0.000001,X\n0.000002,0\n0.000003,0\n"
    Path("gap.csv").write_bytes(gap)
    result = periph_sim("convert", "gap.csv", "gap.vcd")
    assert result.out == (
        "gap.vcd: 1 channel, 1 edge, 3.001e-06 s in ticks of 1 GHz\n"
        "note: names that VCD cannot hold were changed: 'My SDA' My_SDA\n"
    )
    assert formats.read("gap.vcd").channels[0].unknown == (formats.Span(1000, 2000),)
    result = periph_sim("convert", "gap.csv", "gap.sr")
    assert result.out.count("note: ") == 1
    assert "note: a session has no unknown levels: those of My SDA are written as the level before them" in result.out


@pytest.mark.parametrize("suffix", [".vcd", ".fst", ".csv", ".sr", ".psr"])
@pytest.mark.parametrize(
    "names",
    [
        "A,A,A_2",
        "a b,a_b,a_b",
        "bus.SDA,RX,bus.SCL",  # .vcd and .fst declare RX first
        "bus.D[3],RX,bus.D[2]",  # .fst is read with other indices
        "x.y,,x",  # an empty name gets a number
    ],
)
def test_channels_keep_their_edges_if_names_or_order_change(periph_sim: Run, desk: Path, names: str, suffix: str):
    rows = [f"Time [s],{names}", "0.000,0,0,1", "0.001,1,0,1", "0.002,1,1,1", "0.003,0,0,0", "0.004,0,1,0"]
    Path("given.csv").write_text("\n".join(rows) + "\n")
    periph_sim.passes("convert", "given.csv", f"out{suffix}")


@pytest.mark.parametrize("names", ["A,B", "A,A"])
def test_edges_that_a_writer_swaps_are_an_error(periph_sim: Run, desk: Path, monkeypatch, names: str):
    Path("given.csv").write_text(f"Time [s],{names}\n0.000,0,0\n0.001,1,0\n0.002,1,1\n0.003,1,1\n")
    write = saleae_csv.write

    def swapped(capture: formats.Capture, path: Path) -> tuple[str, ...]:
        one, two = capture.channels
        return write(replace(capture, channels=(replace(two, name=one.name), replace(one, name=two.name))), path)

    monkeypatch.setattr(saleae_csv, "write", swapped)
    assert "found other edges of A than in given.csv" in periph_sim.refused("convert", "given.csv", "out.csv")


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ([NACK, "x.vdc"], "x.vdc: nothing is written as '.vdc'; did you mean .vcd"),
        ([NACK, "x"], "x: nothing is written as ''; it has .csv, .fst, .jsonl, .perfetto.json, .psr, "),
        (
            [NACK, "x.perfetto.json"],
            "x.perfetto.json: this format holds the records of a run, not a capture; record one with "
            "run --record run.psr",
        ),
        (
            [NACK, "x.jsonl", "--window", "0..9"],
            "x.jsonl: this format holds the records of a run, not a capture; remove the options that select a part",
        ),
        (
            ["none.sr", "x.vcd"],
            "none.sr, the file: found no such file or directory, expected a file that can be read; check its name",
        ),
        (["still.py", "x.vcd"], "still.py, its first bytes: found b'def main(dsp, settings):', expected "),
        ([NACK, "x.vcd", "--channels", "SDL"], "nack.sr: there is no channel 'SDL'; did you mean SDA or SCL?"),
        ([NACK, "x.vcd", "--rate", "fast"], "--rate: 'fast' is no sample rate; expected a number with or without"),
        ([NACK, "x.vcd", "--rate", "0"], "--rate: expected more than 0"),
        ([NACK, "x.vcd", "--sample", "0"], "--sample: expected more than 0"),
        ([NACK, "x.vcd", "--window", "1 ms"], "--window: '1 ms' is no window; expected FROM..TO, as in '100 us..1.2"),
        ([NACK, "x.vcd", "--window", "2 ms..1 ms"], "--window: '2 ms..1 ms' ends before it begins"),
        ([NACK, "x.vcd", "--window", "1 fortnight..2"], "--window: '1 fortnight': unit 'fortnight' is none of ns, us,"),
        (
            [NACK, "x.vcd", "--window", "1 ms..9 s"],
            "nack.sr, its window: found positions 4000 to 36000000, expected a stretch within 0 to 4660; "
            "state another window",
        ),
        ([NACK, "no/x.vcd"], "no/x.vcd, its place: found no such file or directory, expected a place that can be "),
    ],
)
def test_bad_input_is_one_error_message_and_leaves_no_file(
    periph_sim: Run, desk: Path, arguments: list[str], sentence: str
):
    before = sorted(desk.iterdir())
    assert sentence in periph_sim.refused("convert", *arguments)
    assert sorted(desk.iterdir()) == before


@pytest.mark.parametrize("same", ["x.psr", "./x.psr", "link.psr"])
def test_out_and_in_must_be_different_files(periph_sim: Run, desk: Path, same: str):
    formats.write(formats.read(NACK), "x.psr")
    Path("link.psr").symlink_to("x.psr")
    content = Path("x.psr").read_bytes()
    message = f"{Path(same)}: IN and OUT are one file; give another name for OUT"
    assert periph_sim.refused("convert", "x.psr", same) == message
    assert Path("x.psr").read_bytes() == content


def test_a_damaged_file_is_converted_up_to_the_damage(periph_sim: Run, desk: Path):
    formats.write(formats.read(NACK), "x.vcd")
    content = Path("x.vcd").read_bytes()
    Path("cut.vcd").write_bytes(content[: len(content) // 2] + b"\n#12 quack")
    assert periph_sim("convert", "cut.vcd", "y.psr").status == 2
    assert "note: " in periph_sim.passes("convert", "cut.vcd", "y.psr", "--salvage")
    kept, whole = formats.read("y.psr").channels[0].edges, formats.read("x.vcd").channels[0].edges
    assert 10 < len(kept) < len(whole) and kept.tolist() == whole[: len(kept)].tolist()


def test_a_damaged_time_stamp_does_not_produce_gigabytes_of_samples(periph_sim: Run, desk: Path):
    """The last edges of a file with a timescale of 1 ns have a time stamp of 16.5 s."""
    Path("x.vcd").write_text(
        "$timescale 1 ns $end $var wire 1 ! SCL $end $enddefinitions $end\n"
        "#0 1!\n#100 0!\n#300 1!\n#16500000400 0!\n#16500000500\n"
    )
    assert periph_sim.refused("convert", "x.vcd", "x.sr") == (
        "x.vcd, from 3e-07 s to 16.5000004 s: found 165000001 samples of 10 MHz without an edge, more than in "
        "all the rest, expected at most 67108864 as times become samples; cut a damaged time stamp off with "
        "--window 0..301, or state the rate of the samples with --sample"
    )
    assert not list(desk.glob("*.sr"))
    assert periph_sim("convert", "x.vcd", "x.sr", "--window", "0..301").status == 0
    assert edges(formats.read("x.sr")) == {"SCL": [1, 1, 2]}
    assert periph_sim("convert", "x.vcd", "slow.sr", "--sample", "10 kHz").status == 0
