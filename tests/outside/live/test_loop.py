"""The loop step by step: its calls to a session, a pacer and doors, and their order."""

from __future__ import annotations

from typing import Any

import pytest

from periph_sim.outside.live.loop import Loop


class Session:
    """A session that logs the ticks to which it is advanced."""

    def __init__(self, calls: list[str]) -> None:
        self.now = 0
        self._calls = calls

    def ticks(self, length: str) -> int:
        return {"1 ms": 1000, "0 s": 0}[length]

    def advance(self, until: int) -> None:
        self._calls.append(f"advance {until}")
        self.now = until


class Pacer:
    """A pacer whose `wait` returns each of `lefts` in turn, and then 0."""

    def __init__(self, calls: list[str], lefts: list[float]) -> None:
        self._calls, self._lefts = calls, lefts

    def wait(self, tick: int) -> float:
        self._calls.append(f"wait {tick}")
        return self._lefts.pop(0) if self._lefts else 0.0

    def reached(self, tick: int) -> None:
        self._calls.append(f"reached {tick}")


class Door:
    """A door that calls one of `moves` in each turn, in order."""

    def __init__(self, calls: list[str], number: int, moves: list[Any]) -> None:
        self._calls, self._number, self._moves = calls, number, moves

    def files(self) -> list[int]:
        return [self._number]

    def turn(self) -> None:
        self._calls.append("turn")
        if self._moves:
            self._moves.pop(0)()


def made(*moves: Any, lefts: tuple[float, ...] = (), step: str = "1 ms") -> tuple[list[str], Session, Loop]:
    calls: list[str] = []
    session = Session(calls)
    return calls, session, Loop(session, Pacer(calls, [*lefts]), [Door(calls, 7, [*moves])], step)  # type: ignore[arg-type]


def test_each_step_waits_turns_and_advances_and_the_last_one_is_shorter() -> None:
    calls, _, loop = made()
    loop.run(2500)
    steps = [f"wait {at}, turn, advance {at}, reached {at}" for at in (1000, 2000, 2500)]
    assert ", ".join(calls) == ", ".join([*steps, "turn"])
    calls, _, loop = made(step="0 s")
    loop.run(2)
    steps = [f"wait {at}, turn, advance {at}, reached {at}" for at in (1, 2)]
    assert ", ".join(calls) == ", ".join([*steps, "turn"]), "a step is one tick at least"


def test_a_door_may_advance_time_and_stop_the_loop() -> None:
    calls, session, loop = made(lambda: setattr(session, "now", 1000), lambda: None, lambda: loop.stopped.set())
    loop.run()
    assert ", ".join(calls) == (
        "wait 1000, turn, reached 1000, wait 2000, turn, advance 2000, reached 2000, "
        "wait 3000, turn, advance 3000, reached 3000, turn"
    )


def test_input_of_a_door_ends_the_wait(monkeypatch: pytest.MonkeyPatch) -> None:
    """Input comes once; its turn advances to 1500, so the loop then waits for that tick."""
    asked: list[tuple[list[int], float]] = []

    def select(files: list[int], _: object, __: object, left: float) -> tuple[list[int], list[int], list[int]]:
        asked.append((files, left))
        return files if len(asked) == 1 else [], [], []

    monkeypatch.setattr("periph_sim.outside.live.loop.select.select", select)
    calls, session, loop = made(lambda: setattr(session, "now", 1500), lefts=(0.5, 0.25))
    loop.run(1000)
    assert asked == [([7], 0.5), ([7], 0.25)]
    assert ", ".join(calls) == "wait 1000, turn, wait 1500, wait 1500, turn, reached 1500, turn"


def test_a_stopped_loop_does_not_wait(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("periph_sim.outside.live.loop.select.select", lambda files, *_: (files, [], []))
    calls, _, loop = made(lambda: loop.stopped.set(), lefts=(0.5, 0.5, 0.5))
    loop.run(1000)
    assert ", ".join(calls) == "wait 1000, turn, wait 1000, turn, advance 1000, reached 1000, turn"


def test_without_files_the_loop_sleeps_because_select_refuses_that_on_windows(monkeypatch: pytest.MonkeyPatch) -> None:
    slept: list[float] = []
    monkeypatch.setattr("periph_sim.outside.live.loop.time.sleep", slept.append)
    monkeypatch.setattr("periph_sim.outside.live.loop.select.select", None)
    monkeypatch.setattr(Door, "files", lambda door: [])
    calls, _, loop = made(lefts=(0.5,))
    loop.run(1000)
    assert slept == [0.5]
    assert ", ".join(calls) == "wait 1000, wait 1000, turn, advance 1000, reached 1000, turn"
