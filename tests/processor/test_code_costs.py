"""Costs of compiled code besides its accesses: between them, in the passes of a wait, around a service routine."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from periph_sim.f28335.cpu.code_costs import BARE, CodeCosts
from periph_sim.f28335.descriptor import Frame
from tests.processor.bench import Bench


def bench_with(changes: list[tuple[int, int, int]] | None = None, *, skip_polls: bool = True, **costs: int) -> Bench:
    return Bench(changes or [], code=replace(BARE, **costs), skip_polls=skip_polls)


@pytest.mark.parametrize("between", [0, 1, 5, 15])
def test_every_access_includes_the_cost_of_the_code_before_it(between):
    bench = bench_with(between_accesses=between)

    def main() -> None:
        bench.flags.STATUS.all = 0
        bench.note("write")
        bench.cpu.compute(3)  # until the protection is over
        _ = bench.flags.STATUS.all
        bench.note("read")
        bench.flags.STATUS.C = 1
        bench.note("field")

    log = bench.run(main, 200)
    costs = [b - a for (_, a), (_, b) in pairwise([("begin", 0), *log])]
    assert costs == [between + 1, 3 + between + 3, between + 3]


def test_code_between_write_and_read_passes_within_the_protection():
    """The protection takes 3 cycles, less the 2 of the code."""
    bench = bench_with(between_accesses=2)

    def main() -> None:
        bench.flags.STATUS.all = 0
        _ = bench.flags.STATUS.all
        bench.note("end")

    assert bench.run(main, 100) == [("end", 2 + 1 + 2 + 1 + 3)]


def test_an_interrupt_is_taken_between_two_accesses():
    bench = bench_with([(100, 0, 0)], between_accesses=200)
    bench.cpu.program.handle("SEQ1INT", lambda: bench.note("routine"))
    bench.enable()

    def main() -> None:
        bench.flags.STATUS.all = 0
        bench.note("end")

    assert bench.run(main, 400) == [("routine", 114), ("end", 201 + 10 + 8)]


def polls(bench: Bench, pass_cycles: int | None = None) -> list[int]:
    """Return the cycles at which a wait for the flag A has read it."""
    found: list[int] = []

    def condition() -> int:
        value = bench.flags.STATUS.A
        found.append(bench.cpu.cycle)
        return value

    bench.run(lambda: bench.waits.spin(condition, pass_cycles=pass_cycles), 600)
    return found


def test_passes_of_a_wait_do_not_include_the_cost_between_accesses():
    benches = [bench_with([(200, 1, -1)], skip_polls=False, between_accesses=cycles) for cycles in (0, 9)]
    assert polls(benches[0]) == polls(benches[1])


@pytest.mark.parametrize("loop", [7, 10, 21])
def test_poll_pass_is_the_distance_between_two_polls(loop):
    reads = polls(bench_with([(500, 1, -1)], skip_polls=False, poll_pass=loop))
    assert {b - a for a, b in pairwise(reads)} == {loop}


@pytest.mark.parametrize(("length", "took"), [(9, 9), (12, 12), (21, 21), (2, 3)])
@pytest.mark.parametrize("frame", [Frame.PF1, Frame.PF2])
def test_a_wait_may_have_its_own_pass_length(length, took, frame):
    """It is never less than the reads take: 3 cycles for one of frame 1 or 2."""
    reads = polls(Bench([(500, 1, -1)], code=CodeCosts(), skip_polls=False, frame=frame), length)
    assert {b - a for a, b in pairwise(reads)} == {took}


def test_a_pass_of_two_reads_takes_its_length_whether_one_or_both_are_made():
    bench = bench_with([(100, 2, -1), (200, 0, -1), (300, 3, -1)], skip_polls=False)
    flags = bench.flags
    begins: list[int] = []

    def condition() -> bool:
        begins.append(bench.cpu.cycle)
        return bool(flags.STATUS.B == 1 and flags.STATUS.A == 1)

    bench.run(lambda: bench.waits.spin(condition, pass_cycles=25), 600)
    assert {b - a for a, b in pairwise(begins)} == {25}


def test_a_stall_and_a_service_routine_lengthen_a_pass():
    """The first read waits 3 cycles for a write; a routine of 10 + 20 + 8 cycles interrupts the second pass."""
    bench = Bench([(40, 0, 0), (200, 1, -1)], skip_polls=False)
    bench.cpu.program.handle("SEQ1INT", lambda: bench.cpu.compute(20))
    bench.enable()
    begins: list[int] = []

    def condition() -> int:
        begins.append(bench.cpu.cycle)
        return bench.flags.STATUS.A

    def main() -> None:
        bench.flags.STATUS.all = 0
        bench.waits.spin(condition, pass_cycles=30)

    bench.run(main, 300)
    assert [b - a for a, b in pairwise(begins)][:4] == [33, 30 + 38, 30, 30]


def test_a_service_routine_includes_prologue_and_epilogue():
    bench = bench_with([(100, 0, 0)], isr_prologue=17, isr_epilogue=13)
    bench.cpu.program.handle("SEQ1INT", lambda: bench.note("routine"))
    bench.enable()

    def main() -> None:
        bench.cpu.compute(200)
        bench.note("end")

    entry, iret = 10, 8
    assert bench.run(main, 600) == [("routine", 114 + 17), ("end", 200 + entry + 17 + 13 + iret)]


# Waits that time out ---------------------------------------------------------------------


@pytest.mark.parametrize("skip", [True, False])
@pytest.mark.parametrize(
    ("flag", "timeout", "came", "end"),
    [
        (None, 25, False, 30 + 4),  # passes of 10 cycles: the third ends at 30
        (None, 30, False, 30 + 4),
        (None, 31, False, 40 + 4),
        (None, 0, False, 10 + 4),  # at least one pass
        (12, 25, True, 12 + 1 + 4),  # seen by the read of the second pass
        (23, 25, False, 30 + 4),  # the read after it would be at 32
        (22, 25, True, 22 + 1 + 4),
    ],
)
def test_a_wait_times_out_at_the_end_of_the_pass_in_which_its_timeout_elapses(flag, timeout, came, end, skip):
    bench = bench_with([] if flag is None else [(flag, 1, -1)], skip_polls=skip)

    def main() -> None:
        bench.note(str(bench.waits.spin(lambda: bench.flags.STATUS.A == 1, timeout=timeout)))

    assert bench.run(main, 200) == [(str(came), end)]


def test_a_long_wait_that_times_out_costs_a_few_events():
    bench = bench_with()
    bench.run(
        lambda: bench.note(str(bench.waits.spin(lambda: bench.flags.STATUS.A, timeout=1_000_000_000))),
        1_100_000_000,
    )
    ((what, cycle),) = bench.log
    assert (what, cycle) == ("False", 1_000_000_000 + 4)
    assert bench.kernel.events <= 3
    assert bench.cpu.program.polls_skipped == 100_000_000 - 1


CHANGES = st.lists(st.tuples(st.integers(1, 400), st.integers(0, 3), st.sampled_from([-1, -1, -1, 0, 1])), max_size=14)


@given(
    changes=CHANGES,
    lead=st.integers(0, 40),
    timeout=st.integers(0, 150),
    length=st.none() | st.integers(1, 40),
    costs=st.builds(CodeCosts, st.integers(0, 6), st.integers(3, 31), st.integers(0, 20), st.integers(0, 20)),
)
def test_skipping_equals_polling_for_any_costs_and_timeouts(changes, lead, timeout, length, costs):
    def log_of(skip: bool) -> list[tuple[str, int]]:
        bench = Bench(list(changes), code=costs, skip_polls=skip)
        flags, cpu = bench.flags, bench.cpu

        def routine(name: str) -> None:
            bench.note(f"{name} {bench.waits.spin(lambda: flags.STATUS.B == 0, timeout=timeout // 2)}")
            bench.pie_regs.PIEACK.all = 1

        cpu.program.handle("SEQ1INT", lambda: routine("1"))
        cpu.program.handle("SEQ2INT", lambda: routine("2"))
        bench.enable()

        def main() -> None:
            cpu.compute(lead)
            while True:
                came = bench.waits.spin(lambda: flags.STATUS.A or flags.STATUS.B, pass_cycles=length, timeout=timeout)
                bench.note(f"came {came}")
                bench.note(f"gone {bench.waits.spin(lambda: not flags.STATUS.A, pass_cycles=length)}")
                flags.STATUS.C = 1

        return bench.run(main, 900)

    assert log_of(True) == log_of(False)
