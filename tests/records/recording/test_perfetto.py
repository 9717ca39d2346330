"""Perfetto's JSON: the rules of the Trace Event Format, and the complete contents for a short run."""

from __future__ import annotations

import json
from collections import defaultdict
from pathlib import Path
from typing import Any

import pytest

from periph_sim.core.records import Kind
from periph_sim.traces import formats
from tests.records.recording.test_recording import record_case
from tests.records.scenes import written

Event = dict[str, Any]
NS = 3  # ticks


def events_of(path: Path) -> list[Event]:
    return json.loads(path.read_text(encoding="utf-8"))["traceEvents"]


def names(events: list[Event], what: str) -> dict[tuple[int, int], str]:
    return {(e["pid"], e["tid"]): e["args"]["name"] for e in events if e["ph"] == "M" and e["name"] == what}


def by_track(events: list[Event]) -> dict[tuple[str, str], list[Event]]:
    """Map (process, thread) to its slices and instants, in the order of the file."""
    processes = {pid: name for (pid, _), name in names(events, "process_name").items()}
    threads = names(events, "thread_name")
    found = defaultdict(list)
    for event in events:
        if event["ph"] in "BEi":
            found[processes[event["pid"]], threads[event["pid"], event["tid"]]].append(event)
    return found


@pytest.mark.parametrize("case", ["imu_hil_published", "two_dsps", "responder"])
def test_a_run_is_written_by_the_rules_of_the_format(tmp_path: Path, case: str):
    events = events_of(record_case(case, tmp_path / "run.perfetto.json"))
    assert {event["ph"] for event in events} <= set("MBEiC")
    for event in events:
        assert isinstance(event["pid"], int) and isinstance(event["tid"], int) and event["name"]
        assert event["ph"] == "M" or (isinstance(event["ts"], float | int) and event["ts"] >= 0)
    for track, on_it in by_track(events).items():
        times = [event["ts"] for event in on_it]
        assert times == sorted(times), track
        open_slices = []
        for event in on_it:
            if event["ph"] == "B":
                open_slices.append(event["name"])
            elif event["ph"] == "E":
                assert open_slices.pop() == event["name"], track
        assert not open_slices, track
    counted = defaultdict(list)
    for event in events:
        if event["ph"] == "C":
            assert set(event["args"]) == {"value"}
            counted[event["pid"], event["name"]].append(event["ts"])
    assert counted and all(times == sorted(times) for times in counted.values())
    named = {pid for pid, _ in names(events, "process_name")}
    assert {event["pid"] for event in events} == named


def test_transfers_have_the_bytes_of_the_bus(tmp_path: Path):
    tracks = by_track(events_of(record_case("imu_hil_published", tmp_path / "run.perfetto.json")))
    begun = [event["name"] for event in tracks["bus", "transfers"] if event["ph"] == "B"]
    assert begun[:5] == ["0x68 W 0x68 R", "0x68 W ACK", "0x1D ACK", "0x68 R ACK", begun[4]]
    said = [event["name"] for event in tracks["bus", "controller"]]
    assert said[:2] == ["START gyroscope", "0x68 W ACK gyroscope"]
    assert len(begun) - begun.count("0x68 W 0x68 R") > 20


def test_the_contents_of_a_short_run(tmp_path: Path):
    rows = [
        (100 * NS, Kind.SPAN, "dsp", "round", 1),
        (100 * NS + 1, Kind.FLAG, "dsp.I2C-A", "I2CSTR.BB", 1),
        (110 * NS, Kind.SPAN, "dsp", "model", 1),
        (120 * NS, Kind.IRQ, "dsp", "I2CINT1A", 1),
        (130 * NS, Kind.IRQ, "dsp", "I2CINT1A", 0),
        (140 * NS, Kind.SPAN, "dsp", "model", 0),
        (150 * NS, Kind.NOTE, "dsp.I2C-A", "duty", 1, "a note"),
        (160 * NS, Kind.FRAME, "host", "byte", 0x55),
        (170 * NS, Kind.EDGE, "MODEL", "level", 0),
    ]
    events = events_of(written(tmp_path / "run.perfetto.json", *rows, end=1_234_567 * NS))
    shown = [(e["ph"], e["name"], e["ts"], e["args"]) for e in events if e["ph"] != "M"]
    assert shown == [
        ("B", "round", 0.1, {"tick": 300}),
        ("C", "I2CSTR.BB", 0.1, {"value": 1}),
        ("B", "model", 0.11, {"tick": 330}),
        ("B", "I2CINT1A", 0.12, {"tick": 360}),
        ("E", "I2CINT1A", 0.13, {"tick": 390}),
        ("E", "model", 0.14, {"tick": 420}),
        ("i", "duty", 0.15, {"tick": 450, "value": 1, "text": "a note"}),
        ("i", "0x55", 0.16, {"tick": 480}),
        ("C", "MODEL", 0.17, {"value": 0}),
        ("E", "round", 1234.567, {"tick": 3_703_701}),
    ]
    assert set(by_track(events)) == {
        ("dsp", "firmware"),
        ("dsp", "interrupts"),
        ("dsp.I2C-A", "notes"),
        ("bus", "host"),
    }


