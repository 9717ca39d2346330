"""What is written and read again has the same edges, on the samples of the same rate."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import example, given, settings

from periph_sim.traces import formats
from periph_sim.traces.capture.capture import channel_of
from periph_sim.traces.formats import Capture, Span
from tests.profiles import examples
from tests.traces.formats.looks import edges, facts
from tests.traces.formats.strategies import captures

KEEPS_HOLES = [".psr", ".vcd", ".csv"]
BEGINS_UNKNOWN = Capture(Path("x"), formats.rate_of("24 MHz"), 9, (channel_of("a", 0, [0, 3, 8], [None, 1, 0], 9),))
ENDS_UNKNOWN = Capture(Path("x"), formats.rate_of("1 MHz"), 9, (channel_of("a", 0, [0, 3, 5], [0, 1, None], 9),))


def states(capture: Capture) -> list[tuple[int, list[int], list[int], tuple[Span, ...]]]:
    return [(c.initial, c.edges.tolist(), c.levels.tolist(), c.unknown) for c in capture.channels]


@pytest.mark.parametrize("suffix", KEEPS_HOLES)
@given(given=captures())
@example(given=BEGINS_UNKNOWN)
@example(given=ENDS_UNKNOWN)
@settings(max_examples=examples(40), deadline=None)
def test_written_and_read_again(tmp_path_factory: pytest.TempPathFactory, suffix: str, given: Capture):
    path = tmp_path_factory.mktemp("trip") / f"x{suffix}"
    formats.write(given, path)
    again = formats.read(path, given.rate)
    by_name = {c.name: c for c in again.channels}
    if suffix != ".vcd":  # which orders by scope, and has no blanks in names
        assert [c.name for c in again.channels] == [c.name for c in given.channels]
    ordered = [by_name[c.name.replace(" ", "_") if suffix == ".vcd" else c.name] for c in given.channels]
    assert states(Capture(path, again.rate, again.length, tuple(ordered))) == states(given)
    assert facts(again) == (given.rate, given.length, True)


@given(given=captures())
@settings(max_examples=examples(40), deadline=None)
def test_psr_keeps_everything_without_being_told(tmp_path_factory: pytest.TempPathFactory, given: Capture):
    path = tmp_path_factory.mktemp("trip") / "x.psr"
    noted = Capture(given.path, given.rate, given.length, given.channels, sampled=False, notes=("a note",))
    formats.write(noted, path)
    again = formats.read(path)
    assert states(again) == states(given) and facts(again) == facts(noted) and again.notes == ("a note",)
    assert [(c.name, c.index) for c in again.channels] == [(c.name, c.index) for c in given.channels]


def test_psr_keeps_a_capture_without_rate_and_channels_of_one_name(tmp_path: Path):
    lines = tuple(channel_of("a", 5 + n, [0, 2 + n], [0, 1], 9) for n in range(2))
    formats.write(Capture(Path("x"), None, 9, lines), tmp_path / "x.psr")
    again = formats.read(tmp_path / "x.psr")
    assert again.rate is None and [(c.index, c.edges.tolist()) for c in again.channels] == [(5, [2]), (6, [3])]
    assert formats.read(tmp_path / "x.psr", formats.rate_of("1 MHz")).rate == 10**6


@pytest.mark.parametrize("suffix", [".vcd", ".csv"])
def test_positions_without_a_time_are_refused(tmp_path: Path, suffix: str):
    capture = Capture(Path("x.sr"), None, 9, (channel_of("a", 0, [0, 2], [0, 1], 9),))
    with pytest.raises(formats.BadCapture) as caught:
        formats.write(capture, tmp_path / f"x{suffix}")
    assert str(caught.value) == (
        "x.sr, its rate: found none stated, expected positions with a time; state it with --rate"
    )
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("rate", "suffix", "note"),
    [
        ("4 MHz", ".vcd", None),
        ("4 MHz", ".csv", None),
        ("500 MHz", ".csv", None),
        (
            "24 MHz",
            ".vcd",
            "a sample of 24 MHz is no whole number of ticks, so times are rounded to 10 ps; "
            "a reader that uses that rate gets the same samples",
        ),
        (
            "24 MHz",
            ".csv",
            "times are rounded to 9 decimals; a reader that uses 24 MHz gets the same samples",
        ),
    ],
)
def test_rounded_times_are_told(tmp_path: Path, rate: str, suffix: str, note: str | None):
    capture = Capture(Path("x.sr"), formats.rate_of(rate), 9, (channel_of("a", 0, [0, 2], [0, 1], 9),))
    assert formats.write(capture, tmp_path / f"x{suffix}") == (() if note is None else (note,))


def test_a_vcd_has_the_coarsest_timescale_that_is_exact(tmp_path: Path):
    line = channel_of("SCL", 0, [0, 2, 5], [1, None, 0], 9)
    formats.write(Capture(Path("x.sr"), formats.rate_of("4 MHz"), 9, (line,)), tmp_path / "x.vcd")
    assert (tmp_path / "x.vcd").read_text() == (
        "$timescale 10 ns $end\n$version periph-sim $end\n$scope module capture $end\n$var wire 1 ! SCL $end\n"
        "$upscope $end\n$enddefinitions $end\n#0\n$dumpvars\n1!\n$end\n#50\nx!\n#125\n0!\n#225\n"
    )


def test_a_saleae_csv_is_as_logic_2_writes_it(tmp_path: Path):
    lines = (channel_of("SCL", 0, [0, 2, 5], [1, None, 0], 9), channel_of("a,b", 1, [0, 5], [0, 1], 9))
    formats.write(Capture(Path("x.sr"), formats.rate_of("4 MHz"), 9, lines), tmp_path / "x.csv")
    assert (tmp_path / "x.csv").read_text() == (
        'Time [s],SCL,"a,b"\n0.000000000,1,0\n0.000000500,X,0\n0.000001250,0,1\n0.000002000,0,1\n'
    )


def test_names_that_vcd_cannot_hold_are_changed_and_told(tmp_path: Path):
    names = ["My SDA", "My_SDA", "", "a..b", "$end"]
    lines = tuple(channel_of(name, n, [0], [n & 1], 9) for n, name in enumerate(names))
    notes = formats.write(Capture(Path("x.sr"), formats.rate_of("4 MHz"), 9, lines), tmp_path / "x.vcd")
    assert notes == (
        "names that VCD cannot hold were changed: 'My SDA' My_SDA, 'My_SDA' My_SDA_2, '' channel_2, 'a..b' channel_3, "
        "'$end' _end",
    )
    again = formats.read(tmp_path / "x.vcd")
    assert edges(again) == {"My_SDA": [0], "My_SDA_2": [1], "channel_2": [0], "channel_3": [1], "_end": [0]}
