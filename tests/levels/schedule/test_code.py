"""Straight-line code: an interrupt is taken at the first boundary behind its latch; waits for writes vanish in it."""

from __future__ import annotations

import numpy as np
import pytest

from periph_sim.f28335.cpu.compiled_code_costs import CodeCosts
from periph_sim.f28335.system.options import SystemOptions
from periph_sim.levels.schedule.code import Access, Code, CodeTable, CodeTiming
from periph_sim.levels.schedule.lanes import FAR, Interrupts
from periph_sim.levels.schedule.stored import Stored

TIMING = CodeTiming(CodeCosts(between_accesses=5), SystemOptions(), service=100)
WRITE = Access("W", "I2C-A.I2CCNT")
FIELD = Access("M", "I2C-A.I2CMDR", "TRX")


def test_a_write_lands_and_the_first_read_of_the_next_wait_waits_for_it():
    path = Code((WRITE,), TIMING).path()
    assert path.lands == (12,)  # 1 + 4, between 5, posted at 10
    assert path.length == 16  # posted + 1, 3 cycles of write-to-read protection, 2 wait states


def test_a_field_is_read_and_written_by_one_instruction():
    path = Code((FIELD,), TIMING).path()
    assert (path.reads, path.lands, path.length) == ((12,), (14,), 18)


@pytest.mark.parametrize(
    ("latch", "lands", "length"),
    [
        (-1, 112, 116),  # the read that ended the wait was under way
        (1, 112, 116),
        (2, 112, 116),  # within the branch: at its end, 5
        (10, 112, 116),  # at the boundary before the write
        (11, 12, 113),  # behind it: the write lands meanwhile, and nothing is left to wait for
    ],
)
def test_an_interrupt_delays_what_comes_behind_its_boundary(latch: int, lands: int, length: int):
    path = Code((WRITE,), TIMING).path(latch)
    assert (path.lands, path.length) == ((lands,), length)


def test_the_table_has_each_latch_that_meets_the_code():
    code = Code((WRITE, FIELD), TIMING)
    table = CodeTable(code, [("lands", 0), ("read", 1)])
    assert (table.first, table.last) == (-1, 19)  # the boundary behind the field; then the first read waits for it
    assert [code.path(latch).length - table.length for latch in (19, 20, table.length)] == [97, 0, 0]
    for latch in range(table.first, table.last + 1):
        path, place = code.path(latch), latch - table.first
        assert table.lengths[place] == path.length
        assert [by_latch[place] for _, by_latch in table.marks] == [path.lands[0], path.reads[1]]


def polled(first: int, flag: int, poll: int, latches: list[int], service: int, waits: int) -> int:
    """A wait pass by pass: a fetch behind its wait states, a boundary behind it, the branch back, a boundary."""
    cycle, left = first - waits, sorted(latches)

    def boundary(now: int) -> int:
        while left and left[0] <= now:
            left.pop(0)
            now += service
        return now

    while True:
        cycle += waits
        if cycle >= flag:
            return cycle
        cycle = boundary(cycle + 1)
        cycle = boundary(cycle + poll - waits - 1)


@pytest.mark.parametrize("poll", [10, 17])
def test_a_wait_with_interrupts_ends_as_pass_by_pass(poll: int):
    service, waits, first = 100, 2, 7
    for flag in (0, 7, 8, 40, 41, 300):
        for latch in range(first - 1, 60):
            latches = [latch, latch + 130]
            one = Interrupts(Stored.of(np.array([[max(latch, 0)], [latch + 130], [FAR]])), service, waits)
            lanes = one.lanes(np.array([0]))
            came = lanes.wait(np.array([first]), np.array([flag]), poll)
            assert came[0] == polled(first, flag, poll, latches, service, waits), (flag, latch)
