"""Pairs of events: pairing rules, counts between two events, and pairs that the end of the run cuts off."""

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
from tests.timing.events_by_hand import ONE, feed, pairs, played, records, scene_of, summary
from tests.timing.judges import judge

RISES = "from edge SCL rise to edge SDA rise"


def drawn(scl: str, sda: str) -> list[Record]:
    """Records of the rises of two wires. A column is a tick, and `|` is a rise."""
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
def test_the_rule_determines_the_pairs_if_two_events_wait(rule: str, found: list[tuple[int, int]]):
    of = drawn(
        "| |     |    ",
        "     |    |  |",
    )
    assert pairs(played(f"{RISES}{rule}", of, keep=True)) == found


def test_ambiguous_pairs_without_a_rule_are_not_judged():
    measure = played(RISES, drawn("|   |  |  ", "  |      |"))
    assert measure.silent and measure.missing() == (
        "'edge SCL rise' came at 0.000000 s and again at 0.000000 s before 'edge SDA rise'; "
        "add after a comma which belong together: in order, next or last"
    )
    clear = played(RISES, drawn("|   |  ", "  |   |"), keep=True)
    assert not clear.silent and pairs(clear) == [(2, 0), (2, 4)]


def test_an_unfinished_wait_counts_if_it_is_the_longest():
    measure = played(f"{RISES}, in order", drawn("| | |  ", " |     "), 20)
    assert measure.close(20) == "'edge SCL rise' still waited for 'edge SDA rise' when the run ended"
    assert summary(measure) == (18, 2, 1, 3) and measure.cut_off == 2
    short = played(RISES, drawn("|     |", "    |  "), 9)
    assert (short.close(9), summary(short)) == ("", (4, 0, 4, 1))


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


def test_with_same_transfer_the_first_event_waits_only_until_the_stop():
    measure = played(f"{RISES}, same transfer", HUNG, 90)
    assert measure.close(90) != "" and (measure.worst, measure.count, measure.measured, measure.occasions) == (
        58,
        2,
        1,
        1,
    )
    over = played(f"{RISES}, same transfer", HUNG + "40 bus controller STOP 0", 90)
    assert over.close(90) == "" and (over.worst, over.count, over.measured, over.occasions) == (3, 1, 1, 2)


def test_transfers_in_which_only_the_first_event_occurred_are_occasions():
    of = "".join(
        f"{t}0 bus controller START 0\n{t}1 edge SCL level 1\n{t}5 bus controller STOP 0\n" for t in range(1, 9)
    )
    budget = Budget(name="b", measure=f"{RISES}, same transfer", max="1 s")
    limit = judge(budget, ONE)
    limit.measure.listen(scene_of())
    feed(limit.measure, records(of.replace("12 ", "12 ") + "84 edge SDA level 1"))
    limit.finish(999)
    verdict = limit.verdict()
    assert (verdict.verdict, verdict.counted) == ("not judged", "1 of 8")
    assert verdict.found == "measured 1 of 8 transfers with 'edge SCL rise', less than 90 %"


# Counts between two events ---------------------------------------------------------------------------


def test_a_count_between_two_events():
    of = drawn(
        "|    |    ",
        "   |     |",
    ) + records("1 irq dsp SCIRXINTA 1\n2 irq dsp SCIRXINTA 1\n4 irq dsp SCIRXINTA 1\n8 irq dsp SCIRXINTA 1")
    of.sort(key=lambda record: record.tick)
    measure = played("count of interrupt SCIRXINTA enter from edge SCL rise to edge SDA rise", of)
    assert (summary(measure), measure.unit) == ((2, 0, 1, 2), "count")


@given(st.lists(st.sampled_from("ABX"), max_size=30))
def test_a_count_between_agrees_with_a_loop_over_the_records(events: list[str]):
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
    """Firmware that processes each byte for 500 us and sends it back."""
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


def test_in_order_gives_the_true_worst_echo_of_twelve_waiting_bytes():
    """The n-th byte begins n * 86.8 us after the first one, and is sent back 500 us after the one before."""
    in_order, without_rule, next_one = echoed(
        "from frame RX to frame TX, in order",
        "from frame RX to frame TX",
        "from frame RX to frame TX, next",
    )
    assert in_order.broken and in_order.count == 12
    assert in_order.worst == pytest.approx(12 * 500 + 85 - 11 * 86.8, abs=12)
    assert (without_rule.verdict, without_rule.worst) == (
        "not judged",
        None,
    ) and "add after a comma" in without_rule.found
    assert next_one.worst < 600


def test_a_bus_held_until_the_end_breaks_the_budget_on_stretch():
    """SDIR is cleared along with SCD. The firmware waits for it, and SCL is held, until the end of the run."""
    budget = 'budget=[{name="s", measure="stretch", max="50 us"}, {name="r", measure="response", max="1 s"}]'
    late = ("unit.dsp.settings.frame_cost=200 us", "controller.stuck_after=9 s")
    ran = run_file("imu_hil_drift", "0.47", budget, *late)
    stretch = ran.result.budgets[0]
    assert stretch.broken and stretch.worst > 5000
    assert stretch.found == "SCL was still held low when the run ended"
