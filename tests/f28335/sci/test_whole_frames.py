"""Frames whose inner edges pass at once: when an SCI hears one whole; edges of TXD are taken and given back."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.f28335.sci.module import Sci
from tests.f28335.sci_rig import SciRig, frame


def hears_whole(rig: SciRig, second: float = 1, last: float = 9) -> bool:
    """A frame that falls now, with these bit times of its next edge and its last."""
    now = rig.now
    return rig.chip.hears_whole(now, now + round(second * rig.bit), now + round(last * rig.bit))


@pytest.mark.parametrize(
    ("fields", "second", "last", "whole"),
    [
        ({}, 1, 9, True),
        ({}, 9, 9, True),
        ({}, 1, 9.8, True),
        ({}, 1, 10, False),  # its own frame is over before: another format, a slower sender
        ({"SCICHAR": 6}, 1, 9, False),
        ({"ADDRIDLE_MODE": 1}, 1, 10, True),
        ({"LOOPBKENA": 1}, 1, 9, False),
        ({"CDC": 1}, 1, 9, False),  # autobaud measures edges
        ({"CDC": 1, "SWRESET": 0}, 1, 9, True),
        ({"SWRESET": 0}, 1, 90, True),  # it hears nothing
        ({"RXENA": 0}, 1, 9, True),
    ],
)
def test_a_frame_is_whole_where_nothing_comes_of_it_before_its_last_edge(
    fields: dict[str, int], second: float, last: float, whole: bool
):
    assert hears_whole(SciRig(**fields), second, last) == whole


def test_without_a_clock_nothing_comes_of_it_and_without_a_synchroniser_it_is_not_known():
    rig = SciRig()
    rig.chip.gate(rig.now, False)
    assert hears_whole(rig, last=90)
    assert not hears_whole(SciRig({"rx_sync_stages": 0}))


@pytest.mark.parametrize(
    ("sent", "second", "whole"),
    [
        ("0 1111 11", 1, False),  # in the middle of a frame
        ("0 00000000 1", 1, True),  # behind one that is all but over
        ("0 00000000 1", 0.02, False),  # unless the next edge comes before it is
        ("0 00000000 0", 1, False),  # a break may be coming
        ("0 00000000 0 1", 1, True),
    ],
)
def test_behind_another_frame(sent: str, second: float, whole: bool):
    rig = SciRig()
    *bits, last = sent.replace(" ", "")
    rig.send("".join(bits))
    rig.line.rxd(rig.now, int(last))
    rig.wait(sciclk=6)  # the sender's clock is fast
    assert hears_whole(rig, second) == whole


FORMATS = ({}, {"PARITYENA": 1}, {"STOPBITS": 1}, {"SCICHAR": 4}, {"ADDRIDLE_MODE": 1})


def drawn(data: int, fields: dict[str, int]) -> str:
    parity, stops = "odd" if "PARITYENA" in fields else "none", 1 + fields.get("STOPBITS", 0)
    address = 0 if "ADDRIDLE_MODE" in fields else None
    bits = fields.get("SCICHAR", 7) + 1
    return frame(data & (1 << bits) - 1, bits, parity=parity, stops=stops, address=address)


@given(st.integers(0, 255), st.sampled_from(FORMATS), st.integers(0, 500), st.integers(-20, 20))
def test_edges_told_as_the_last_one_comes_leave_what_they_leave_one_by_one(
    data: int, fields: dict[str, int], phase: int, off: int
):
    shown = []
    for late in (False, True):
        rig = SciRig(**fields)
        rig.run_until(rig.now + phase)
        bit, at, level = rig.bit * (1000 + off) // 1000, rig.now, 1
        edges: list[tuple[int, int]] = []
        for n, to in enumerate(drawn(data, fields)):
            if int(to) != level:
                level = int(to)
                edges.append((at + n * bit, level))
        whole = rig.chip.hears_whole(edges[0][0], edges[1][0], edges[-1][0])
        for n, (cycle, to) in enumerate(edges):
            if n in (0, len(edges) - 1) or not late:
                rig.run_until(cycle)
            rig.chip.pins(cycle, to)
        due = rig.chip.next_wake
        rig.wait(2)
        shown.append((due, rig.peek("SCIRXST"), rig.peek("SCIRXBUF"), rig.chip.next_wake))
        assert whole
    assert shown[0] == shown[1]


def started(data: int) -> Sci:
    """An SCI that has just begun to send."""
    rig = SciRig()
    rig.write("SCITXBUF", data)
    chip = rig.chip
    while chip.out:
        chip.wake(chip.next_wake)
    return chip


def changes(chip: Sci, frames_end: int) -> list[int]:
    """The cycles in which TXD moves by itself."""
    found, level = [], chip.out
    while chip.next_wake < frames_end:
        now = chip.next_wake
        chip.wake(now)
        if chip.out != level:
            level = chip.out
            found.append(now)
    return found


@given(st.integers(0, 255), st.integers(0, 10))
def test_edges_that_are_taken_are_not_made_and_those_given_back_are(data: int, back: int):
    end = 10**6
    known = changes(started(data), end)
    chip = started(data)
    now = known[0] - 100
    coming = chip.coming_edges()
    assert coming == known
    chip.take_edges(now)
    assert chip.coming_edges() == [] and chip.out == 0
    inner = len(known) - 1
    back = min(back, inner)
    if not back:
        assert changes(chip, end) == known[-1:]
        return
    chip.give_back_edges(known[inner - back] - 1, back)
    assert chip.out == (inner - back) % 2
    assert changes(chip, end) == known[inner - back :]


def test_no_edges_are_told_of_in_loop_back_or_while_autobaud_may_change_the_rate():
    for fields in ({"LOOPBKENA": 1}, {"CDC": 1}):
        rig = SciRig(**fields)
        rig.write("SCITXBUF", 0x55)
        while rig.chip.out:
            rig.chip.wake(rig.chip.next_wake)
        assert rig.chip.coming_edges() == [], fields
