"""Pairs of events: which belong together, what happens in between, and what the end of the run cuts off."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim import Dsp, Verdict
from periph_sim.core.records import Kind, Record
from periph_sim.firmware import sci_fifo_receiver
from periph_sim.timing.budget_schema import Budget
from tests.scene.runs import run_file
from tests.scene.small import scene_with
from tests.timing.events_by_hand import ONE, came, pairs, played, records, scene_of, tell
from tests.timing.judges import judge

RISES = "from edge SCL rise to edge SDA rise"


def drawn(scl: str, sda: str) -> list[Record]:
    """Rises of two wires, a column a tick: `|` is one."""
    rises = [(tick, "SCL") for tick, c in enumerate(scl) if c == "|"]
    rises += [(tick, "SDA") for tick, c in enumerate(sda) if c == "|"]
    return records("\n".join(f"{tick} edge {wire} level 1" for tick, wire in sorted(rises)))


@pytest.mark.parametrize(
    ("rule", "found"),
    [
        (", in order", [(5, 0), (8, 2), (5, 8)]),
        (", next", [(5, 0), (3, 2), (2, 8)]),
        (", last", [(3, 2), (2, 8)]),
    ],
)
def test_where_two_wait_the_rule_says_which_belongs_to_which(rule: str, found: list[tuple[int, int]]):
    of = drawn(
        "| |     |    ",
        "     |    |  |",
    )
    assert pairs(played(f"{RISES}{rule}", of, keep=True)) == found


def test_without_a_rule_it_is_refused_to_guess():
    told = played(RISES, drawn("|   |  |  ", "  |      |"))
    assert told.silent and told.missing() == (
        "'edge SCL rise' came at 0.000000 s and again at 0.000000 s before 'edge SDA rise'; "
        "add after a comma which belong together: in order, next or last"
    )
    clear = played(RISES, drawn("|   |  ", "  |   |"), keep=True)
    assert not clear.silent and pairs(clear) == [(2, 0), (2, 4)]


def test_what_waits_counts_with_what_it_has_waited_if_that_is_most():
    told = played(f"{RISES}, in order", drawn("| | |  ", " |     "), 20)
    assert told.close(20) == "'edge SCL rise' still waited for 'edge SDA rise' when the run ended"
    assert came(told) == (18, 2, 1, 3) and told.cut_off == 2
    short = played(RISES, drawn("|     |", "    |  "), 9)
    assert (short.close(9), came(short)) == ("", (4, 0, 4, 1))


@given(st.lists(st.tuples(st.integers(0, 3), st.sampled_from("AB")), max_size=30))
def test_in_order_is_a_queue(events: list[tuple[int, str]]):
    tick, of = 0, []
    queue: list[int] = []
    wanted = []
    for step, what in events:
        tick += step
        of.append(Record(len(of) + 1, tick, Kind.EDGE, "SCL" if what == "A" else "SDA", "level", 1, "", 0))
        if what == "A":
            queue.append(tick)
        elif queue:
            began = queue.pop(0)
            wanted.append((tick - began, began))
    assert pairs(played(f"{RISES}, in order", of, keep=True)) == wanted


HUNG = """
    10 bus  controller START 0
    12 edge SCL level 1
    15 edge SDA level 1
    20 bus  controller STOP 0
    30 bus  controller START 0
    32 edge SCL level 1
