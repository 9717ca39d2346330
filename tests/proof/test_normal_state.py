"""Normal form of states: values that it leaves out have no effect on later records.

snapshot --> scene A                                       .--> records of A
         '-> scene B, with other values that are left out   +--> records of B: equal
"""

from __future__ import annotations

from collections.abc import Callable
from random import Random

import pytest

from periph_sim.core.agent import Agent, Event
from periph_sim.core.chip import NEVER
from periph_sim.core.records import RECORDED, Record
from periph_sim.core.snapshot import Module, Snapshot
from periph_sim.core.state import State, Time, state_of
from periph_sim.f28335.sci.clock import SciClock
from periph_sim.proof.normal_state import LONG_PAST, NormalCollector
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import Case
from periph_sim.scene.scene import Scene
from periph_sim.scene.state import modules_of
from tests.scene.runs import TIMING

# Images, the changes of their cases, and the ms within which they are compared.
IMAGES = {
    "variants/image_register_slave": ([], 45),
    "variants/image_sci_echo": (['host.motion={kind="static"}'], 45),
    "imu_hil_image": (['host.motion={kind="static"}'], 110),
    "variants/image_blink": ([], 12),
    "variants/image_eeprom": ([], 20),
    "variants/image_rtc": ([], 12),
}
# Numbers that have an effect only by their difference from another number, which the normal form contains.
IN_PAIRS = ("routes_version", "out_version", "writes", "_tick", "_passes")
AHEAD = 25  # ms for which two scenes are compared


def case_of(name: str) -> Case:
    return load(TIMING / f"{name}.toml", IMAGES[name][0])


class Holder:
    """An object whose state is an event."""

    STATE = State("event")

    def __init__(self, event: Event) -> None:
        self.event = event


class LeftOut(NormalCollector):
    """Collector of values that the normal form leaves out: (name, object, attribute, True for an instant)."""

    def __init__(self, scene: Scene) -> None:
        self.found: list[tuple[str, object, str, bool]] = []
        per_second = scene.timebase.per_second
        cycles = max(int(dsp.clock.hz) for dsp in scene.units.values())
        self.past = {Time.TICKS: per_second // LONG_PAST, Time.CYCLES: cycles // LONG_PAST}
        super().__init__(modules_of(scene), scene.kernel.now, self.past, ())

    def attributes(self, name: str, target: object) -> None:
        super().attributes(name, target)
        state = state_of(type(target))
        assert state is not None
        for attribute in sorted(state.results):
            self.found.append((name, target, attribute, False))
        for attribute in sorted(state.expires):
            self._instant(name, target, attribute, state)

    def _instant(self, name: str, target: object, attribute: str, state: State) -> None:
        value, time = getattr(target, attribute, None), state.times[attribute]
        values = value if isinstance(value, list) else [value]
        if all(type(one) is int and self._is_long_past(one, time) for one in values):
            self.found.append((name, target, attribute, True))

    def _is_long_past(self, value: int, time: Time) -> bool:
        return abs(value) < NEVER and value < self.now[time] - self.past[time]


def change_left_out(scene: Scene, random: Random) -> set[str]:
    """Change all counters and instants that the normal form leaves out. Return the names of the changed attributes."""
    changed = set()
    for name, target, attribute, is_instant in LeftOut(scene).found:
        value = getattr(target, attribute, None)
        if is_instant and isinstance(value, list):
            setattr(target, attribute, [one - random.randrange(1, 10**7) for one in value])
        elif is_instant:
            setattr(target, attribute, value - random.randrange(1, 10**7))
        elif type(value) is int and attribute not in IN_PAIRS:
            setattr(target, attribute, value + random.randrange(1, 1000))
        else:
            continue
        changed.add(f"{name}.{attribute}")
    return changed


def records_of(case: Case, snapshot: Snapshot, change: Callable[[Scene], object]) -> list[tuple[object, ...]]:
    """Return the records that follow a snapshot, without their numbers, with ticks from the snapshot on."""
    records: list[Record] = []
    scene = Scene(case, lambda recorder, _: recorder.subscribe(RECORDED, records.append))
    scene.restore(snapshot)
    change(scene)
    since = scene.kernel.now
    scene.advance(since + AHEAD * scene.timebase.per_second // 1000)
    return [(one.tick - since, one.kind, one.where, one.what, one.value, one.text) for one in records]


@pytest.mark.parametrize("name", IMAGES)
def test_values_that_the_normal_form_leaves_out_have_no_effect(name: str):
    case, random = case_of(name), Random(name)
    until = IMAGES[name][1]
    instants = sorted(random.sample(range(5000, until * 1000), 8))
    changed: set[str] = set()
    scene = Scene(case, lambda recorder, _: recorder.subscribe(RECORDED, lambda record: None))
    for at in instants:
        scene.advance(scene.start + at * scene.timebase.per_second // 10**6)
        snapshot = scene.state()
        as_it_was = records_of(case, snapshot, lambda scene: None)
        assert records_of(case, snapshot, lambda scene: changed.update(change_left_out(scene, random))) == as_it_was
        assert as_it_was or name == "variants/image_rtc"
    assert len(changed) > 8


def test_only_a_running_clock_repeats():
    """A running clock of the SCI is equal after its period of 8 cycles, and a stopped one is equal in each cycle."""
    past = {Time.TICKS: 1000, Time.CYCLES: 1000}
    clock = SciClock()
    for is_running, equal, periods in ((False, [*range(17)], {}), (True, [0, 8, 16], {"clock._cycle": 8})):
        if is_running:
            clock.start(0)
        found = [NormalCollector({"clock": Module(clock, 5 + cycle)}, 0, past, ()) for cycle in range(17)]
        assert [cycle for cycle in range(17) if found[cycle].values == found[0].values] == equal
        assert found[0].periods == periods


def test_an_event_that_is_not_queued_has_no_time():
    """This also holds after an event that is queued was collected."""
    scene = Scene(case_of("variants/image_blink"))
    event = scene.kernel.event(Agent(), 0)
    past = {Time.TICKS: 1000, Time.CYCLES: 1000}

    def collected() -> object:
        return NormalCollector({"event": Module(Holder(event))}, scene.kernel.now, past, ()).values

    never_queued = collected()
    scene.kernel.reschedule(event, scene.kernel.now + 100, 0)
    queued = collected()
    scene.kernel.cancel(event)
    assert collected() == never_queued != queued
