"""Recordings: a file appears whole or not at all; records made by hand come back from it."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

from periph_sim.core.records import Kind, Recorder
from periph_sim.core.time import Timebase
from periph_sim.records.recording import BadRecording, recording, recording_formats

NS = 3  # ticks
MODULES = {"dsp": ("I2C-A", "SCI-A", "pin:MODEL")}


def record(path: Path) -> None:
    """A short run with one of everything."""
    recorder = Recorder()
    with recording(path, MODULES) as (subscribe, ended_at):
        subscribe(recorder, Timebase(150_000_000))
        edge = recorder.emit(100 * NS, Kind.EDGE, "SDA", "level", 0, "controller")
        recorder.cause = edge
        recorder.emit(110 * NS, Kind.FLAG, "dsp.I2C-A", "I2CSTR.BB", 1)
        recorder.cause = 0
        recorder.emit(120 * NS, Kind.BUS, "controller", "START", 0, "gyroscope")
        recorder.emit(125 * NS, Kind.BUS, "controller", "address", 0x68 << 2 | 2, "gyroscope")
        recorder.emit(126 * NS, Kind.BUS, "controller", "byte", 0x11 << 1 | 1, "gyroscope")
        recorder.emit(127 * NS, Kind.FRAME, "host", "byte", 0x55)
        recorder.emit(130 * NS, Kind.IRQ, "dsp", "I2CINT1A", 1)
        recorder.emit(140 * NS, Kind.SPAN, "dsp", "model", 1)
        recorder.emit(150 * NS, Kind.EDGE, "MODEL", "level", 0, "dsp.GPIO34")
        recorder.emit(160 * NS, Kind.IRQ, "dsp", "I2CINT1A", 0)
        recorder.emit(170 * NS, Kind.FLAG, "dsp.SCI-A", "SCIFFRX.RXFFST", 5)
        recorder.emit(180 * NS, Kind.NOTE, "dsp.I2C-A", "duty", 1, "a note")
        recorder.emit(200 * NS, Kind.EDGE, "SDA", "level", 1)
        ended_at(300 * NS)


def test_jsonl_is_one_record_a_line_with_its_cause(tmp_path: Path):
    path = tmp_path / "run.jsonl"
    record(path)
    head, *rows = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    columns = ["number", "tick", "kind", "where", "what", "value", "text", "cause", "field"]
    assert head == {"periph-sim": 2, "ticks_per_second": 3_000_000_000, "columns": columns}
    assert rows[0] == [1, 300, "edge", "SDA", "level", 0, "controller", 0, ""]
    assert rows[1] == [2, 330, "flag", "dsp.I2C-A", "I2CSTR.BB", 1, "", 1, ""]
    assert [row[0] for row in rows] == list(range(1, 14))


def test_addresses_and_bytes_are_written_as_people_write_them(tmp_path: Path):
    """No 0x86 for a read of 0x21, no 0x0 behind a START."""
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
def test_nothing_is_left_behind_when_a_run_fails_midway(tmp_path: Path, suffix: str):
    recorder = Recorder()
    with (
        pytest.raises(ZeroDivisionError),
        recording(tmp_path / f"run{suffix}", MODULES) as (subscribe, _),
    ):
        subscribe(recorder, Timebase())
        recorder.emit(1, Kind.EDGE, "SDA", "level", 0)
        raise ZeroDivisionError
    assert list(tmp_path.iterdir()) == []


def test_an_older_recording_survives_a_run_that_fails(tmp_path: Path):
    path = tmp_path / "run.jsonl"
    path.write_text("older", encoding="utf-8")
    with pytest.raises(KeyboardInterrupt), recording(path, MODULES):
        raise KeyboardInterrupt
    assert path.read_text(encoding="utf-8") == "older"
    assert list(tmp_path.iterdir()) == [path]


def test_a_recording_may_be_read_by_whom_the_umask_allows(tmp_path: Path):
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
def test_a_place_that_cannot_be_written_is_refused(tmp_path: Path, monkeypatch, name: str, sentence: str):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(BadRecording) as caught, recording(Path(name), MODULES):
        raise AssertionError("nothing may run")
    assert str(caught.value) == sentence
    assert list(tmp_path.iterdir()) == []


def test_without_a_path_nothing_is_recorded():
    recorder = Recorder()
    with recording(None, {}) as (subscribe, ended_at):
        subscribe(recorder, Timebase())
        ended_at(1000)
    assert not any(recorder.wants(kind) for kind in Kind)
