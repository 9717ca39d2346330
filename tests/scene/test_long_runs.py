"""Runs of hours and years: counts are exact with a crystal off by ppm, and a run beyond the last tick is refused."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim import BadCase, Case, Firmware, Run, Scene
from periph_sim.core.records import Kind
from periph_sim.records.recording import recording

HOURS = 3


def case(duration: str, **unit: object) -> Case:
    return Case.model_validate(
        {"name": "long", "duration": duration, "unit": {"dsp": {"firmware": "ticking", "modules": [], **unit}}}
    )


def ticking(dsp: object, settings: object) -> None:
    while True:
        dsp.compute(Fraction(1), "second")


PROGRAMS = {"dsp": Firmware("ticking", ticking, None)}


@pytest.mark.parametrize("ppm", [0, 37, -37, 100])
def test_spans_of_a_second_are_counted_exactly_for_hours(ppm: int) -> None:
    begins: list[int] = []

    def subscribe(recorder, timebase) -> None:
        recorder.subscribe({Kind.SPAN}, lambda record: begins.append(record.tick) if record.value else None)

    scene = Scene(case(f"{HOURS} h", ppm=ppm), subscribe, PROGRAMS)
    scene.run()
    second = Fraction(3_000_000_000) / (1 + Fraction(ppm, 1_000_000))
    assert len(begins) == (HOURS * 3600 * 3_000_000_000) // second + 1
    assert all(0 <= begins[0] + n * second - tick < 1 for n, tick in enumerate(begins))


@pytest.mark.parametrize("duration", ["39800 d", "17792 d"])
def test_a_run_beyond_the_last_tick_is_refused_before_it_starts(duration: str) -> None:
    scene = Scene(case(duration), programs=PROGRAMS)
    with pytest.raises(BadCase, match=r"duration: a run of .* d ends after the last tick, .* is 17791\.9 d$"):
        scene.run()
    assert scene.kernel.now == 0 and scene.kernel.events == 0


def test_a_run_of_decades_is_recorded_with_its_ticks(tmp_path: Path) -> None:
    def rarely(dsp, settings) -> None:
        while True:
            dsp.compute(Fraction(1000 * 86_400), "a thousand days")

    path = tmp_path / "decades.psr"
    one = case("17790 d")
    with recording(path, one.recorded_modules) as (subscribe, ended_at):
        scene = Scene(one, subscribe, {"dsp": Firmware("rarely", rarely, None)})
        scene.run()
        ended_at(scene.kernel.now, {})
    ticks = Run.read(path).table.tick
    assert len(ticks) >= 18 and int(ticks[-1]) >= 17_000 * 86_400 * 3_000_000_000