def test_a_stop_without_a_start_makes_no_transfer(tmp_path: Path):
    edges = [("SCL", 0), ("SDA", 0), ("SCL", 1), ("SDA", 1)]
    rows = [(tick * NS, Kind.EDGE, wire, "level", level) for tick, (wire, level) in enumerate(edges, 1)]
    assert not by_track(events_of(written(tmp_path / "run.perfetto.json", *rows, end=10 * NS)))


Wires = tuple[str, str]  # levels of SCL and SDA; a character is 100 ns
START, AGAIN, STOP = ("---", "--_"), ("_--", "--_"), ("_--", "__-")


def bits(value: int, acked: int, count: int = 9) -> Wires:
    """The first `count` bits of a byte with its ACK bit, each a low and a high phase of SCL."""
    levels = f"{value:08b}{1 - acked}"[:count]
    return "_-" * count, "".join("_-"[int(level)] * 2 for level in levels)


@pytest.mark.parametrize(
    ("parts", "shown"),
    [
        (
            [START, bits(0xA6, 1), bits(0x05, 0), AGAIN, bits(0xA7, 1), bits(0x81, 0), STOP, ("--", "--")],
            "B2 0x53 W 0x53 R, B4 0x53 W ACK, E21, B22 0x05 NACK, E39, B43 0x53 R ACK, E60, B61 0x81 NACK, E78, E80",
        ),
        ([START, bits(0xA6, 1), bits(0x05, 1, 4)], "B2 0x53 W, B4 0x53 W ACK, E21, B22 cut off: 0000, E29, E29"),
        ([START, bits(0xA6, 1), bits(0x41, 1)], "B2 0x53 W, B4 0x53 W ACK, E21, B22 0x41 ACK, E39, E39"),
        ([START, bits(0xA6, 1, 8)], "B2 0x53 W, B4 0xA6 no ninth bit, E19, E19"),
        ([START, bits(0xA6, 1, 3), STOP], "B2 cut off, B4 cut off: 101, E9, E11"),
        ([START, STOP, START, bits(0xA6, 0), STOP], "B2 cut off, E5, B8 0x53 W, B10 0x53 W NACK, E27, E29"),
    ],
)
def test_transfers_are_slices_around_their_bytes(tmp_path: Path, parts: list[Wires], shown: str):
    """`shown` has the letter and the position of each event, and the name of each slice that begins."""
    scl, sda = ("".join(column) for column in zip(*parts, strict=True))
    rows = [
        (at * 100 * NS, Kind.EDGE, wire, "level", int(levels[at] == "-"))
        for at in range(1, len(scl))
        for wire, levels in (("SCL", scl), ("SDA", sda))
        if levels[at] != levels[at - 1]
    ]
    path = written(tmp_path / "run.perfetto.json", *rows, end=len(scl) * 100 * NS)
    events = by_track(events_of(path))["bus", "transfers"]
    begun: list[str] = []
    for event in events:
        (begun.append if event["ph"] == "B" else begun.remove)(event["name"])
    at = [f"{event['ph']}{event['args']['tick'] / 100 / NS:g}" for event in events]
    names_of = [f" {event['name']}" * (event["ph"] == "B") for event in events]
    assert (", ".join(map("".join, zip(at, names_of, strict=True))), begun) == (shown, [])


def test_a_capture_cannot_be_written_as_a_run(tmp_path: Path):
    capture = formats.read(Path(__file__).resolve().parents[3] / "traces" / "nack.sr")
    with pytest.raises(formats.BadCapture, match=r"its name: found '\.json', expected one of "):
        formats.write(capture, tmp_path / "x.perfetto.json")
