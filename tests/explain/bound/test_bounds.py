"""Bounds of the IMU emulator: beside what is seen, at the worst phase, and where none can be."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from periph_sim.core.records import Kind, Record
from periph_sim.explain.bound import BadBound, Report, report
from periph_sim.explain.bound.deadlines import deadlines
from periph_sim.explain.bound.form_of_case import closed_form
from periph_sim.explain.bound.limits import LimitCheck
from periph_sim.explain.bound.terms import Bound, Term
from periph_sim.explain.bound.text_report import text
from periph_sim.scene.case.load import load
from periph_sim.timing.budget_schema import Budget
from tests.explain.bound.cases import imu_hil, named, reported
from tests.scene.runs import TIMING, run_case
from tests.scene.small import case

CYCLE = 20  # ticks
NAMES = {"response", "stretch", "margin", "round", "slack", "span model", "age", "latency SCIRXINTA", "reaction"}


def test_of_the_reference_scene_each_bound_holds_and_none_is_far_off():
    found = reported("duration=1 s", seconds="1")
    assert found.holds and not found.missed and not found.hung
    assert named(found).keys() == NAMES | {"missed rounds", "nacked rounds", "FIFO high-water", "overruns"}  # limited
    ratios = {each.bound.name: each.ratio for each in found.beside}
    assert ratios["response"] == 1  # the controller's SCL low time: the firmware is ready long before
    loose = {"reaction": 5, "latency SCIRXINTA": 2}  # no frame came during a read
    assert all(1 <= ratio < loose.get(name, Fraction(9, 5)) for name, ratio in ratios.items() if ratio is not None)
    (response,) = (each for each in found.beside if each.bound.name == "response")
    assert response.bound.floor is not None and response.bound.floor.ticks == 750 * CYCLE
    assert response.count == 150 and response.bound.sum < 0


def test_a_limit_that_some_phase_breaks_is_told_though_this_run_keeps_it():
    """The host's frames end 5 ms before a round here; in 63 of 100 phases one that just missed the models is read late.

    host.first      2 ms        7 ms
    age seen     23.933 ms   38.933 ms      limit 25 ms, bound 39.365 ms
    """
    (kept, seen), (broken, worse) = (age_in(f"host.first={first} ms") for first in (2, 7))
    assert seen < 25_000 < worse
    assert kept.beyond and broken.beyond and kept.bound is not None and kept.bound == broken.bound
    assert kept.spare == kept.limit - kept.bound.ticks < 0


def age_in(change: str) -> tuple[LimitCheck, float]:
    """The age's limit beside its bound, and the largest age seen in microseconds."""
    found = reported(change)
    (check,) = (limit for limit in found.limits if limit.measure == "age")
    (age,) = (each for each in found.beside if each.bound.name == "age")
    assert not found.passed and found.holds == age.holds and age.seen is not None
    return check, age.seen * 1_000_000 / found.timebase.per_second


