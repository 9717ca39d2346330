"""Recordings: files appear complete or not at all, records can be read back, and .psr converts to each other format."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.core.records import Kind, Recorder
from periph_sim.core.time import Timebase
from periph_sim.records.recording import BadRecording, recording, recording_formats, rewrite
from periph_sim.scene.case.load import load
from periph_sim.traces import formats
from periph_sim.traces.capture.sampling import resampled
from periph_sim.traces.formats import psr
from tests.records.scenes import MODULES, recorded_to, written
from tests.refusals import refusal

NS = 3  # ticks


ROWS = (  # one record of each kind
    (100 * NS, Kind.EDGE, "SDA", "level", 0, "controller"),
    (120 * NS, Kind.BUS, "controller", "START", 0, "gyroscope"),
    (125 * NS, Kind.BUS, "controller", "address", 0x68 << 2 | 2, "gyroscope"),
    (126 * NS, Kind.BUS, "controller", "byte", 0x11 << 1 | 1, "gyroscope"),
    (127 * NS, Kind.FRAME, "host", "byte", 0x55),
    (130 * NS, Kind.IRQ, "dsp", "I2CINT1A", 1),
    (140 * NS, Kind.SPAN, "dsp", "model", 1),
    (150 * NS, Kind.EDGE, "MODEL", "level", 0, "dsp.GPIO34"),
    (160 * NS, Kind.IRQ, "dsp", "I2CINT1A", 0),
    (170 * NS, Kind.FLAG, "dsp.SCI-A", "SCIFFRX.RXFFST", 5),
    (180 * NS, Kind.NOTE, "dsp.I2C-A", "duty", 1, "a note"),
    (200 * NS, Kind.EDGE, "SDA", "level", 1),
)


def record(path: Path) -> None:
    written(path, *ROWS, end=300 * NS)


def test_a_record_has_the_number_of_its_cause(tmp_path: Path):
    recorder, path = Recorder(), tmp_path / "run.jsonl"
    with recording(path, MODULES) as (subscribe, ended_at):
        subscribe(recorder, Timebase())
        recorder.cause = recorder.emit(1, *ROWS[0][1:])
        recorder.emit(2, Kind.FLAG, "dsp.I2C-A", "I2CSTR.BB", 1)
        ended_at(9, {})
    assert [json.loads(line)[7] for line in path.read_text(encoding="utf-8").splitlines()[1:]] == [0, 1]


def test_a_jsonl_file_has_one_record_per_line(tmp_path: Path):
    path = tmp_path / "run.jsonl"
    record(path)
    head, *rows = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    columns = ["number", "tick", "kind", "where", "what", "value", "text", "cause", "field"]
    assert head == {"periph-sim": 2, "ticks_per_second": 3_000_000_000, "columns": columns}
    assert rows[0] == [1, 300, "edge", "SDA", "level", 0, "controller", 0, ""]
    assert rows[9] == [10, 510, "flag", "dsp.SCI-A", "SCIFFRX.RXFFST", 5, "", 0, ""]
    assert [row[0] for row in rows] == list(range(1, 13))


def test_addresses_and_bytes_are_written_in_the_usual_notation(tmp_path: Path):
    """An address is written without its R/W bit, and a START without a value."""
    record(tmp_path / "run.jsonl")
    _, *rows = [json.loads(line) for line in (tmp_path / "run.jsonl").read_text(encoding="utf-8").splitlines()]
    said = [(row[4], row[5]) for row in rows if row[2] in ("bus", "frame")]
    assert said == [("START", None), ("address", "0x68 R ACK"), ("byte", "0x11 NACK"), ("byte", "0x55")]
    record(tmp_path / "run.perfetto.json")
    events = json.loads((tmp_path / "run.perfetto.json").read_text(encoding="utf-8"))["traceEvents"]
    instants = [event["name"] for event in events if event["ph"] == "i"]
    assert instants[:4] == ["START gyroscope", "0x68 R ACK gyroscope", "0x11 NACK gyroscope", "0x55"]


@pytest.mark.parametrize("suffix", sorted(recording_formats()))
def test_two_equal_runs_give_equal_files(tmp_path: Path, suffix: str):
    first, second = tmp_path / f"a{suffix}", tmp_path / f"b{suffix}"
    record(first)
    record(second)
    assert first.read_bytes() == second.read_bytes()


@pytest.mark.parametrize("suffix", sorted(recording_formats()))
def test_a_run_that_fails_leaves_no_file(tmp_path: Path, suffix: str):
    recorder = Recorder()
    with (
        pytest.raises(ZeroDivisionError),
        recording(tmp_path / f"run{suffix}", MODULES) as (subscribe, _),
    ):
        subscribe(recorder, Timebase())
        recorder.emit(1, Kind.EDGE, "SDA", "level", 0)
        raise ZeroDivisionError
    assert list(tmp_path.iterdir()) == []


def test_a_run_that_fails_keeps_an_older_recording(tmp_path: Path):
    path = tmp_path / "run.jsonl"
    path.write_text("older", encoding="utf-8")
    with pytest.raises(KeyboardInterrupt), recording(path, MODULES):
        raise KeyboardInterrupt
    assert path.read_text(encoding="utf-8") == "older"
    assert list(tmp_path.iterdir()) == [path]


def test_the_permissions_of_a_recording_follow_the_umask(tmp_path: Path):
    path = tmp_path / "run.jsonl"
    outer = os.umask(0o027)
    try:
        record(path)
    finally:
        os.umask(outer)
    assert path.stat().st_mode & 0o777 == 0o640


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        (
            "missing/run.vcd",
            "missing/run.vcd, its place: found no such file or directory, expected a place that can be written to; "
            "give another path",
        ),
        ("run.vdc", "run.vdc: no recording is written as '.vdc'; did you mean .vcd?"),
        ("run", "run: no recording is written as ''; it has .fst, .jsonl, .perfetto.json, .psr, .sr, .vcd"),
    ],
)
def test_a_path_that_cannot_be_written_is_rejected(tmp_path: Path, monkeypatch, name: str, sentence: str):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(BadRecording) as caught, recording(Path(name), MODULES):
        raise AssertionError("nothing may run")
    assert str(caught.value) == sentence
    assert list(tmp_path.iterdir()) == []


def test_without_a_path_nothing_is_recorded():
    recorder = Recorder()
    with recording(None, {}) as (subscribe, ended_at):
        subscribe(recorder, Timebase())
        ended_at(1000, {})
    assert not any(recorder.wants(kind) for kind in Kind)


WORDS = {"address": r"0x[0-9A-F]{2} [RW] N?ACK", "byte": r"0x[0-9A-F]{2}( N?ACK)?", "end": r"0x[0-9A-F]{2}"}
TIMING = Path(__file__).resolve().parents[3] / "timing"


def record_case(case_name: str, path: Path) -> Path:
    return recorded_to(path, load(TIMING / f"{case_name}.toml", ["duration=60 ms"]))


@pytest.fixture(params=["imu_hil_published", "two_dsps"], scope="module")
def recorded(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, Path]]:
    yield request.param, record_case(request.param, tmp_path_factory.mktemp("runs") / "run.psr")


def test_the_records_of_a_psr_file_are_those_of_the_jsonl_file(recorded: tuple[str, Path], tmp_path: Path):
    case, path = recorded
    lines = record_case(case, tmp_path / "run.jsonl").read_text(encoding="utf-8").splitlines()
    table = psr.read_table(path)
    rows = [[r.number, r.tick, r.kind.value, *r[3:]] for r in table.records()]
    written = [json.loads(line) for line in lines[1:]]
    for row, line in zip(rows, written, strict=True):
        if row[2] in ("bus", "frame"):  # their values are words in a .jsonl
            assert line[5] is None or re.fullmatch(WORDS[row[4]], line[5])
            row[5] = line[5]
    assert len(rows) > 1000 and rows == written
    assert table.per_second == json.loads(lines[0])["ticks_per_second"]


@pytest.mark.parametrize("suffix", [".jsonl", ".vcd", ".sr", ".perfetto.json", ".psr"])
def test_a_converted_psr_file_equals_a_recording_in_that_format(
    recorded: tuple[str, Path], tmp_path: Path, suffix: str
):
    case, path = recorded
    rewrite(psr.read_table(path), tmp_path / f"again{suffix}")
    live = record_case(case, tmp_path / f"live{suffix}")
    assert (tmp_path / f"again{suffix}").read_bytes() == live.read_bytes()


@pytest.mark.parametrize("suffix, rate", [(".vcd", 10**9), (".sr", 10**8)])
def test_the_wires_of_a_psr_file_are_those_of_other_formats_at_their_rate(
    recorded: tuple[str, Path], tmp_path: Path, suffix: str, rate: int
):
    case, path = recorded
    other = formats.read(record_case(case, tmp_path / f"run{suffix}"))
    wires = formats.read(path)
    assert len(wires.channels) > 1 and other.rate == rate
    for wire in resampled(wires, Fraction(rate)).channels:
        found = other.channel(wire.name)
        assert (found.initial, found.edges.tolist()) == (wire.initial, wire.edges.tolist())


def test_a_capture_cannot_be_converted_to_a_run(tmp_path: Path):
    table = psr.read_table(_capture(tmp_path / "x.psr"))
    assert refusal(BadRecording, rewrite, table, tmp_path / "x.jsonl") == (
        f"{tmp_path}/x.jsonl: cannot be written (4000000 ticks a second; a run has whole ones a nanosecond)"
    )
    assert [path.name for path in tmp_path.iterdir()] == ["x.psr"]


def _capture(path: Path) -> Path:
    formats.write(formats.read(TIMING.parent / "traces" / "nack.sr"), path)
    return path


BEGINS_SLOWLY = """
 .sect ".text", 0x9000
