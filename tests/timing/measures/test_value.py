"""Errors of values compared with the truth, and budgets that join value and time."""

from __future__ import annotations

import json
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim import BadCase, Verdict
from periph_sim.imu.host_frames import ramp
from periph_sim.imu.sensors import SENSORS as CHIPS
from tests.scene.runs import Ran, run_file
from tests.scene.small import sentence_of

PER_SECOND = 3_000_000_000


def run(*budgets: dict[str, Any], seconds: str = "0.1", changes: tuple[str, ...] = ()) -> Ran:
    def inline(value: Any) -> str:
        if isinstance(value, dict):
            return "{" + ", ".join(f"{key} = {inline(v)}" for key, v in value.items()) + "}"
        return "[" + ", ".join(map(inline, value)) + "]" if isinstance(value, list) else json.dumps(value)

    return run_file("imu_hil_published", seconds, f"budget = {inline(list(budgets))}", *changes)


def judged(*budgets: dict[str, Any], changes: tuple[str, ...] = ()) -> list[Verdict]:
    return run(*budgets, changes=changes).result.budgets


def error(**more: Any) -> dict[str, Any]:
    return {"name": "error", "measure": "value error", "max": 30, **more}


@settings(max_examples=6)
@given(st.integers(2_000, 18_000), st.sampled_from(["gyroscope", "accelerometer"]))
def test_the_value_error_is_the_age_times_the_rate_of_change(first_us: int, chip: str):
    """The fastest axis of the ramp changes by 5 or 13 LSB per period.

    The age of a value is the time from the due time of its frame to the first data bit.
    """
    axes, fastest = (slice(0, 3), 5) if chip == "gyroscope" else (slice(3, 6), 13)
    ran = run(error(measure=f"value error of {chip}", after="50 ms"), changes=(f"host.first={first_us} us",))
    ages = []
    for transfer in [t for transfers in ran.rounds for t in transfers if t.name == chip]:
        read = transfer.phases[1]
        values = CHIPS[chip].values(bytes(read.got))
        if read.start_at >= PER_SECOND * 50 // 1000:
            number = next(n for n in range(10) if ramp(n)[axes] == values)
            ages.append(Fraction(read.answer_at, PER_SECOND) - Fraction(first_us, 10**6) - Fraction(number, 50))
    (verdict,) = ran.result.budgets
    assert verdict.worst == pytest.approx(float(max(ages) * 50 * fastest), abs=2e-6)
    assert verdict.count == len(ages) == 2


def test_the_value_error_at_the_frame_shows_only_errors_of_the_firmware():
    assert judged(error(measure="value error at frame", max=0, after="30 ms"))[0].verdict == "pass"
    fixed = ('unit.dsp.settings.table={"0x68"="00 64 00 64 00 64"}',)
    (wrong,) = judged(error(measure="value error of gyroscope at frame", max=0, after="30 ms"), changes=fixed)
    assert (wrong.verdict, wrong.unit) == ("fail", "LSB") and wrong.worst > 900


@pytest.mark.parametrize("period", ["2.5 ms", "1.1 ms"])
def test_a_read_is_compared_with_every_frame_since_the_one_of_the_read_before(period: str):
    """Between the run of the models and the read of their values there are eight or eighteen frames."""
    budget = error(measure="value error at frame", max=0, after="30 ms")
    assert judged(budget, changes=(f"host.period={period}",))[0].verdict == "pass"


def test_a_read_whose_frame_may_no_longer_be_kept_is_not_judged():
    """The chip shows the values of the first frame, while 80 more frames are sent."""
    stays = 'unit.dsp.settings.table={"0x68"="00 01 03 e8 f8 30"}'
    budget = error(measure="value error of gyroscope at frame", max="2000 LSB")
    (verdict,) = judged(budget, changes=(stays, "host.period=1.1 ms"))
    assert verdict.verdict == "not judged"
    assert verdict.found.endswith("may fit frames that were not compared with them")


def test_reads_before_the_first_frame_are_left_out_by_after():
    early, late = judged(error(max=300), error(name="late", after="20 ms", max=300))
    assert (early.verdict, late.verdict) == ("fail", "pass")  # zeros until the first frame was processed
    assert early.count == late.count + 3 and early.worst == pytest.approx(2000, abs=1)


