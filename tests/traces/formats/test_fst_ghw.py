"""Reader of FST files, written by the FST library, and of GHW files, written by GHDL if it is installed."""

from __future__ import annotations

import shutil
import subprocess
from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.traces import formats
from periph_sim.traces.formats import Span
from tests.refusals import refusal
from tests.traces.decode.drawing import drawn
from tests.traces.formats.looks import edges, facts

pylibfst = pytest.importorskip("pylibfst", reason="writes the FST files of these tests: pip install pylibfst")

Changes = list[tuple[int, str, str]]  # time, line, value


def written(path: Path, lines: dict[str, int], changes: Changes, end: int = 0, exponent: int = -9) -> Path:
    """Write an FST file. lines: number of bits by name; `real` is a real, `alias X` is another name of X."""
    lib, null = pylibfst.lib, pylibfst.ffi.NULL
    file = lib.fstWriterCreate(str(path).encode(), 1)
    lib.fstWriterSetTimescale(file, exponent)
    for scope in (b"tb", b"bus"):
        lib.fstWriterSetScope(file, lib.FST_ST_VCD_MODULE, scope, null)
    handles: dict[str, int] = {}
    for name, bits in lines.items():
        kind = lib.FST_VT_VCD_REAL if name == "real" else lib.FST_VT_VCD_WIRE
        alias = handles[name.removeprefix("alias ")] if name.startswith("alias ") else 0
        handles[name] = lib.fstWriterCreateVar(file, kind, lib.FST_VD_IMPLICIT, bits, name.encode(), alias)
    for time, name, value in changes:
        lib.fstWriterEmitTimeChange(file, time)
        lib.fstWriterEmitValueChange(file, handles[name], value.encode())
    if end:
        lib.fstWriterEmitTimeChange(file, end)
    lib.fstWriterClose(file)
    return path


LATE = 2 * 10**12  # beyond 32 bits
BUS: Changes = [(0, "scl", "1"), (5, "My SDA", "z"), (7, "scl", "0"), (9, "My SDA", "0"), (LATE, "scl", "1")]


def test_scopes_names_aliases_and_long_times_are_read(tmp_path: Path):
    path = written(tmp_path / "x.fst", {"scl": 1, "My SDA": 1, "alias scl": 1}, BUS, LATE + 50)
    capture = formats.read(path)
    assert edges(capture) == {
        "tb.bus.scl": [1, 7, LATE],
        "tb.bus.My SDA": [1, 9],
        "tb.bus.alias scl": [1, 7, LATE],
    }
    assert facts(capture) == (10**9, LATE + 50, False) and capture.notes == ()
    assert capture.channel("My SDA").unknown == (Span(0, 5),)


def test_a_written_file_is_read_with_unknown_spans_and_scopes(tmp_path: Path):
    capture = drawn(
        """
        tb.bus.SCL   --__--____--
        tb.bus.SDA   ??_---??--__
        RX           -__________-
        """
    )
    assert formats.write(capture, tmp_path / "x.fst") == ()
    again = formats.read(tmp_path / "x.fst", capture.rate)
    assert edges(again) == edges(capture) and again.length == capture.length
    assert again.channel("SDA").unknown == (Span(0, 2), Span(6, 8))


@pytest.mark.parametrize(("end", "length"), [(0, 8), (7, 8), (8, 8), (20, 20)])
def test_the_end_is_the_last_time_of_the_file(tmp_path: Path, end: int, length: int):
    assert formats.read(written(tmp_path / "x.fst", {"a": 1}, [(0, "a", "1"), (7, "a", "0")], end)).length == length


def test_states_and_vectors(tmp_path: Path):
    changes: Changes = [(0, "v", "10xz"), (3, "v", "0101"), (5, "a", "x"), (8, "a", "1"), (9, "real", "1.5")]
    capture = formats.read(written(tmp_path / "x.fst", {"a": 1, "v": 4, "real": 8}, [(0, "a", "0"), *changes], 12))
    assert edges(capture) == {
        "tb.bus.a": [0, 8],
        "tb.bus.v[3]": [1, 3],
        "tb.bus.v[2]": [0, 3],
        "tb.bus.v[1]": [0],
        "tb.bus.v[0]": [1],
    }
    unknown = {name: capture.channel(name).unknown for name in ("a", "v[1]")}
    assert unknown == {"a": (Span(5, 8),), "v[1]": (Span(0, 3),)}


@pytest.mark.parametrize(("exponent", "rate"), [(0, 1), (-3, 1000), (-8, 10**8), (-15, 10**15)])
def test_the_timescale_is_exact(tmp_path: Path, exponent: int, rate: int):
    path = written(tmp_path / "x.fst", {"a": 1}, [(0, "a", "1"), (7, "a", "0")], exponent=exponent)
    assert formats.read(path).rate == rate


