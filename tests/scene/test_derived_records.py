"""Derived records of a scene: each is produced if a budget needs it, and refused if no part of the scene has it."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection
from fractions import Fraction
from functools import cache
from typing import Any

import pytest

from periph_sim import BadCase, Case, Dsp, Scene, load
from periph_sim.core.time import NO_TIME
from periph_sim.devices.host_frames import host_frames
from periph_sim.scene import derived_records
from periph_sim.timing.budget_schema import Budget
from periph_sim.timing.derived import error_records
from periph_sim.timing.derived.origins import FrameOrigins, Origin
from periph_sim.timing.language.scope import RECORDS
from periph_sim.timing.measures.registry import MEASURES
from tests.scene.absent import HEAD, HOST, IMU, LOGGER
from tests.scene.runs import TIMING, run_file
from tests.scene.small import case, scene_with
from tests.timing.events_by_hand import make

BUDGET = 'budget=[{{name = "one", measure = "{}", max = {}}}]'


@pytest.mark.parametrize(
    ("measure", "limit", "count"),
    [
        (
            "value error of accelerometer",
            '"60 LSB"',
            3,
        ),  # one in each of three rounds, after the frames at 4, 24 and 44 ms
        ("value error of magnetometer at frame", '"20 LSB"', 3),
        ("model age", '"22 ms"', 9),  # three chips
        ("response", '"1 ms"', 9),
        ("round", '"3 ms"', 3),
    ],
)
def test_occurrences_are_recorded(measure: str, limit: str, count: int):
    (verdict,) = run_file("imu_moving", "0.05", BUDGET.format(measure, limit)).result.budgets
    assert verdict.count == count


def alone(measure: str, limit: object, module: str = "I2C-A") -> Case:
    """Return a case of one unit alone, with one budget."""
    unit = {"firmware": "responder", "modules": [module]}
    budget = {"name": "b", "measure": measure, "max": limit}
    return Case.model_validate({"name": "alone", "duration": "1 ms", "unit": {"dsp": unit}, "budget": [budget]})


@pytest.mark.parametrize("measure", MEASURES)
def test_every_measure_says_what_it_needs(measure):
    kind = make(measure)
    limit = "1 ms" if kind.unit == "time" else 0
    lacking = alone(measure, limit, "GPIO" if kind.needs == "I2C-A" else "I2C-A")
    needs = "[controller], or [rounds] for a unit that is the master," if kind.needs == "rounds" else kind.needs
    with pytest.raises(BadCase, match=re.escape(f"'{measure}' needs {needs} in the scene, which has none")):
        Scene(lacking)


def test_a_span_needs_nothing_but_its_firmware():
    assert Scene(alone("span:model", "1 ms")).run().verdict == "fail"  # it was never measured


HELD = {"kind": "hold", "wire": "SDA", "at": "1 ms"}
TO_STUCK = {"name": "to stuck", "measure": "from edge SDA fall to bus stuck", "max": "25 ms"}
COUNT = {"name": "stuck", "measure": "count of bus stuck", "max": 0}


def idle(dsp: Dsp) -> None:
    pass


def ran(length: str, budgets: list[dict[str, Any]], **more: Any):
    fault = [HELD | {"length": length}]
    scene = scene_with(idle, ["I2C-A"], fault=fault, budget=budgets, duration="100 ms", **more)
    return scene.run(Fraction(1, 10))


@pytest.mark.parametrize(("length", "count"), [("24.9 ms", 0), ("25.1 ms", 1), ("60 ms", 1)])
def test_a_held_line_is_an_event_without_a_controller(length: str, count: int):
    (stuck,) = ran(length, [COUNT]).budgets
    assert stuck.worst == count


def test_the_event_has_the_instant_at_which_the_line_has_been_low_too_long():
    (to_stuck,) = ran("60 ms", [TO_STUCK]).budgets
    assert (to_stuck.worst, to_stuck.at_s) == (25000.0, pytest.approx(0.001))


def test_rounds_of_a_master_set_how_long_a_line_may_be_low():
    request = {"name": "read", "address": 0x50, "count": 1}
    rounds = {"period": "20 ms", "stuck_after": "5 ms", "request": [request]}
    (to_stuck,) = ran("10 ms", [TO_STUCK], rounds=rounds).budgets
    assert to_stuck.worst == 5000.0


def test_the_event_and_the_measure_count_the_same():
    event, measure = ran("60 ms", [COUNT, {"name": "measure", "measure": "stuck", "max": 0}]).budgets
    assert event.worst == measure.worst == 1


THINGS = {f"{kind} {name}": thing for kind, things in RECORDS.items() for name, thing in things.items()}
NINE = {"time": "9 s", "LSB": "9 LSB"}  # a limit of values, by their unit

Values = list[tuple[int, int]]  # pairs (value, tick)


class NotAllCompared(FrameOrigins):
    """Origins that leave samples of ff ff ... not judged."""

    def __init__(self) -> None:
        super().__init__(host_frames())

    def origin(self, address: int, got: bytes) -> Origin:
        return Origin(None, NO_TIME, bytes(6), judged=False) if got[0] == 0xFF else super().origin(address, got)


def no_set_up(monkeypatch: pytest.MonkeyPatch) -> None:
    pass


def not_all_compared(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(derived_records, "_origins_of", lambda scene: NotAllCompared())


def one_frame_stored(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(error_records, "MOST", 1)


FIXED = "unit.dsp.settings.table={'0x68'='ff ff ff ff ff ff', '0x53'='00 00 00 00 00 00', '0x1e'='12 34 56 12 34 56'}"
# Runs that together have every derived record: the case, its length in seconds, changes, and a set-up function.
RUNS: dict[str, tuple[str, str, list[str], Callable[[pytest.MonkeyPatch], None]]] = {
    "rounds of an emulator": ("imu_hil_published", "0.07", [], no_set_up),
    "a run that ends in the first transfer": ("imu_hil_published", "0.0053", [], no_set_up),
    "bytes that are not the host's": ("imu_hil_published", "0.25", [FIXED], not_all_compared),
    "samples that fit an old frame": ("imu_moving", "0.1", [], one_frame_stored),
    "characters that are not read": ("imu_hil_published", "0.1", ["unit.dsp.settings.fifo_level=31"], no_set_up),
    "a slave that holds SCL": ("forum/interrupt_once", "0.05", [], no_set_up),
    "requests to other addresses": ("any_order_strays", "0.07", [], no_set_up),
}


def values_of(run: str, names: Collection[str]) -> dict[str, Values]:
    """Return the values of the records of these names, each as its own budget sees them."""
    file, seconds, changes, before = RUNS[run]
    budgets = [
        Budget(name=name, measure=f"value of record {name}", max=NINE.get(THINGS[name].unit, 9)) for name in names
    ]
    tables = load(TIMING / f"{file}.toml", changes).model_copy(update={"budget": tuple(budgets), "breaks": ()})
    with pytest.MonkeyPatch.context() as monkeypatch:
        before(monkeypatch)
        scene = Scene(tables, keep_values=True)
        scene.run(Fraction(seconds))
    found = {limit.budget.name: limit.values(scene.start) for limit in scene.limits}
    return {
        name: [] if values is None else list(zip(values.values.tolist(), values.at.tolist(), strict=True))
        for name, values in found.items()
    }


@cache
def beside_all_others(run: str) -> dict[str, Values]:
    """Return the values of all records that the case of a run can have."""
    lacking = () if load(TIMING / f"{RUNS[run][0]}.toml").host is not None else ("host", "SCI")
    return values_of(run, [name for name, thing in THINGS.items() if thing.needs not in lacking])


@pytest.mark.parametrize("name", THINGS)
def test_a_budget_on_one_record_gives_the_same_beside_budgets_on_all_others(name: str):
    occurs = False
    for run in RUNS:
        beside = beside_all_others(run)
        if name in beside:
            assert values_of(run, [name])[name] == beside[name], run
            occurs |= bool(beside[name])
    assert occurs, "it occurs in none of the runs, so nothing was compared"


@pytest.mark.parametrize("name", ["value error", "value error at frame", "unknown error"])
def test_errors_of_models_need_a_motion_whatever_a_budget_does_with_them(name: str):
    budget = {"name": "b", "measure": f"count of record data {name}", "max": 0}
    tables = {"unit": {"dsp": IMU | {"pins": {"MODEL": 34}}}, "controller": HEAD | {"period": "20 ms"}, "host": HOST}
    sentence = f"'count of record data {name}' of sensor models needs a motion to compare with; give [host.motion]"
    with pytest.raises(BadCase, match=re.escape(f"budget.b.measure: {sentence}")):
        Scene(case(**tables, budget=[budget]))


@pytest.mark.parametrize("name", THINGS)
def test_a_span_to_a_record_that_a_scene_cannot_have_is_not_judged(name: str):
    budget = {"name": "b", "measure": f"from span x begin to record {name}", "max": "1 s"}
    (verdict,) = Scene(case(unit={"dsp": LOGGER}, budget=[budget])).run().budgets
    assert verdict.verdict == "not judged"


@pytest.mark.parametrize("name", ["held alone", "unfinished"])
def test_a_hold_of_scl_needs_a_module_that_can_hold_it(name: str):
    budget = {"name": "b", "measure": f"count of record transfer {name}", "max": 0}
    with pytest.raises(BadCase, match=f"'count of record transfer {name}' needs I2C-A in the scene, which has none"):
        Scene(case(unit={"dsp": LOGGER}, budget=[budget]))