"""


def test_in_a_transfer_that_goes_on_a_first_one_still_waits_and_behind_its_stop_it_does_not():
    told = played(f"{RISES}, same transfer", HUNG, 90)
    assert told.close(90) != "" and (told.worst, told.count, told.measured, told.occasions) == (58, 2, 1, 1)
    over = played(f"{RISES}, same transfer", HUNG + "40 bus controller STOP 0", 90)
    assert over.close(90) == "" and (over.worst, over.count, over.measured, over.occasions) == (3, 1, 1, 2)


def test_transfers_whose_first_one_had_no_second_are_occasions():
    of = "".join(
        f"{t}0 bus controller START 0\n{t}1 edge SCL level 1\n{t}5 bus controller STOP 0\n" for t in range(1, 9)
    )
    budget = Budget(name="b", measure=f"{RISES}, same transfer", max="1 s")
    limit = judge(budget, ONE)
    limit.measure.listen(scene_of())
    tell(limit.measure, records(of.replace("12 ", "12 ") + "84 edge SDA level 1"))
    limit.finish(999)
    verdict = limit.verdict()
    assert (verdict.verdict, verdict.counted) == ("not judged", "1 of 8")
    assert verdict.found == "measured 1 of 8 transfers with 'edge SCL rise', less than 90 %"


# How often something happens in between ---------------------------------------------------------------------------


def test_a_count_between_two_events():
    of = drawn(
        "|    |    ",
        "   |     |",
    ) + records("1 irq dsp SCIRXINTA 1\n2 irq dsp SCIRXINTA 1\n4 irq dsp SCIRXINTA 1\n8 irq dsp SCIRXINTA 1")
    of.sort(key=lambda record: record.tick)
    told = played("count of interrupt SCIRXINTA enter from edge SCL rise to edge SDA rise", of)
    assert (came(told), told.unit) == ((2, 0, 1, 2), "count")


@given(st.lists(st.sampled_from("ABX"), max_size=30))
def test_a_count_between_is_what_a_walk_over_the_records_gives(events: list[str]):
    wires = {"A": (Kind.EDGE, "SCL", "level"), "B": (Kind.EDGE, "SDA", "level"), "X": (Kind.FRAME, "TX", "begin")}
    of = [Record(i, i, *wires[e], int(e != "X"), "", 0) for i, e in enumerate(events)]
    wanted = []
    for at, what in enumerate(events):
        end = next((i for i, other in enumerate(events) if i > at and other == "B"), None)
        if what == "A" and end is not None:
            wanted.append((events[at:end].count("X"), at))
    assert pairs(played("count of frame TX from edge SCL rise to edge SDA rise, next", of, keep=True)) == wanted


# Echoes -----------------------------------------------------------------------------------------------------------


def echo(dsp: Dsp) -> None:
    """Takes 500 us over each byte, and sends it back."""
    sci_fifo_receiver(dsp, brr=40, level=1)
    sci = dsp.module("SCI-A")
    sci.SCIFFTX.TXFIFOXRESET = 1
    while True:
        dsp.spin(lambda: sci.SCIFFRX.RXFFST != 0)
        byte = sci.SCIRXBUF.all & 0xFF
        dsp.compute(75_000)
        sci.SCITXBUF.all = byte


def echoed(*measures: str) -> list[Verdict]:
    budgets: list[dict[str, Any]] = [{"name": m, "measure": m, "max": "1 ms"} for m in measures]
    scene = scene_with(echo, ["SCI-A", "GPIO"], duration="15 ms", host={"baud": 115200, "frames": 1}, budget=budgets)
    return scene.run().budgets


def test_an_echo_of_500_us_a_byte_with_twelve_waiting_gives_the_true_worst():
    """The n-th byte begins n * 86.8 us behind the first one and is back 500 us behind the one before."""
    in_order, unsaid, next_one = echoed(
        "from frame RX to frame TX, in order",
        "from frame RX to frame TX",
        "from frame RX to frame TX, next",
    )
    assert in_order.broken and in_order.count == 12
    assert in_order.worst == pytest.approx(12 * 500 + 85 - 11 * 86.8, abs=12)
    assert (unsaid.verdict, unsaid.worst) == ("not judged", None) and "add after a comma" in unsaid.found
    assert next_one.worst < 600


def test_a_bus_that_is_held_to_the_end_breaks_stretch():
    """SDIR is cleared with SCD; the firmware waits for it, and SCL is held, for the rest of the run."""
    budget = 'budget=[{name="s", measure="stretch", max="50 us"}, {name="r", measure="response", max="1 s"}]'
    late = ("unit.dsp.settings.frame_cost=200 us", "controller.stuck_after=9 s")
    ran = run_file("imu_hil_drift", "0.47", budget, *late)
    stretch = ran.result.budgets[0]
    assert stretch.broken and stretch.worst > 5000
    assert stretch.found == "SCL was still held low when the run ended"