def test_with_a_given_rate_positions_are_samples(tmp_path: Path):
    path = written(tmp_path / "x.fst", {"a": 1}, [(0, "a", "1"), (42, "a", "0"), (83, "a", "1"), (125, "a", "0")], 200)
    capture = formats.read(path, Fraction(24 * 10**6))
    assert edges(capture) == {"tb.bus.a": [1, 1, 2, 3]} and facts(capture) == (24 * 10**6, 5, True)
    assert refusal(formats.BadCapture, formats.read, path, Fraction(10**8)) == (
        f"{path}, its times: found a change at tick 42, expected times on the grid of 100000000 Hz; "
        "state the right rate or none"
    )


@pytest.mark.parametrize(("end", "beyond"), [(1 << 62, 1 << 62), (0, 1 << 61)])
def test_a_time_beyond_64_bits_at_the_rate_is_rejected(tmp_path: Path, end: int, beyond: int):
    late = (1 << 61) - 1 if not end else 7
    path = written(tmp_path / "x.fst", {"a": 1}, [(0, "a", "1"), (late, "a", "0")], end, exponent=0)
    assert refusal(formats.BadCapture, formats.read, path, Fraction(10**9)) == (
        f"{path}, its times: found sample {beyond}000000000 of 1 GHz, expected at most {1 << 62}; "
        "state the right rate or none"
    )


def test_edges_are_the_same_as_in_vcd(tmp_path: Path):
    given = formats.read(written(tmp_path / "x.fst", {"scl": 1, "sda": 1}, [(0, "scl", "0"), (0, "sda", "1"),
        *((n, ("scl", "sda")[n % 3 == 0], str(n >> 1 & 1)) for n in range(1, 3000))], 4000))  # fmt: skip
    formats.write(given, tmp_path / "x.vcd")
    assert edges(formats.read(tmp_path / "x.vcd")) == edges(given) and len(given.channels[0].edges) > 500


def test_many_signals_are_read_at_once(tmp_path: Path):
    lines = {f"d{n}": 1 + n % 3 for n in range(40)}
    changes = [(t, f"d{t % 40}", format(t * 3 // 40 % 8, "03b")[: 1 + t % 40 % 3]) for t in range(400)]
    few = {name: bits for name, bits in lines.items() if name in ("d1", "d38")}
    many = formats.read(written(tmp_path / "x.fst", lines, changes, 500))
    alone = formats.read(written(tmp_path / "y.fst", few, [c for c in changes if c[1] in few], 500))
    assert {name: edges(many)[name] for name in edges(alone)} == edges(alone)
    assert len(many.channels) == 79 and sum(len(c.edges) for c in alone.channels) > 10


def test_a_file_without_lines_is_rejected(tmp_path: Path):
    path = written(tmp_path / "x.fst", {"real": 8}, [(0, "real", "1.5")])
    assert refusal(formats.BadCapture, formats.read, path) == (
        f"{path}, the file: found no line of one bit, expected at least one; dump the lines of the bus"
    )


def test_an_abort_of_the_reader_is_reported_in_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """The reader aborts, for instance, if a length in a damaged file needs more memory than available."""
    aborting = tmp_path / "reader.py"
    aborting.write_text("import os; os.abort()")
    monkeypatch.setattr("periph_sim.traces.formats.fst_ghw.READER", aborting)
    path = written(tmp_path / "x.fst", {"a": 1}, [(0, "a", "1")])
    assert refusal(formats.BadCapture, formats.read, path) == (
        f"{path}, the file: found an error of its reader (aborted), expected an undamaged waveform of kinds that "
        "it knows; dump it again, or as VCD"
    )


def test_the_message_about_a_cut_file_says_that_salvage_is_impossible(tmp_path: Path):
    path = written(tmp_path / "x.fst", {"scl": 1}, [(t, "scl", str(t % 2)) for t in range(90)], 100)
    assert len(formats.read(path, salvage=True).channels) == 1
    path.write_bytes(path.read_bytes()[:400])
    assert refusal(formats.BadCapture, formats.read, path, salvage=True).endswith(
        "; dump it again, or as VCD, since --salvage reads no part of a file of this format"
    )


GHDL = shutil.which("ghdl")
BLINK = """
entity blink is end entity;
architecture a of blink is
  signal line : bit := '0';
begin
  process begin
    wait for 5 ns; line <= '1'; wait for 2 ns; line <= '0'; wait;
  end process;
end architecture;
"""


@pytest.mark.skipif(GHDL is None, reason="GHW files are written by ghdl, which is not installed")
def test_a_ghw_file_of_ghdl_is_read(tmp_path: Path):
    (tmp_path / "blink.vhd").write_text(BLINK)
    for step in (["-a", "blink.vhd"], ["-e", "blink"], ["-r", "blink", "--wave=x.ghw", "--stop-time=20ns"]):
        subprocess.run([str(GHDL), *step], cwd=tmp_path, check=True, capture_output=True)
    capture = formats.read(tmp_path / "x.ghw")
    line = capture.channel("line")
    assert (capture.rate, line.initial, line.edges.tolist()) == (10**15, 0, [5 * 10**6, 7 * 10**6])
