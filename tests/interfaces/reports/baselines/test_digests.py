"""The values of the bytes on the bus are part of a baseline: other data, or another ACK, is a change."""

from __future__ import annotations

import pytest

from periph_sim.core.records import Kind, Recorder
from periph_sim.interfaces.reports.baselines.compare import compare
from periph_sim.interfaces.reports.baselines.digests import PART, BusBytes
from periph_sim.interfaces.reports.baselines.files import Baseline, path_for, read
from periph_sim.interfaces.reports.baselines.outcome import Outcome, run_case
from tests.scene.runs import TIMING


def digests(values: list[int], start: int = 0) -> list[str]:
    recorder = Recorder()
    sent = BusBytes(recorder)
    for number, value in enumerate(values):
        recorder.emit(start + number, Kind.BUS, "bus", "START", 0)
        recorder.emit(start + number, Kind.BUS, "bus", "byte", value)
    return sent.digests


def baseline(values: list[int] | None) -> Baseline:
    return Baseline(
        case="c",
        simulated=1,
        ticks_per_second=1,
        ticks_per_cycle=1,
        events=1,
        counts={},
        budgets={},
        bus_bytes=[] if values is None else digests(values),
    )


def test_times_do_not_count_and_values_do():
    values = [*range(3 * PART)]
    assert digests(values) == digests(values, start=1000) and len(digests(values)) == 3
    assert len(digests(values[:-1])) == 3 and digests([]) == []


@pytest.mark.parametrize("place", [0, PART - 1, PART, 2 * PART + 5])
def test_the_part_with_the_first_other_byte_is_named(place: int):
    values = [*range(3 * PART)]
    other = [*values[:place], values[place] ^ 1, *values[place + 1 :]]
    (change,) = compare(baseline(values), baseline(other))
    first = place // PART * PART
    where = f"first among bytes {first + 1} to {first + PART} of the run"
    assert str(change) == f"bytes on the bus differ from the baseline, {where}" and not change.note


def test_bytes_that_are_more_or_fewer_are_a_change():
    values = [*range(2 * PART)]
    for before, now in ((values, values[:PART]), (values[:PART], values)):
        (change,) = compare(baseline(before), baseline(now))
        assert "first among bytes 65 to 128" in str(change) and not change.note


def test_a_baseline_without_bytes_is_noted():
    (change,) = compare(baseline(None), baseline([1]))
    assert change.note and "--update-baseline adds them" in str(change)
    assert compare(baseline([1]), baseline([1])) == compare(baseline(None), baseline(None)) == []


@pytest.mark.parametrize("change", [None, "unit.imu.settings.noise_seed=2", "host.motion.angles.0.amplitude='31 deg'"])
def test_a_check_of_two_dsps_finds_data_that_are_other_ones_and_right(change: str | None):
    """Other noise, or another motion: the bytes are right by the budget, at the same times, and not the baseline's."""
    path = TIMING / "two_dsps.toml"
    kept = read(path_for(path))
    assert kept is not None and len(kept.bus_bytes) == -(-kept.counts["I2C bytes"] // PART)
    outcome = run_case(path, () if change is None else (change,), False)
    assert isinstance(outcome, Outcome) and outcome.result.verdict == "pass"
    changes = [str(found) for found in compare(kept, outcome.figures) if not found.note]
    where = "first among bytes 1 to 64 of the run"
    expected = [f"bytes on the bus differ from the baseline, {where}"]
    assert changes == ([] if change is None else expected)
    assert outcome.figures.digest == kept.digest  # of times alone
