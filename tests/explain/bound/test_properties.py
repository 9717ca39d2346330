"""Whatever the phases, rates, costs and options: no value is beyond its bound, and no interrupts are missed."""

from __future__ import annotations

from hypothesis import Phase, example, given, settings
from hypothesis import strategies as st

from periph_sim.explain.bound.service_routine import ServiceRoutines
from periph_sim.explain.bound.terms import Term
from tests.explain.bound.cases import reported
from tests.profiles import examples

SETTINGS = {
    "host.first": st.integers(100_000, 10_100_000).map("{} ns".format),  # the start-up code is over by then
    "host.period": st.sampled_from(["10 ms", "10 ms", "7 ms", "17 ms"]),
    "host.jitter": st.sampled_from(["0 ms", "1 ms", "3 ms"]),
    "controller.period": st.just("10 ms"),
    "controller.rate": st.sampled_from(["60 kHz", "100 kHz", "250 kHz", "400 kHz"]),
    "controller.jitter": st.sampled_from(["0 ms", "0 ms", "2 ms"]),
    "controller.first": st.integers(5_000, 10_000).map("{} us".format),
    "unit.dsp.settings.model_cost": st.integers(1, 4_500).map("{} us".format),
    "unit.dsp.code.between_accesses": st.sampled_from([0, 1, 5, 15]),
    "unit.dsp.code.isr_prologue": st.integers(0, 200),
    "unit.dsp.code.isr_epilogue": st.integers(0, 40),
    "unit.dsp.options.system.pf2_read_ws": st.integers(0, 15),
    "unit.dsp.code.poll_pass": st.sampled_from([7, 10, 40, 400]),
    "unit.dsp.options.system.int_latency": st.integers(13, 16),
    "unit.dsp.options.system.vector_fetch_waits": st.integers(0, 2),
    "unit.dsp.options.system.idle_wake": st.integers(0, 16),
    "unit.dsp.options.system.gpio_out_delay": st.integers(0, 2),
    "unit.dsp.options.i2c.noise_filter_cycles": st.integers(0, 5),
    "unit.dsp.options.i2c.sda_setup_before_scl_release": st.integers(0, 20),
    "unit.dsp.options.i2c.aas_sdir_point": st.sampled_from(["fall8", "rise8", "fall9"]),
    "unit.dsp.options.i2c.rrdy_point": st.sampled_from(["fall8", "rise9", "fall9"]),
    "unit.dsp.options.i2c.bcm_reset": st.sampled_from([1, 1, 0]),
    "unit.dsp.ppm": st.sampled_from([0, 0, 80, -80, "3.7"]),
    "controller.ppm": st.sampled_from([0, 0, 50, -50, "-11.3"]),
    "host.ppm": st.sampled_from([0, 0, 2000, -2000, "0.7"]),
}
ONLY_WITH_FRAMES = {"age", "latency SCIRXINTA"}


@settings(max_examples=examples(10), phases=[Phase.explicit, Phase.generate])
@given(st.fixed_dictionaries(SETTINGS), st.sampled_from([0, 2, 10, 20]), st.integers(26, 42))
def test_the_bound_is_never_below_what_is_seen(drawn: dict[str, str | int], frame_us: int, ms: int):
    changes = [f"{key}={value}" for key, value in drawn.items()]
    found = reported(*changes, frame_us=frame_us, seconds=f"{ms}/1000")
    assert not found.hung
    if found.missed:
        assert not found.beside and not found.holds
    for each in found.beside:
        assert each.holds or each.seen is None, (each.bound, each.seen)
        assert each.seen is not None or each.bound.name in ONLY_WITH_FRAMES


def executed(handlers: ServiceRoutines, length: int, first: int, late: list[int]) -> int:
    """How many routines run while work of `length` from 0 on is not done; the n-th is asked for at first + n periods
    and so much late. One that is running at 0 counts."""
    asked = [first + n * handlers.period + late[n % len(late)] for n in range(200)]
    now, left, count = min(asked[0], 0), length, 0
    for at in sorted(asked):
        if at > now:
            done = at - max(now, 0)
            if done > left:
                break
            left -= max(done, 0)
            now = at
        count += 1
        now += handlers.cost
    return count


@example(cost=10, period=100, length=51, first=-40, late=[40, 0])  # the second comes 60 behind the first
@given(
    cost=st.integers(1, 50),
    period=st.integers(60, 200),
    length=st.integers(0, 1000),
    first=st.integers(-49, 200),
    late=st.lists(st.integers(0, 40), min_size=1, max_size=5),
)
def test_no_more_interrupts_run_than_are_counted(cost: int, period: int, length: int, first: int, late: list[int]):
    handlers = ServiceRoutines((Term("all", cost, ""),), 1, period, max(late), 1)
    first = max(first, 1 - cost - late[0])
    assert executed(handlers, length, first, late) <= handlers.within(length)