_c_int00: EALLOW
 MOVW DP,#0x7029 >> 6
 MOV @0x7029,#0x68
 MOVW DP,#0x7021 >> 6
 MOV @0x7021,#10
 MOVW DP,#0x7011 >> 6
 AND @0x7011,#0xFE7F
 OR @0x7011,#2 << 7
loop: SB loop,UNC
"""


def test_a_recording_has_the_clocks_that_the_program_set_up(tmp_path: Path):
    (tmp_path / "own.asm").write_text(BEGINS_SLOWLY)
    unit = 'image = "own.asm"\nmodules = ["GPIO"]\noscclk = "20 MHz"\nppm = 50'
    (tmp_path / "own.toml").write_text(f'name = "own"\nduration = "10 ms"\n[unit.dsp]\n{unit}\n')
    table = psr.read_table(recorded_to(tmp_path / "own.psr", load(tmp_path / "own.toml")))
    crystal = 20 * (1 + Fraction(50, 10**6))
    megahertz = [hz / 10**6 for _, hz in table.clocks["dsp"]]
    assert megahertz == [crystal / 4, crystal / 2, crystal * 5]  # after reset, after DIVSEL, and after the PLL locked
    assert table.clocks["dsp"][0][0] == 0
    locks = Fraction(table.clocks["dsp"][2][0], table.per_second)
    assert locks == pytest.approx(131_072 / (crystal * 10**6), rel=1e-3)
