"""Waits at their edges: with a write on its way, and how much of a wait is made for real."""

from __future__ import annotations

import pytest
from msgspec.structs import replace

from periph_sim.f28335.cpu.compiled_code_costs import BARE
from periph_sim.f28335.system_options import SystemOptions
from tests.processor.bench import Bench


def test_a_write_on_its_way_lands_though_the_wait_behind_it_is_skipped():
    """A pass of 3 cycles, its read outside of the block; the write before it lands 4 cycles after its issue."""
    bench = Bench([(1, 4, -1)], options=SystemOptions(write_lands=4), code=replace(BARE, poll_pass=3))

    def main() -> None:
        bench.cpu.compute(10)
        bench.flags.STATUS.all = 4  # C, which a 1 clears
        bench.note(f"{bench.cpu.spin(lambda: bench.pie_regs.PIEIER1.INTx1, timeout=100)} C={bench.chip.status}")

    assert bench.run(main, 50) == []
    assert bench.chip.status == 0, "the wait still lasts"


def test_a_wait_is_skipped_on_behind_an_interrupt_that_cut_into_it():
    """Passes of 6 cycles up to the flag in cycle 9000: all but a handful are skipped."""
    bench = Bench([(100, 0, 0), (9000, 1, -1)], code=replace(BARE, poll_pass=6))
    bench.enable()
    bench.cpu.handle("SEQ1INT", lambda: bench.note("served"))

    def main() -> None:
        bench.cpu.spin(lambda: bench.flags.STATUS.A == 1)
        bench.note("seen")

    assert bench.run(main, 10_000) == [("served", 115), ("seen", 9007)]
    assert bench.cpu.program.polls_skipped > 1490 and bench.kernel.events == 5


def test_an_interrupt_asked_for_behind_a_wait_waits_for_the_end_of_an_instruction():
    """The write behind the wait asks for it; the instruction of 1000 cycles goes on, and B rises meanwhile."""
    bench = Bench([(1000, 1, -1), (1500, 3, -1)])
    bench.enable()
    bench.cpu.handle("SEQ1INT", lambda: bench.note("served"))
    write = bench.chip.write

    def ask(now: int, offset: int, value: int) -> None:
        write(now, offset, value)
        bench.chip.requests |= 1

    bench.chip.write = ask  # type: ignore[method-assign]

    def main() -> None:
        bench.cpu.spin(lambda: bench.flags.STATUS.A == 1)
        bench.flags.STATUS.all = 0
        bench.cpu.instruction(1000)
        bench.note(f"B={bench.flags.STATUS.B}")

    assert bench.run(main, 5000) == [("served", 2018), ("B=1", 2029)]
    assert bench.kernel.events == 5


def asked(
    changes: list[tuple[int, int, int]], work: int = 0, *, skip: bool = True
) -> tuple[list[tuple[str, int]], int]:
    """What a wait for A, with `work` cycles in its condition, sees on a bench; how often the condition was asked."""
    bench = Bench(changes, code=replace(BARE, poll_pass=10), skip_polls=skip)
    asked: list[int] = []

    def condition() -> bool:
        asked.append(bench.cpu.cycle)
        bench.cpu.compute(work)
        return bool(bench.flags.STATUS.A)

    def main() -> None:
        bench.cpu.spin(condition)
        bench.note("seen")

    return bench.run(main, 600), len(asked)


def test_a_condition_is_asked_again_only_where_a_bit_that_it_read_differs():
    """A comes and goes between two reads three times; then it comes and stays."""
    glitches = [(104, 1, -1), (107, 0, -1), (204, 1, -1), (207, 0, -1), (304, 1, -1), (307, 0, -1)]
    seen, times = asked([*glitches, (400, 1, -1)])
    assert times == 2  # the first pass, and the one that ends the wait
    polled, every_pass = asked([*glitches, (400, 1, -1)], skip=False)
    assert seen == polled == [("seen", 402 + 1 + 4)] and every_pass == 41


@pytest.mark.parametrize("work", [1, 7])
def test_a_condition_that_takes_time_of_its_own_is_asked_in_each_pass_that_is_made(work):
    glitches = [(104, 1, -1), (105, 0, -1), (204, 1, -1), (206, 0, -1), (304, 1, -1), (309, 0, -1), (400, 1, -1)]
    seen, times = asked(glitches, work)
    polled, every_pass = asked(glitches, work, skip=False)
    assert seen == polled and 2 < times < every_pass
