"""Budgets on races and lost flags agree with `races` on the recording, and do not pass if nothing was measured."""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Any

import pytest

from periph_sim import BadCase, Dsp, NotInRun, Verdict, load, timing
from periph_sim.firmware import start_i2c
from periph_sim.records.races import races
from periph_sim.timing.budget_schema import Budget
from tests.records.scenes import ADDRESS, asks, ran
from tests.scene.runs import TIMING, run_case
from tests.scene.small import scene_with, sentence_of, started_i2c
from tests.timing.events_by_hand import played

STR = "I2C-A.I2CSTR"


def judged(firmware, *budgets: dict[str, Any], **more: Any) -> list[Verdict]:
    named = [{"name": f"{i}", **budget} for i, budget in enumerate(budgets)]
    return scene_with(firmware, ["I2C-A"], budget=named, **more).run().budgets


def polls(dsp: Dsp) -> None:
    i2c = started_i2c(dsp, ADDRESS)
    for _ in range(3):
        dsp.spin(lambda: i2c.I2CSTR.RRDY == 1)
        dsp.compute(77)
        assert i2c.I2CDRR.all


@pytest.mark.parametrize("name", [STR, f"{STR}.RRDY"])
def test_a_budget_on_races_agrees_with_the_recording(monkeypatch: pytest.MonkeyPatch, name: str):
    writes = asks(write="010203", count=0)
    run = ran(monkeypatch, polls, **writes)
    closest = races(run, name).closest
    (verdict,) = judged(polls, {"measure": f"race {name}", "min": 1}, **writes)
    assert (verdict.worst, verdict.unit) == (closest, "cycles")
    found = timing.races(run.table, name)
    assert (verdict.count, verdict.worst) == (len(found.cycles), found.cycles.min())
    assert verdict.at_s == pytest.approx(found.tick[found.cycles.argmin()] / 3e9)


def test_a_field_that_was_never_read_is_not_judged():
    """BB changes while RRDY is polled, but BB is never read."""
    (verdict,) = judged(polls, {"measure": f"race {STR}.BB", "min": 1}, **asks(write="010203", count=0))
    assert (verdict.verdict, verdict.count) == ("not judged", 0) and f"no read of {STR}.BB had" in verdict.found


def test_the_limit_of_a_race_is_in_cycles(monkeypatch: pytest.MonkeyPatch):
    writes = asks(write="010203", count=0)
    closest = races(ran(monkeypatch, polls, **writes), f"{STR}.RRDY").closest
    kept, broken = judged(
        polls, *({"measure": f"race {STR}.RRDY", "min": least} for least in (closest, closest + 1)), **writes
    )
    assert (kept.verdict, kept.margin, broken.verdict, broken.margin) == ("pass", 0, "fail", -1)


def drops(wait: bool):
    def main(dsp: Dsp) -> None:
        i2c = started_i2c(dsp, ADDRESS)
        dsp.compute(180_000)  # 1.2 ms: after the first byte, before the STOP
        if wait:
            dsp.spin(lambda: i2c.I2CSTR.RRDY == 1)
        i2c.I2CSTR.SCD = 1

    return main


@pytest.mark.parametrize("name", [f"lost flags {STR}", "lost flags"])
def test_a_flag_lost_to_a_read_modify_write_breaks_its_budget(monkeypatch: pytest.MonkeyPatch, name: str):
    writes = asks(write="0102", count=0)
    lost, limited = judged(drops(False), *({"measure": name, "max": most} for most in (0, 1)), **writes)
    assert (lost.worst, lost.count, lost.verdict, limited.verdict) == (1, 1, "fail", "pass")
    assert re.fullmatch(r"\w+\.I2C-A\.I2CSTR\.\w+ at .*, 1 time", lost.found) and lost.found == limited.found
    (seen,) = judged(drops(True), {"measure": name, "exactly": 0}, **writes)
    assert (seen.worst, seen.count, seen.verdict) == (0, 1, "pass")
    ticks = timing.lost_flags(ran(monkeypatch, drops(False), **writes).table, name.removeprefix("lost flags").strip())
    assert lost.at_s == pytest.approx(ticks[0] / 3e9) and len(ticks) == 1


def test_a_plain_write_loses_no_flag_and_is_judged():
    def main(dsp: Dsp) -> None:
        start_i2c(dsp)
        i2c = dsp.module("I2C-A")
        i2c.I2CSTR.all = 1 << 5  # SCD
        i2c.I2CMDR.all = 0

    writes = asks(write="0102", count=0)
    for name in ("lost flags", f"lost flags {STR}", f"cleared along {STR}.SDIR"):
        (seen,) = judged(main, {"measure": name, "exactly": 0}, **writes)
        assert (seen.worst, seen.count, seen.verdict) == (0, 1, "pass")


