"""The event chain of an occurrence: which records belong to it, depending on its measure, and how each is named."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import pytest

from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.time import Timebase
from periph_sim.interfaces.reports.baselines import event_chain
from periph_sim.interfaces.reports.baselines.compare import compare
from periph_sim.interfaces.reports.baselines.event_chain import (
    PART,
    EventDigests,
    EventLine,
    Wanted,
    chains,
    first_divergence,
    first_moved,
)
from periph_sim.interfaces.reports.baselines.files import read
from periph_sim.interfaces.reports.baselines.outcome import Outcome, run_case
from periph_sim.scene.project import baseline_path
from tests.scene.runs import TIMING

TIMEBASE = Timebase()
US = TIMEBASE.ticks(Fraction(1, 10**6), "nearest")
BEGIN = 7 * US  # the begin of the run
CASE: Any = SimpleNamespace(duration=Fraction(30, 1000))

#            S   byte  W I  F   i  R  P   S   P   S           P       microseconds after the begin of the run
# ___________|___|_____|_|__|___|__|__|___|___|___|___________|____
#            100 150   160  180 190   200 300 400 500         20000
RECORDS = [
    (100, Kind.BUS, "head", "START", 0, ""),
    (150, Kind.BUS, "head", "byte", 5, "53"),
    (160, Kind.ACCESS, "dsp", "W I2C-A.I2CDXR", 5, "answer:12"),
    (170, Kind.IRQ, "dsp", "SCIRXINTA", 1, ""),
    (180, Kind.SPAN, "dsp", "model", 1, ""),
    (190, Kind.IRQ, "dsp", "SCIRXINTA", 0, ""),
    (195, Kind.ACCESS, "dsp", "R I2C-A.I2CSTR", 5, "wait:3"),
    (200, Kind.BUS, "head", "STOP", 0, ""),
    (300, Kind.BUS, "head", "START", 0, ""),
    (400, Kind.BUS, "head", "STOP", 0, ""),
    (500, Kind.BUS, "head", "START", 0, ""),
    (20_000, Kind.BUS, "head", "STOP", 0, ""),
]
SHORT = {
    "START on the bus": "S",
    "byte 53 on the bus": "b",
    "I2C-A.I2CDXR written by dsp": "W",
    "SCIRXINTA entered by dsp": "I",
    "SCIRXINTA left by dsp": "i",
    "model begun by dsp": "F",
    "STOP on the bus": "P",
    "SCL rise of the first data bit": "r",
}


@pytest.fixture
def lengths(monkeypatch: pytest.MonkeyPatch) -> list[Fraction]:
    """Return the list of lengths of the runs that are made. Each run emits the records above."""
    ran: list[Fraction] = []

    class RecordedScene:
        timebase, start = TIMEBASE, BEGIN

        def __init__(self, case: object, subscribe: Callable[[Any, Timebase], None]) -> None:
            def kept(kinds: tuple[Kind, ...], keep: Callable[[Record], None]) -> None:
                assert {record[1] for record in RECORDS} <= {*kinds}
                self.keep = keep

            subscribe(SimpleNamespace(subscribe=kept), TIMEBASE)

        def run(self, length: Fraction) -> None:
            ran.append(length)
            for number, (at, *rest) in enumerate(RECORDS, 1):
                self.keep(Record(number, BEGIN + at * US, *rest, 0))

    monkeypatch.setattr(event_chain, "Scene", RecordedScene)
    return ran


def chain(measure: str, at: int, length: int) -> str:
    (found,) = chains(CASE, {"it": Wanted(measure, at * US, length * US)}).values()
    lines = [line.partition(" ") for line in found.lines]
    return " ".join(f"{SHORT[event]}{int(ticks) / US:g}" for ticks, _, event in lines)


@pytest.mark.parametrize(
    ("measure", "at", "length", "drawn"),
    [
        ("response", 150, 35, "S0 b50 W60 I70 F80 r85"),  # from the last START before it
        ("response", 90, 20, "S10 r20"),  # without a START before it, from its instant
        ("response", 300, 5, "S0 r5"),
        ("response", 350, 5, "S0 r55"),
        ("response", 5500, 10, "S0 r5010"),
        ("response", 5501, 10, "r10"),  # the last START is more than 5 ms before it
        ("age", 200, 100, "S0 I70 F80 i90 P100"),  # its instant is its end
        ("model age", 200, 30, "I0 F10 i20 P30"),
        ("fifo high-water", 200, 0, "S4900 I4970 F4980 i4990 P5000"),
        ("overruns", 5170, 0, "I0 F10 i20 P30 S130 P230 S330"),
        ("round", 100, 100, "S0 I70 F80 i90 P100"),
        ("round", 190, 19_810, "i0 P10 S110 P210 S310 P19810"),
        ("span: model", 160, 25, "W0 I10 F20"),
        ("stretch", 150, 5, "b0 W10 I20 F30 i40 P50"),  # to the STOP after it
        ("stretch", 200, 5, "P0"),
        ("stretch", 450, 5, "S50"),  # or 5 ms without a STOP
    ],
)
def test_a_chain_has_the_events_of_its_occurrence(
    lengths: list[Fraction], measure: str, at: int, length: int, drawn: str
):
    assert chain(measure, at, length) == drawn


def test_events_of_firmware_have_their_place(lengths: list[Fraction]):
    (found,) = chains(CASE, {"it": Wanted("span: model", 150 * US, 25 * US)}).values()
    assert [place.partition(" ")[0] for place in found.places] == ["", "answer:12", ""]


@pytest.mark.parametrize(("at", "run"), [(150, "5.19"), (22_000, "27.04"), (27_000, "30")])
def test_the_run_ends_5_ms_after_the_last_occurrence_or_with_the_case(lengths: list[Fraction], at: int, run: str):
    chains(CASE, {"first": Wanted("round", 10 * US, 20 * US), "last": Wanted("response", at * US, 40 * US)})
    assert lengths == [Fraction(run) / 1000]


def test_without_a_wanted_chain_nothing_is_run(lengths: list[Fraction]):
    assert chains(CASE, {}) == {} and lengths == []


def test_a_chain_has_32_events_at_most_and_a_response_its_end(lengths: list[Fraction], monkeypatch: pytest.MonkeyPatch):
    many = [(100 + n, Kind.IRQ, "dsp", "SCIRXINTA", 1, "") for n in range(50)]
    monkeypatch.setitem(globals(), "RECORDS", many)
    assert chain("round", 100, 100).split() == [f"I{n}" for n in range(32)]
    assert chain("response", 100, 100).split() == [*(f"I{n}" for n in range(31)), "r100"]


START, WRITE, ENTER = "START gyroscope on the bus", "I2C-A.I2CDXR written by dsp", "SCIRXINTA entered by dsp"


# before, now: "S0 W5" is a START after 0 cycles and a write after 5; I is an interrupt's entry.
@pytest.mark.parametrize(
    ("before", "now", "wanted"),
    [
        ("", "", ""),
        ("S0 W5", "S0 W5", ""),
        ("S0 W5", "S0 W19", f"{WRITE} 14 cycles later"),
        ("S0 W5", "S0 W4", f"{WRITE} 1 cycle earlier"),
        ("S0 W5 I7", "S0 W9 I11", f"{WRITE} 4 cycles later"),
        ("S0 W5 I7", "S0 I7 W9", f"{WRITE} 4 cycles later"),
        ("S0 W5 I9", "S0 W6 I20", f"{ENTER} 11 cycles later; first to differ: {WRITE} 1 cycle later"),
        ("S0 W5", "S0 I3 W9", f"{WRITE} 4 cycles later; first to differ: {ENTER} after 3 cycles, which is new"),
        ("S1 W5 I9", "W6 S12 I30", f"{ENTER} 21 cycles later; first to differ: {START} 11 cycles later"),
        ("S0 W5", "S0 W5 W8", f"{WRITE} after 8 cycles, which is new"),
        ("S0 W5", "S0", f"{WRITE} is missing, which was after 5 cycles"),
        ("S0 W0", "S0", f"{WRITE} is missing, which was after 0 cycles"),
    ],
)
def test_the_first_divergence_is_described(before: str, now: str, wanted: str):
    assert first_divergence(lines(before), lines(now), str) == wanted


def lines(drawn: str) -> list[str]:
    names = {"S": START, "W": WRITE, "I": ENTER}
    return [f"{event[1:]} {names[event[0]]}" for event in drawn.split()]


@pytest.mark.parametrize(
    ("before", "now", "wanted"),
    [
        ("S0 W5", "S0 W7", ""),  # within the tolerance of two
        ("S0 W5", "S0 W3", ""),
        ("S0 W5", "S0 W8", f"{WRITE} 3 cycles later [f:1]"),
        ("S0 W5", "S0 W2", f"{WRITE} 3 cycles earlier [f:1]"),
        ("S0 W5 I9", "S0 W8 I20", f"{WRITE} 3 cycles later [f:1]"),
        ("S1 W5 I9", "W8 S12 I9", f"{START} 11 cycles later [f:1]"),
        ("S0 W5 W6", "S0 W6 W10", f"{WRITE} 4 cycles later [f:2]"),
        ("S0 W5", "S0 W5 W6", f"{WRITE} after 6 cycles, which is new [f:2]"),
        ("S0 W5", "S0 W5 W6 W7", f"{WRITE} after 6 cycles, which is new [f:2]"),
        ("S0 W5 I6", "S0 W5", f"{ENTER} is missing, which was after 6 cycles"),
    ],
)
def test_the_first_event_that_moved_beyond_the_tolerance_is_named_with_its_place(before: str, now: str, wanted: str):
    chain = EventLine(lines(now), ["", "f:1", "f:2", "f:3"])
    assert first_moved(lines(before), chain, str, 2) == wanted


def digests(values: list[int], start: int = 0) -> list[str]:
    recorder = Recorder()
    sent = EventDigests(Fraction(0))
    sent.subscribe(recorder, Timebase())
    for number, value in enumerate(values):
        recorder.emit(start + number, Kind.BUS, "bus", "START", 0)
        recorder.emit(start + number, Kind.BUS, "bus", "byte", value)
    return sent.bus_bytes


def test_digests_of_bus_bytes_depend_on_values_and_not_on_times():
    values = [*range(3 * PART)]
    assert digests(values) == digests(values, start=1000) and len(digests(values)) == 3
    assert len(digests(values[:-1])) == 3 and digests([]) == []


@pytest.mark.parametrize("place", [0, PART - 1, PART, 2 * PART + 5])
def test_digests_differ_from_the_part_with_the_first_other_byte_on(place: int):
    values = [*range(3 * PART)]
    other = [*values[:place], values[place] ^ 1, *values[place + 1 :]]
    same = [one == two for one, two in zip(digests(values), digests(other), strict=True)]
    assert same == [part < place // PART for part in range(3)]


@pytest.mark.parametrize("change", [None, "unit.imu.settings.noise_seed=2", "host.motion.angles.0.amplitude='31 deg'"])
def test_a_check_of_two_dsps_finds_data_that_differ_but_are_correct(change: str | None):
    """With other noise or another motion, the bytes are correct at the same times, but differ from the baseline's."""
    path = TIMING / "two_dsps.toml"
    kept = read(baseline_path(path))
    assert kept is not None and len(kept.bus_bytes) == -(-kept.counts["I2C bytes"] // PART)
    outcome = run_case(path, () if change is None else (change,), False)
    assert isinstance(outcome, Outcome) and outcome.result.verdict == "pass"
    changes = [str(found) for found in compare(kept, outcome.figures) if not found.note]
    where = "first among bytes 1 to 64 of the run"
    expected = [f"bytes on the bus differ from the baseline, {where}"]
    assert changes == ([] if change is None else expected)
    assert outcome.figures.digest == kept.digest  # it covers times only
