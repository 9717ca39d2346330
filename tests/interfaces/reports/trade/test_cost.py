"""CPU times: what is counted, and when repeating ends."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction
from itertools import count
from pathlib import Path
from typing import Any

import pytest

from periph_sim.interfaces.reports.trade import trade
from periph_sim.interfaces.reports.trade.trade import FEWEST, MOST, PATIENCE, Cost, are_apart, costs_of
from periph_sim.scene.case.load import load

CASE = load(Path(__file__).resolve().parents[4] / "timing" / "responder.toml")
ROWS = {"slow": (CASE, ""), "quick": (CASE, ".psr")}


def costs(
    monkeypatch: pytest.MonkeyPatch, slow: float, quick: float, jitter: float, each_s: float = 0.0
) -> dict[str, Cost]:
    """Costs of two rows whose runs take so long, more or less, while a run lets this much CPU time pass."""
    number = count()

    def cpu_s(case: object, record: str, start: Fraction, length: Fraction) -> float:
        return (quick if record else slow) + jitter * (-1) ** (next(number) // 2)

    clock = count(0, each_s)
    monkeypatch.setattr(trade, "_cpu_s", cpu_s)
    monkeypatch.setattr(trade, "process_time", lambda: float(next(clock)))
    return costs_of(ROWS, Fraction(1, 100), Fraction(2, 100))


def test_rows_that_are_apart_are_not_repeated(monkeypatch: pytest.MonkeyPatch):
    found = costs(monkeypatch, slow=2.0, quick=1.0, jitter=0.1)
    assert {name: cost.runs for name, cost in found.items()} == {"slow": FEWEST, "quick": FEWEST}
    assert found["slow"].cpu_s == pytest.approx(2.1) and found["slow"].spread_s == pytest.approx(0.2 / FEWEST**0.5)
    assert found["quick"].is_below(found["slow"]) and not found["slow"].is_below(found["quick"])


def test_rows_that_differ_by_less_than_their_spread_are_repeated(monkeypatch: pytest.MonkeyPatch):
    found = costs(monkeypatch, slow=1.01, quick=1.0, jitter=0.1)
    assert {cost.runs for cost in found.values()} == {MOST} and not are_apart([*found.values()])


def test_repeating_ends_when_it_has_taken_long(monkeypatch: pytest.MonkeyPatch):
    found = costs(monkeypatch, slow=1.0, quick=1.0, jitter=0.1, each_s=PATIENCE * 0.6)
    assert {cost.runs for cost in found.values()} == {FEWEST + 1}


class Scene:
    """Notes what is done to it."""

    start = 7

    def __init__(self, done: list[str]) -> None:
        self.timebase = self
        self._done = done

    def ticks(self, seconds: Fraction, rounding: str) -> int:
        return int(seconds * 1000)

    def advance(self, until: int) -> None:
        self._done.append(f"advance to {until}")

    def run(self, length: Fraction) -> None:
        self._done.append(f"run {length}")


def test_set_up_and_start_are_not_counted_and_writing_a_recording_is(monkeypatch: pytest.MonkeyPatch):
    done: list[str] = []

    @contextmanager
    def built(case: object, record: str) -> Iterator[Any]:
        done.append("build")
        yield Scene(done)
        done.append(f"write {record}")

    def clock() -> float:
        done.append("clock")
        return float(len(done))

    monkeypatch.setattr(trade, "built", built)
    monkeypatch.setattr(trade, "process_time", clock)
    seconds = trade._cpu_s(CASE, ".psr", Fraction(1, 10), Fraction(1, 2))
    assert done == ["build", "advance to 107", "clock", "run 1/2", "write .psr", "clock"]
    assert seconds == (6 - 3) / 0.5