@pytest.mark.parametrize(("second_poll", "silent"), [(0, True), (1010, False)])
def test_a_wait_whose_polls_cannot_be_reconstructed_is_not_judged(second_poll: int, silent: bool):
    """If only the first and the last poll of a wait are recorded, the length of its passes is unknown."""
    of = "20000 access dsp R_I2C-A.I2CSTR 0"
    of += f"\n{20 * second_poll} access dsp R_I2C-A.I2CSTR 0" * bool(second_poll)
    of += "\n30140 flag dsp.I2C-A I2CSTR.RRDY 1\n30200 access dsp R_I2C-A.I2CSTR 8"
    clocks = [(0, Fraction(150_000_000))]
    made = played(f"race {STR}.RRDY", of, 40_000, ticks_per_second=3_000_000_000, clock_history=lambda unit: clocks)
    assert made.silent == silent
    assert ("skip_polls = false" in made.missing()) == silent
    assert silent or made.least == 3


def idles(dsp: Dsp) -> None:
    dsp.compute(100)


@pytest.mark.parametrize(
    ("measure", "limit", "sentence"),
    [
        (f"race {STR}", {"min": 0}, f"no read of {STR} had a change to be compared with"),
        (f"lost flags {STR}", {"max": 9}, f"the firmware never wrote {STR}"),
        (f"cleared along {STR}.SDIR", {"max": 9}, f"the firmware never wrote {STR}.SDIR"),
        ("lost flags", {"max": 9}, "the firmware never wrote a register with flags that writing 1"),
    ],
)
def test_a_measure_without_relevant_accesses_is_not_judged(measure: str, limit: dict[str, int], sentence: str):
    (verdict,) = judged(idles, {"measure": measure, **limit}, **asks(write="01", count=0))
    assert (verdict.verdict, verdict.worst) == ("not judged", None) and verdict.found.startswith(sentence)


@pytest.mark.parametrize(
    ("measure", "limit", "sentence"),
    [
        ("race I2C-A.I2CSTR.XRDi", {"min": 1}, "I2CSTR has no field 'XRDi'; did you mean XRDY"),
        ("race I2C-A.I2CPSC", {"min": 1}, "I2CPSC is no status register: hardware sets no flag in it"),
        ("cleared along I2C-A.I2CSTR.BB", {"max": 0}, "writing 1 does not clear I2C-A.I2CSTR.BB"),
        ("race I2C-A", {"min": 1}, "'I2C-A' is no register"),
        ("lost flags I2C-A.I2CMDR", {"max": 0}, "writing 1 clears no flag of I2CMDR, so none can be lost"),
        (f"race {STR}", {"min": "20 ns"}, "is a number of cycles; write a whole number"),
        ("lost flags", {"p99": 0}, "is one number a run and has no percentiles"),
    ],
)
def test_invalid_budgets_on_races_are_rejected(measure: str, limit: dict[str, Any], sentence: str):
    assert sentence in sentence_of(BadCase, lambda: judged(idles, {"measure": measure, **limit}))


def test_a_recording_without_relevant_accesses_is_rejected_with_a_reason(monkeypatch: pytest.MonkeyPatch):
    run = ran(monkeypatch, idles)
    with pytest.raises(NotInRun, match="never accessed"):
        timing.races(run.table, STR)
    assert len(timing.lost_flags(run.table)) == 0


def test_a_flag_read_only_along_with_another_is_lost_and_cleared_along():
    """SDIR is set during a service routine of 40 us and cleared along with SCD. The firmware then waits for it."""
    changes = ["unit.dsp.settings.frame_cost=40 us", "controller.rate=400 kHz", "host.first=3990 us"]
    flawed = load(TIMING / "imu_hil_published.toml", changes)
    names = ("lost flags I2C-A.I2CSTR", "cleared along I2C-A.I2CSTR.SDIR", "cleared along I2C-A.I2CSTR.SCD")
    budgets = tuple(Budget(name=name, measure=name, max=0) for name in names)
    ran = run_case(flawed.model_copy(update={"budget": budgets}), "0.03")
    lost, sdir, scd = ran.result.budgets
    assert (lost.worst, sdir.worst, sdir.count, sdir.verdict) == (1, 1, 1, "fail")
    assert (scd.worst, scd.verdict) == (0, "pass")
    assert ran.rounds == []
