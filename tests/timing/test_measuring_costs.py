"""Costs of measuring, in records and events: a budget causes only the records that it needs."""

from __future__ import annotations

from collections import Counter

import pytest

from periph_sim import Scene, load
from periph_sim.core.records import Kind, Recorder
from periph_sim.core.time import Timebase
from periph_sim.timing.measures.factory import measure_named
from periph_sim.timing.measures.registry import MEASURES, PHRASES
from tests.scene.runs import TIMING, run_case
from tests.timing.events_by_hand import ONE

CASE = load(TIMING / "imu_hil_published.toml")
SECONDS = "0.1"


def made(measure: str, **limit: object) -> tuple[Counter[str], int]:
    """Return the records that a run with one budget makes, counted by kind and place, and its number of events."""
    budget = CASE.budget[0].model_copy(update={"name": "one", "measure": measure, **limit})
    case = CASE.model_copy(update={"budget": [budget]})
    seen: Counter[str] = Counter()

    def subscribe(recorder: Recorder, timebase: Timebase) -> None:
        for kind in [kind for kind in Kind if recorder.wants(kind)]:
            subjects = recorder.subjects(kind)
            recorder.subscribe(
                [kind],
                lambda r: seen.update([f"{r.kind.value} {r.where} {r.what}"]),
                None if subjects is None else {kind: subjects},
            )

    return seen, run_case(case, SECONDS, subscribe).result.events


@pytest.mark.parametrize("name", [*MEASURES, "slack", "gap between rounds", "reaction", "interrupt latency SCIRXINTA"])
def test_the_cost_of_a_measure_is_its_number_of_records(name: str):
    measure = measure_named(name, ONE)
    limit = {"max": None, "min": None, "exactly": "0 us" if measure.unit == "time" else 0}
    seen, _ = made(name, **limit)
    of_measure = [count for key, count in seen.items() if any(_is(key, *one) for one in measure._wanted)]
    assert sum(of_measure) == (MEASURES.get(name) or PHRASES[name.split()[0]]).cost


def _is(key: str, kind: Kind, what: str) -> bool:
    return key.startswith(f"{kind.value} ") and key.endswith(f" {what}")


def plain_events(*disable: str) -> int:
    scene = Scene(CASE.model_copy(update={"budget": [], "disable": disable}))
    return run_case(scene.case, SECONDS).result.events


@pytest.mark.parametrize(
    ("measure", "places"),
    [
        ("from edge MODEL rise to edge MODEL fall", {"edge MODEL level"}),
        ("period of edge SCL fall", {"edge SCL level"}),
        ("period of edge SDA fall", {"edge SDA level"}),
        ("from bus STOP to bus START", {"bus controller"}),
        ("period of access W I2C-A.I2CDXR", {"access dsp W I2C-A.I2CDXR"}),
    ],
)
def test_only_needed_records_are_made_and_no_event_is_added(measure: str, places: set[str]):
    seen, events = made(measure)
    assert seen and {key for key in seen if not any(key.startswith(place) for place in places)} == set()
    assert events == (plain_events("bits") if " edge S" in measure else plain_events())  # no edge is skipped


def test_only_flags_of_one_register_are_recorded():
    seen, events = made("from flag I2C-A.I2CSTR.AAS rise to flag I2C-A.I2CSTR.SDIR rise")
    assert all(key.startswith("flag dsp.I2C-A I2CSTR.") for key in seen)
    assert events == plain_events()