def test_a_limit_is_kept_to_the_tick_and_broken_one_below():
    (check,) = (limit for limit in reported().limits if limit.budget == "data age")
    assert check.bound is not None
    ns = -(-check.bound.ticks // 3)  # a tick is a third of a nanosecond
    for limit, beyond in ((ns, False), (ns - 1, True)):
        assert limit_check("age", f"{limit} ns").beyond is beyond


def limit_check(measure: str, limit: str, key: str = "max") -> LimitCheck:
    """What the bounds of the IMU emulator make of one limit."""
    plain = imu_hil()
    budget = Budget.model_validate({"name": "it", "measure": measure, key: limit})
    (check,) = report(plain.model_copy(update={"budget": (budget,)}), Fraction(1, 10)).limits
    return check


@pytest.mark.parametrize(
    ("measure", "limit", "key", "reason"),
    [
        ("gap between rounds", "1 us", "max", "no closed form is known"),
        ("response", "1 us", "min", "only the largest value is calculated"),
        ("slack", "1 us", "max", "only the smallest value is calculated"),
        ("response", "5 us", "exactly", "'exactly' needs the smallest value and the largest"),
        ("response", "5 us", "p99", ""),
        ("slack", "17 ms", "min", ""),
    ],
)
def test_a_limit_is_held_against_a_bound_of_its_own_side_only(measure: str, limit: str, key: str, reason: str):
    check = limit_check(measure, limit, key)
    assert check.reason == reason and (check.bound is None) is bool(reason)
    assert check.beyond is False


def in_cycles(bound: Bound) -> dict[str, int]:
    return {term.what: term.ticks // CYCLE for term in bound.terms}


def test_each_term_is_what_the_cases_own_parameters_say():
    code = ("poll_pass=100", "isr_prologue=9", "isr_epilogue=4")
    options = ("int_latency=16", "vector_fetch_waits=2", "idle_wake=5", "gpio_out_delay=2", "pf2_read_ws=5")
    i2c = ("noise_filter_cycles=4", "sda_setup_before_scl_release=3")
    plain = closed_form(imu_hil()).response
    of_options = {"system": options, "i2c": i2c}
    changes = [f"unit.dsp.options.{kind}.{one}" for kind, some in of_options.items() for one in some]
    changes += [f"unit.dsp.code.{one}" for one in code]
    changed = closed_form(imu_hil(*changes, "controller.rate=200 kHz")).response
    before, after = in_cycles(plain), in_cycles(changed)
    moved = {what: (before[what], after[what]) for what in before if before[what] != after.get(what)}
    assert moved == {
        "SDIR behind its edge": (16, 61),  # a cycle, and 1 or 4 module clocks of 15 cycles
        "poll pass for SDIR": (9, 99),
        "interrupts by host frames: 1": (64, 64 + 2 + 2 + 5 + 9 + 4 + 14 * 3),  # 12 characters and 2 flags are read
        "SDA set up before SCL": (15, 45),
        "pin output": (1, 2),
        "edge to the end of the address's ACK slot": (-1500, -750),
    }
    assert plain.floor is not None and changed.floor is not None
    assert (plain.floor.ticks, changed.floor.ticks) == (750 * CYCLE, 375 * CYCLE)


def test_a_slow_service_routine_is_the_worst_case_at_its_worst_phase():
    """The routine begins as SDIR rises; nothing else of the sum is more than a few cycles off."""
    changes = ("controller.rate=400 kHz",)
    found = [
        reported(*changes, f"host.first={first} ns", frame_us=20, seconds="0.008")
        for first in range(4_026_800, 4_028_000, 400)
    ]
    (response,) = {each.beside[0].bound for each in found}
    assert in_cycles(response)["interrupts by host frames: 1"] == 3064
    seen = max(each.beside[0].seen or 0 for each in found)
    assert response.ticks * 20 // 21 < seen <= response.ticks
    for name in ("stretch", "reaction"):
        ratios = [each.ratio for of in found for each in of.beside if each.bound.name == name and each.ratio]
        assert 1 <= min(ratios) < Fraction(21, 20)
    margin = [each for of in found for each in of.beside if each.bound.name == "margin"]
    assert {each.bound.ticks for each in margin} == {-stretch_of(found[0])}  # SCL is held for what it is too late
    assert {each.held_from for each in found} == {0} and "SCL may be held for it already" in text(found[0])
    assert all(each.seen is not None and each.seen >= each.bound.ticks for each in margin)
    assert min(each.seen or 0 for each in margin) < margin[0].bound.ticks * 20 // 21


def stretch_of(found: Report) -> int:
    return next(each.bound.ticks for each in found.beside if each.bound.name == "stretch")


def test_models_that_take_the_spare_time_leave_no_bound():
    kept, missed = (
        reported(f"unit.dsp.settings.model_cost={cost} us", "controller.first=20 ms", seconds="0.03")
        for cost in (17_378, 17_379)
    )
    assert not kept.missed and kept.beside
    assert [deadline.name for deadline in missed.missed] == ["gyroscope asked"]
    assert not missed.holds and not missed.beside
    terms = [term.what for term in missed.missed[0].terms]
    assert any(what.endswith("with model") for what in terms) and "slack" in terms


def test_start_up_must_be_over_before_the_first_request():
    found = reported("controller.first=251 us", seconds="0.03")
    assert [deadline.name for deadline in found.missed] == ["gyroscope asked first"]
    assert not reported("controller.first=252 us", seconds="0.03").missed


def test_a_write_of_i2cstr_that_may_clear_sdir_is_a_deadline_and_missing_it_hangs():
    """A service routine of 40 us between RRDY and `SCD = 1`: SDIR has risen, is read as 1 and cleared unseen."""
    changes = ("controller.rate=400 kHz", "host.first=3990 us")
    found = reported(*changes, frame_us=40)
    assert {deadline.name for deadline in found.missed} == {
        *(f"SDIR of {chip} rises" for chip in ("gyroscope", "accelerometer", "magnetometer")),
        "AAS seen in time",  # a repeated START clears it 27.5 us after it rose
        "XRDY seen in time",  # SCD rises 25 us after the last one, and would end the wait before the last write
    }
    ran = run_case(imu_hil(*changes, frame_us=40), "0.03")
    assert ran.rounds == [] and ran.result.counts["missed"] == 1
    assert not reported("controller.rate=400 kHz", "host.first=3990 us", frame_us=20).missed


@pytest.mark.parametrize(
    "changes",
    [
        ("code.poll_pass=10",),
        ("code.poll_pass=7", "options.system.pf2_read_ws=5"),
        ("options.system.pf2_read_ws=1", "code.between_accesses=5"),
    ],
)
def test_a_poll_pass_is_what_passes_made_one_by_one_take(changes: tuple[str, ...]):
    options = [f"unit.dsp.{change}" for change in changes]
    calm = closed_form(imu_hil(*options)).calm
    reads: dict[str, list[int]] = {}

    def hear(record: Record) -> None:
        if record.what == "R I2C-A.I2CSTR":
            reads.setdefault(record.text, []).append(record.tick)

    run_case(imu_hil(*options, "unit.dsp.skip_polls=false"), "0.0057", lambda r, _: r.subscribe([Kind.ACCESS], hear))
    for wait in calm.waits[:6]:
        ticks = reads[wait.place]
        again = {late - early for early, late in zip(ticks, ticks[wait.reads :], strict=False)}
        assert min(again) == calm.pass_cycles(wait) * CYCLE


def test_models_at_the_controllers_pace_have_bounds_beside_a_host_of_another():
    of_models = load(TIMING / "imu_hil.toml", ["host.period=17 ms"])  # models that run each 20 ms
    assert closed_form(of_models).handlers.per_frame == 1


def test_what_is_not_seen_is_not_proven():
    found = reported(seconds="0.004")  # over before the first round
    assert named(found)["response"] is None and not found.holds


@pytest.mark.parametrize("change", ["host.frames=9", "host.lose=[[1, 1]]", 'host.silent=[["10 ms", "30 ms"]]'])
def test_no_age_is_bounded_where_the_host_may_fail_to_send(change: str):
    assert not any(bound.measure.startswith(("age", "model age")) for bound in closed_form(imu_hil(change)).bounds(()))


FIRMWARE = """
from periph_sim.firmware import start_i2c


def main(dsp, settings):
    start_i2c(dsp)
    i2c = dsp.module("I2C-A")
    i2c.I2COAR.all = 0x50
    i2c.I2CMDR.IRS = 1
    while True:
        {body}
"""


@pytest.mark.parametrize(
    ("body", "request_", "sentence"),
    [
        (
            "dsp.compute(9000), i2c.I2CDRR.all",
            {"count": 0, "pointer": 1},
            "dsp writes I2CDXR never, or within a wait only",
        ),
        ("dsp.compute(3000); i2c.I2CDXR.all = 7", {"count": 1}, "the firmware is in no wait when 0x50 is asked"),
        ("dsp.spin(lambda: i2c.I2CSTR.RRDY == 9)", {"count": 0, "write": "0102"}, "the second round is not over when"),
    ],
)
def test_firmware_that_does_not_serve_in_waits_has_no_closed_form(tmp_path, body: str, request_, sentence: str):
    (tmp_path / "f.py").write_text(FIRMWARE.format(body=body), encoding="utf-8")
    with pytest.raises(BadBound) as caught:
        report(served(str(tmp_path / "f.py"), request_), Fraction(1, 100))
    assert sentence in str(caught.value)


def served(firmware: str, request: dict[str, Any], **more: Any):
    controller = {"first": "1 ms", "period": "3 ms", "request": [{"address": 0x50, **request}]}
    unit = {"dsp": {"firmware": firmware, "modules": ["I2C-A"]}}
    return case(**{"unit": unit, "controller": controller, **more})


def test_a_host_whose_frames_interrupt_nothing_adds_no_bound_of_a_latency():
    closed = closed_form(served("responder", {"count": 2, "pointer": 0}, host={}))
    assert (closed.latencies, closed.fifo) == ([], []) and closed.handlers.per_frame == 0


def test_each_byte_of_a_read_has_its_own_write_of_i2cdxr():
    closed = closed_form(imu_hil())
    assert [len(of_read) for of_read in closed.writes] == [6] * 6  # three reads in each of two rounds


def test_the_bounds_of_the_reference_scene_rest_on_these_deadlines():
    assert [deadline.name for deadline in deadlines(closed_form(imu_hil()))] == [
        "gyroscope asked first",
        "accelerometer asked",
        "magnetometer asked",
        "gyroscope asked",
        *(f"SDIR of {chip} rises" for chip in ("gyroscope", "accelerometer", "magnetometer")),  # SCD = 1 may clear it
        *(f"{flag} seen in time" for flag in ("AAS", "SDIR", "XRDY")),
    ]
    of_reads_alone = deadlines(closed_form(served("responder", {"count": 2})))
    assert {"AAS seen in time", "XRDY seen in time"} < {deadline.name for deadline in of_reads_alone}


def test_a_wait_that_a_request_ends_in_its_very_tick_was_there_in_time():
    closed = closed_form(imu_hil())
    first = deadlines(closed)[0]
    closed.calm.waits[0].end = closed.calm.transfers[0].phases[0].start_at
    assert deadlines(closed)[0] == first and first.name == "gyroscope asked first"


def test_scl_is_held_for_the_byte_whose_write_comes_latest():
    """The service routine delays the first write by 20 us; the others may be a byte late and are not."""
    slow = closed_form(imu_hil("controller.rate=400 kHz", frame_us=20))
    assert slow.stretch.ticks == -slow.margin.ticks == slow.response.ticks - slow.calm.low > 0


def test_a_wait_for_either_of_two_flags_is_ended_by_the_second_one_a_read_later():
    calm = closed_form(imu_hil()).calm
    second = {wait.flag: wait.into // CYCLE for wait in calm.waits if wait.reads == 2}
    assert second == {"I2C-A.I2CSTR.XRDY": 0, "I2C-A.I2CSTR.SCD": 7}


def test_no_routine_delays_an_interrupt_but_masking_leaves_it_without_a_bound():
    plain, masked = (
        closed_form(imu_hil(f"unit.dsp.settings.mask_during_i2c={flag}")).latencies[0] for flag in ("false", "true")
    )
    assert plain.terms[-1] == Term("service routine before", 0, plain.terms[-1].source) and not plain.unproven
    assert masked.unproven.endswith(" runs with interrupts masked")


def test_the_models_come_behind_the_last_stop_of_a_round_only():
    whole, within = closed_form(imu_hil()).own_addresses
    assert whole.special and within.special and within.part == Fraction(2, 3) and "model" not in str(within.terms)
    assert within.ticks < 250 * 150 * CYCLE < whole.ticks


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"controller": None}, "bounds count from a controller's requests, and there is no"),
        ({"unit": {}}, "one unit that answers by its I2C-A; here none has it"),
    ],
)
def test_a_scene_without_request_and_answer_is_refused(changes: dict[str, Any], sentence: str):
    with pytest.raises(BadBound, match=sentence):
        report(served("responder", {"count": 1}, **changes))


def test_models_too_slow_without_any_host_are_told_at_once():
    refused = "even without a host gyroscope does not acknowledge its request at 5000.000 us"
    with pytest.raises(BadBound, match=refused):
        reported("unit.dsp.settings.model_cost=18 ms")


def test_the_sum_of_the_slack_is_what_the_round_leaves_of_the_period():
    closed = closed_form(imu_hil("controller.jitter=1 ms"))
    assert closed.slack.ticks == closed.period - closed.jitter - closed.round.ticks
    assert closed.jitter == closed.timebase.ticks("1 ms")
