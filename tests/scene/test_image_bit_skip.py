"""Optimizations of a scene with an image: skipped bits and skipped polls change no record and no figure."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

from periph_sim.core.records import RECORDED, Kind, Record
from periph_sim.records.races import races
from periph_sim.records.run import Run as RecordedRun
from periph_sim.scene.case.load import load
from periph_sim.scene.result import Result
from periph_sim.scene.scene import Scene
from periph_sim.traces.formats.record_table import Columns

TIMING = Path(__file__).parents[2] / "timing"
TO_ONE_ROUND = ("duration=12.3 ms", "host.first=5 ms")
BUT_EDGES = tuple(kind for kind in RECORDED if kind not in (Kind.EDGE, Kind.HOLD))


def run(*changes: str) -> tuple[Result, list[Record]]:
    records: list[Record] = []
    case = load(TIMING / "imu_hil_image.toml", [*TO_ONE_ROUND, *changes])
    scene = Scene(case, lambda recorder, _: recorder.subscribe(BUT_EDGES, records.append))
    return scene.run(), records


def test_skipped_bits_give_the_same_records_and_figures():
    result, records = run()
    by_edges, expected = run('disable=["bits"]')
    assert len(records) > 900
    without_numbers = [[record._replace(number=0, cause=0) for record in some] for some in (records, expected)]
    assert without_numbers[0] == without_numbers[1]
    assert result.budgets == by_edges.budgets
    assert result.events < by_edges.events / 2


def recorded_run(*changes: str) -> RecordedRun:
    """The run as a file of it would tell it, with the clocks of its units."""
    columns = Columns()
    case = load(TIMING / "imu_hil_image.toml", [*TO_ONE_ROUND, *changes])
    scene = Scene(case, lambda recorder, _: recorder.subscribe(RECORDED, columns.add))
    scene.run()
    table = columns.table(Fraction(scene.timebase.per_second), scene.kernel.now, case.recorded_modules)
    return RecordedRun(replace(table, clocks=scene.clocks()))


def test_polls_that_were_skipped_are_put_back_where_they_would_have_been():
    """The crystal is off by 30 ppm, so no cycle is whole ticks; and the wait for XRDY or SCD reads at two places."""
    skipped, made = (
        races(recorded_run("duration=9.3 ms", f"unit.dsp.skip_polls={skip}")) for skip in ("true", "false")
    )
    closest = [
        {
            place.place: (place.register, place.before and place.before.cycles, place.after and place.after.cycles)
            for place in some.places
        }
        for some in (skipped, made)
    ]
    assert closest[0] == closest[1] and len(closest[0]) >= 6
    near = [{place.place: place.histogram[:2] for place in some.places} for some in (skipped, made)]
    assert near[0] == near[1]  # within 10 cycles of a change
    assert sum(place.polls for place in skipped.places) > 10 and not any(place.unplaced for place in skipped.places)
