"""Runs of groups: the results of a scene's run that are added to the table."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from periph_sim.core.records import Kind
from periph_sim.proof import pair_run
from periph_sim.proof.pair_groups import Group, GroupRun, Orbits
from periph_sim.proof.pair_run import Known, PairRun, Task
from periph_sim.proof.stretch import Outcome


def test_each_run_of_a_scene_is_judged(monkeypatch: pytest.MonkeyPatch):
    """Each run begins in another orbit and stays there. It breaks a budget of its own, which lasts and has no value."""
    runners: list[Any] = []

    def runner(*_: object) -> Any:
        at, frames = len(runners), [len(runners)]
        limits = [SimpleNamespace(budget=SimpleNamespace(name=f"{at}", coverage=1), measure=Lasting())]
        scene = SimpleNamespace(limits=limits, start=0)
        run = SimpleNamespace(scene=scene, now=0, frames=frames, rounds=[], data_use=f"use {at}")
        runners.append(SimpleNamespace(at=(at, 0), run=run, like=lambda group: group))
        runners[-1].run_group = lambda *_: frames.append(0) or GroupRun(at, 0, 0, 0, 0, 0, True)
        return runners[-1]

    class Lasting:
        series, measured, occasions = True, 0, None

        def unfinished(self, now: int) -> bool:
            return True

    def finish(scene: Any) -> Outcome:
        covered.unknowns.add(scene.limits[0].budget.name)
        return Outcome((), frozenset({scene.limits[0].budget.name}))

    covered: Any = SimpleNamespace(finish=finish, unknowns=set())
    monkeypatch.setattr(pair_run, "GroupRunner", runner)
    pair = PairRun(covered, (), Known(Orbits(), None, {}))
    pair._group(Group(None, 0))
    pair.reach(2)
    monkeypatch.setattr(pair_run, "CHUNK", 0)
    pair.run(Task(3, Group(None, 0), 0, None))
    pair.end()
    done, names = pair.done, {"0", "1", "2", "3"}
    assert [outcome.failures for outcome in done.outcomes] == [{name} for name in sorted(names)]
    assert (done.frames, done.rounds) == ([one.run.frames for one in runners], [[]] * 4)
    # on the way to orbit 2, a group like the last one and a new run are tried in turn
    assert list(map(len, done.frames)) == [1 + 2, 1 + 1, 1, 1 + 1]
    assert done.spanning == done.unknowns == {name for _, name in done.empty} == names
    assert done.data_use == "use 0"


def test_groups_of_two_orbits_are_run_in_turn_if_each_group_leads_to_the_other_orbit(monkeypatch: pytest.MonkeyPatch):
    """The groups 0 to 2 start from orbit 0, and the groups 3 to 5 from orbit 1. The length of a run is its group."""
    begun: list[int] = []

    def run_group(group: Group, *_: object) -> GroupRun:
        assert group.round is not None
        begun.append(group.round)
        runner.at = (1 - runner.at[0], 0)
        return GroupRun(runner.at[0], 0, 0, 0, 0, group.round, True)

    run = SimpleNamespace(scene=SimpleNamespace(limits=[], start=0), now=0, frames=[], rounds=[])
    runner: Any = SimpleNamespace(at=(0, 0), run=run, run_group=run_group)
    monkeypatch.setattr(pair_run, "GroupRunner", lambda *_: runner)
    covered: Any = SimpleNamespace()
    tasks = [Task(int(number > 2), Group(number, None), 0, None) for number in range(6)]
    runs = PairRun(covered, (), Known(Orbits(), None, {})).run_all(tasks)
    assert begun == [0, 3, 1, 4, 2, 5]
    assert [one.length for one in runs] == [*range(6)]


def test_the_measures_rest_after_a_round_a_frame_or_both(monkeypatch: pytest.MonkeyPatch):
    """A frame can lead to records of the firmware before the next START, so only the bus is idle until then."""
    after_start: list[list[Kind]] = []
    rests: list[tuple[int, list[str]]] = []
    measures = SimpleNamespace(spanning={"long"}, lacking={"few"}, empty=set())
    measures.rest, measures.finish = lambda now, starts: rests.append((now, [*starts])), lambda verdicts: None
    monkeypatch.setattr(pair_run, "MeasuresAtRest", lambda _, kinds: after_start.append(kinds) or measures)
    run = SimpleNamespace(scene=SimpleNamespace(limits=[], start=0), now=5, frames=[], rounds=[], data_use="")
    runner: Any = SimpleNamespace(at=(0, 0), run=run, run_group=lambda *_: GroupRun(0, 0, 0, 0, 0, 0, True))
    monkeypatch.setattr(pair_run, "GroupRunner", lambda *_: runner)
    covered: Any = SimpleNamespace(finish=lambda scene: Outcome((), frozenset()), unknowns=set())
    pair = PairRun(covered, (), Known(Orbits(), None, {}))
    pair.run_all([Task(0, group, 0, None) for group in (Group(0, None), Group(None, 0), Group(0, 0))])
    assert rests == [(5, ["rounds", "frames"]), (5, ["rounds"]), (5, ["frames"]), (5, ["rounds", "frames"])]
    assert after_start == [[Kind.BUS]]
    pair.end()
    assert (pair.done.spanning, pair.done.lacking) == ({"long"}, {"few"})