def joined(worst: int | str, age: str = "25 ms", chip: str = "gyroscope") -> dict[str, Any]:
    also = [{"measure": f"value error of {chip}", "max": worst}]
    budget = {"name": "fresh", "measure": "age of gyroscope", "max": age, "and": also, "why": "both"}
    return budget | {"after": "20 ms"}  # the values are zeros until then


def test_joined_conditions_on_value_and_time():
    kept, stale, wrong = judged(
        joined("6 LSB"), {**joined("6 LSB", age="22 ms"), "name": "stale"}, {**joined(2), "name": "wrong"}
    )
    expected = "age of gyroscope 22.153 ms at 0.025195 s (max {}); "
    expected += "value error of gyroscope 5.82375 LSB at 0.025195 s (max {})"
    assert (kept.verdict, kept.measure, kept.margin) == ("pass", "age of gyroscope", 2846.6667)
    assert kept.found == expected.format("25 ms", "6 LSB")
    assert (stale.verdict, stale.measure, stale.found) == (
        "fail",
        "age of gyroscope",
        expected.format("22 ms", "6 LSB"),
    )
    assert (wrong.verdict, wrong.measure, wrong.unit) == ("fail", "value error of gyroscope", "LSB")
    assert (wrong.worst, wrong.limit, wrong.found, wrong.why) == (5.82375, 2.0, expected.format("25 ms", "2"), "both")
    assert [v.name for v in (kept, stale, wrong)] == ["fresh", "stale", "wrong"]


def test_only_occurrences_of_the_first_condition_are_judged():
    """The first condition is about the gyroscope, so only reads of the gyroscope are compared."""
    alone, together = judged(error(after="20 ms", max=99), joined(6))
    assert (alone.count, together.count) == (12, 4)


def test_an_occurrence_without_a_second_value_is_not_judged():
    (verdict,) = judged(joined(99, chip="magnetometer"))
    assert (verdict.verdict, verdict.worst) == ("not judged", None)
    assert verdict.found.endswith("'value error of magnetometer' has no value for 4 of 4 values of 'age of gyroscope'")


@pytest.mark.parametrize(
    ("budget", "sentence"),
    [
        (
            joined("2 ms"),
            "budget.fresh.and.0.max: '2 ms', but 'value error of gyroscope' is in LSB; write for",
        ),
        (joined(-1), "budget.fresh.and.0.max: -1, but"),
        (
            joined(2, chip="gyro"),
            "budget.fresh.and.0.measure: 'value error of gyro': 'gyro' where gyroscope, ",
        ),
        ({**joined(2), "measure": "round"}, "budget.fresh.measure: 'round' is not measured read by read"),
        (
            {**joined(2), "and": [{"measure": "slack", "min": "1 ms"}]},
            "budget.fresh.and.0.measure: 'slack' is not measured",
        ),
        (
            {**joined(2), "and": [{"measure": "stretch"}]},
            "budget.fresh.and.0: a budget needs a limit: max, min or exactly",
        ),
        (
            {**joined(2), "and": [{"measure": "stretch", "mux": 2}]},
            "no key 'budget.fresh.and.0.mux'; did you mean max?",
        ),
        (error(measure="wrong bytes", after="1 ms"), "budget.error.after: 'wrong bytes' is one number a run, so none"),
        (error(after="1"), "budget.error.after: '1' has no unit"),
    ],
)
def test_invalid_joined_conditions_and_limits_are_rejected(budget: dict[str, Any], sentence: str):
    assert sentence in sentence_of(BadCase, lambda: judged(budget))


def test_value_error_needs_a_host():
    with pytest.raises(BadCase, match="'value error' needs host in the scene, which has none"):
        run_file("responder", "0.01", "budget = [{name = 'a', measure = 'value error', max = 1}]")


def test_typical_value_and_all_values_belong_to_the_condition_that_is_shown():
    ran = run(joined(2))
    (verdict,), (usual,), (values,) = (
        ran.result.budgets,
        ran.scene.typical(),
        [limit.values(0) for limit in ran.scene.limits],
    )
    assert verdict.measure == usual.measure == "value error of gyroscope"
    assert usual.worst is not None and verdict.worst is not None and 0 <= usual.worst <= verdict.worst == 5.82375
    assert (values.unit, values.limits) == ("LSB", {"max": 2_000_000})
