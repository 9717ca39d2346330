"""Written files have the same edges when they are read by this package, by other libraries or by sigrok."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import pytest
import pywellen
from hypothesis import example, given, settings

from periph_sim.traces import formats
from periph_sim.traces.capture.capture import changes, channel_of
from periph_sim.traces.decode import i2c, uart
from periph_sim.traces.formats import Capture, Span
from tests.profiles import examples
from tests.records.vcdvcd_reader import VCDVCD
from tests.refusals import refusal
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
def test_a_written_capture_is_read_unchanged(tmp_path_factory: pytest.TempPathFactory, suffix: str, given: Capture):
    path = tmp_path_factory.mktemp("trip") / f"x{suffix}"
    formats.write(given, path)
    again = formats.read(path, given.rate)
    by_name = {c.name: c for c in again.channels}
    if suffix != ".vcd":  # VCD is ordered by scope and has no spaces in names
        assert [c.name for c in again.channels] == [c.name for c in given.channels]
    ordered = [by_name[c.name.replace(" ", "_") if suffix == ".vcd" else c.name] for c in given.channels]
    assert states(Capture(path, again.rate, again.length, tuple(ordered))) == states(given)
    assert facts(again) == (given.rate, given.length, True)


@given(given=captures())
@settings(max_examples=examples(40), deadline=None)
def test_psr_keeps_all_properties_of_a_capture(tmp_path_factory: pytest.TempPathFactory, given: Capture):
    path = tmp_path_factory.mktemp("trip") / "x.psr"
    noted = Capture(given.path, given.rate, given.length, given.channels, sampled=False, notes=("a note",))
    formats.write(noted, path)
    again = formats.read(path)
    assert states(again) == states(given) and facts(again) == facts(noted) and again.notes == ("a note",)
    assert [(c.name, c.index) for c in again.channels] == [(c.name, c.index) for c in given.channels]


def test_psr_keeps_a_capture_without_a_rate_and_with_equal_names(tmp_path: Path):
    lines = tuple(channel_of("a", 5 + n, [0, 2 + n], [0, 1], 9) for n in range(2))
    formats.write(Capture(Path("x"), None, 9, lines), tmp_path / "x.psr")
    again = formats.read(tmp_path / "x.psr")
    assert again.rate is None and [(c.index, c.edges.tolist()) for c in again.channels] == [(5, [2]), (6, [3])]
    assert formats.read(tmp_path / "x.psr", formats.rate_of("1 MHz")).rate == 10**6


@pytest.mark.parametrize("suffix", [".vcd", ".csv"])
def test_a_capture_without_a_rate_is_rejected(tmp_path: Path, suffix: str):
    capture = Capture(Path("x.sr"), None, 9, (channel_of("a", 0, [0, 2], [0, 1], 9),))
    assert refusal(formats.BadCapture, formats.write, capture, tmp_path / f"x{suffix}") == (
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
def test_a_note_reports_rounded_times(tmp_path: Path, rate: str, suffix: str, note: str | None):
    capture = Capture(Path("x.sr"), formats.rate_of(rate), 9, (channel_of("a", 0, [0, 2], [0, 1], 9),))
    assert formats.write(capture, tmp_path / f"x{suffix}") == (() if note is None else (note,))


def test_a_vcd_has_the_coarsest_timescale_that_is_exact(tmp_path: Path):
    line = channel_of("SCL", 0, [0, 2, 5], [1, None, 0], 9)
    formats.write(Capture(Path("x.sr"), formats.rate_of("4 MHz"), 9, (line,)), tmp_path / "x.vcd")
    assert (tmp_path / "x.vcd").read_text() == (
        "$timescale 10 ns $end\n$version periph-sim $end\n$scope module capture $end\n$var wire 1 ! SCL $end\n"
        "$upscope $end\n$enddefinitions $end\n#0\n$dumpvars\n1!\n$end\n#50\nx!\n#125\n0!\n#225\n"
    )


def test_a_saleae_csv_has_the_form_of_logic_2(tmp_path: Path):
    lines = (channel_of("SCL", 0, [0, 2, 5], [1, None, 0], 9), channel_of("a,b", 1, [0, 5], [0, 1], 9))
    formats.write(Capture(Path("x.sr"), formats.rate_of("4 MHz"), 9, lines), tmp_path / "x.csv")
    assert (tmp_path / "x.csv").read_text() == (
        'Time [s],SCL,"a,b"\n0.000000000,1,0\n0.000000500,X,0\n0.000001250,0,1\n0.000002000,0,1\n'
    )


def test_names_that_are_invalid_in_vcd_are_changed_with_a_note(tmp_path: Path):
    names = ["My SDA", "My_SDA", "", "a..b", "$end"]
    lines = tuple(channel_of(name, n, [0], [n & 1], 9) for n, name in enumerate(names))
    notes = formats.write(Capture(Path("x.sr"), formats.rate_of("4 MHz"), 9, lines), tmp_path / "x.vcd")
    assert notes == (
        "names that VCD cannot hold were changed: 'My SDA' My_SDA, 'My_SDA' My_SDA_2, '' channel_2, 'a..b' channel_3, "
        "'$end' _end",
    )
    again = formats.read(tmp_path / "x.vcd")
    assert edges(again) == {"My_SDA": [0], "My_SDA_2": [1], "channel_2": [0], "channel_3": [1], "_end": [0]}


TRACES = Path(__file__).resolve().parents[3] / "traces"
SIGROK = shutil.which("sigrok-cli")
needs_sigrok = pytest.mark.skipif(SIGROK is None, reason="sigrok-cli is not installed")

States = dict[str, list[tuple[int, str]]]


def expected(capture: Capture) -> States:
    """Map each name, as it is in the VCD, to its (position, state)."""
    found: States = {f"capture.{c.name.replace(' ', '_')}": [] for c in capture.channels}
    names = list(found)
    for at, which, state in zip(*(column.tolist() for column in changes(capture)), strict=True):
        found[names[which]].append((at, "01x"[state]))
    return found


def positions(states: States, per_second: Fraction, rate: Fraction) -> States:
    return {name: [(round(at * rate / per_second), state) for at, state in of] for name, of in states.items()}


@given(given=captures())
@settings(max_examples=examples(40), deadline=None)
def test_vcdvcd_reads_the_same_changes(tmp_path_factory: pytest.TempPathFactory, given: Capture):
    path = tmp_path_factory.mktemp("vcd") / "x.vcd"
    formats.write(given, path)
    other = VCDVCD(str(path))
    per_second = 1 / Fraction(str(other.timescale["timescale"]))
    found = {name: [(at, state) for at, state in other[name].tv] for name in other.signals}
    assert positions(found, per_second, given.rate) == expected(given)
    assert round(other.endtime * given.rate / per_second) == given.length


@given(given=captures())
@settings(max_examples=examples(40), deadline=None)
def test_wellen_reads_the_same_changes(tmp_path_factory: pytest.TempPathFactory, given: Capture):
    path = tmp_path_factory.mktemp("vcd") / "x.vcd"
    formats.write(given, path)
    other = pywellen.Waveform(str(path), multi_threaded=False)
    per_second = Fraction(10 ** -other.timescale.unit.to_exponent(), other.timescale.factor)
    found = {re.sub(r"\[3\]$", "", v.full_name): [(at, str(state)) for at, state in v.signal] for v in other.all_vars()}
    plain = {re.sub(r"\[3\]$", "", name): of for name, of in expected(given).items()}  # wellen parses indices as ranges
    assert positions(found, per_second, given.rate) == plain


def oracle(path: Path, *decoder: str) -> list[str]:
    command = [str(SIGROK), "-I", "vcd", "-i", str(path), "-P", decoder[0], "-A", decoder[1]]
    said = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return [line.partition(": ")[2] for line in said.splitlines()]


@needs_sigrok
@pytest.mark.parametrize("name", ["imu_round.sr", "nack.sr"])
def test_sigrok_decodes_the_same_bytes(tmp_path: Path, name: str):
    capture = formats.read(TRACES / name)
    formats.write(capture, tmp_path / "x.vcd")
    wanted = "i2c=address-read:address-write:data-read:data-write:ack:nack"
    said = oracle(tmp_path / "x.vcd", "i2c:scl=SCL:sda=SDA", wanted)
    ours = []
    for event in i2c.events(capture):
        way = "read" if event.read else "write"
        if event.kind.name in ("ADDRESS", "DATA"):
            ours.append(f"{event.kind.name.capitalize()} {way}: {event.value:02X}")
        elif event.kind.name in ("ACK", "NACK"):
            ours.append(event.kind.name)
    assert len(ours) > 10 and [line for line in said if line in set(ours)] == ours


@needs_sigrok
def test_sigrok_decodes_the_same_frames(tmp_path: Path):
    capture = formats.read(TRACES / "host_frames.sr")
    formats.write(capture, tmp_path / "x.vcd")
    said = oracle(tmp_path / "x.vcd", "uart:rx=RX:baudrate=115200", "uart=rx-data")
    frames = [event for event in uart.events(capture, "RX", uart.Line(115200)) if event.kind.name == "FRAME"]
    assert said == [f"{frame.value:02X}" for frame in frames] and len(said) == 24


def picture(capture: Capture, path: Path) -> dict[str, object]:
    formats.write(capture, path)
    return json.loads(path.read_text(encoding="utf-8"))


def test_a_short_window_is_written_as_wavedrom(tmp_path: Path):
    lines = (
        channel_of("SCL", 0, [0, 4, 8, 12], [1, 0, 1, 0], 20),
        channel_of("SDA", 1, [0, 2, 6, 10], [1, 0, None, 1], 20),
    )
    shown = picture(Capture(Path("x"), formats.rate_of("4 MHz"), 20, lines), tmp_path / "x.wavedrom.json")
    assert shown == {
        "signal": [{"name": "SCL", "wave": "1.0.1.0..."}, {"name": "SDA", "wave": "10.x.1...."}],
        "config": {"skin": "narrowerer"},
        "foot": {"text": "10 bricks, 500 ns each"},
    }


@given(given=captures())
@settings(max_examples=examples(40), deadline=None)
def test_the_wave_of_wavedrom_has_the_edges(tmp_path_factory: pytest.TempPathFactory, given: Capture):
    path = tmp_path_factory.mktemp("drom") / "x.wavedrom.json"
    try:
        shown = picture(given, path)
    except formats.BadCapture as error:
        assert " bricks of " in str(error) and not path.exists()
        return
    bricks = {len(lane["wave"]) for lane in shown["signal"]}
    assert len(bricks) == 1
    at, which, states = (column.tolist() for column in changes(given))
    size = min([b - a for a, b in pairwise(sorted({*at, given.length}))], default=1)
    for number, lane in enumerate(shown["signal"]):
        placed = [(place, letter) for place, letter in enumerate(lane["wave"]) if letter != "."]
        expected = [(p, "01x"[s]) for p, w, s in zip(at, which, states, strict=True) if w == number]
        assert [letter for _, letter in placed] == [letter for _, letter in expected]
        steps = {p // b for (p, _), (b, _) in zip(expected, placed, strict=True) if b}
        assert len(steps) <= 1 and all(step <= size for step in steps)


def test_a_long_window_is_rejected(tmp_path: Path):
    many = channel_of("SCL", 0, range(5000), [n & 1 for n in range(5000)], 5000)
    far = channel_of("SCL", 0, [0, 1], [0, 1], 10**6)
    sparse = channel_of("SCL", 0, [0, 3, 900_001], [0, 1, 0], 10**6)
    way_out = "state a shorter one, as --window '100 us..150 us'"
    for line, found in ((many, "4999 edges, expected at most 1000"), (sparse, "1000000 bricks of 1 positions")):
        said = refusal(
            formats.BadCapture, formats.write, Capture(Path("x.sr"), None, 10**6, (line,)), tmp_path / "x.wavedrom.json"
        )
        assert said.startswith(f"x.sr, the window: found {found}") and said.endswith(way_out)
    with pytest.raises(formats.BadCapture, match="1000000 bricks of 1 positions"):
        formats.write(Capture(Path("x.sr"), None, 10**6, (far,)), tmp_path / "x.wavedrom.json")
    assert list(tmp_path.iterdir()) == []
