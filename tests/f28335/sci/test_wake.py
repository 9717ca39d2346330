"""The SCI requests its wake-ups in time: nothing changes in a cycle without an input or a requested wake-up."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.f28335.sci.register_map import SCI_MAP
from tests.f28335.sci_rig import SciRig, frame

pytestmark = pytest.mark.long

BUSY = {
    "standard": {"RXBKINTENA": 1, "TXINTENA": 1, "RXERRINTENA": 1},
    "fifo": {"fifo": 1, "RXFFIL": 1, "TXFFIL": 1, "RXFFIENA": 1, "TXFFIENA": 1, "FFTXDLY": 3},
    "loop back": {"fifo": 1, "LOOPBKENA": 1, "RXFFIL": 2, "RXFFIENA": 1},
    "address bit": {"ADDRIDLE_MODE": 1, "SLEEP": 1, "RXBKINTENA": 1},
}


def make(kind: str) -> SciRig:
    fields = dict(BUSY[kind])
    return SciRig(brr=1, fifo=bool(fields.pop("fifo", 0)), **fields)


def inputs(begin: int, words: list[int], kind: str) -> list[tuple[int, str, int]]:
    """Return (time, signal, level) of frames, a framing error and a break on RXD, and of writes to SCITXBUF."""
    played: list[tuple[int, str, int]] = []
    address = 1 if kind == "address bit" else None
    text = "".join(frame(word, address=address) + "1" * (word % 3) for word in words)
    text += frame(0x55, address=address, bad="stop") + "1" * 14 + frame(0x0F, address=address) + "0" * 24 + "1" * 4
    before = "1"
    for i, mark in enumerate(text):
        if mark != before:
            played.append((begin + 13 + i * 63, "RXD", int(mark)))
            before = mark
    for i, word in enumerate(words):
        played.append((begin + 5 + i * 331, "SCITXBUF", word))
    return sorted(played)


def registers(rig: SciRig) -> list[int]:
    return [rig.peek(register.name) for register in SCI_MAP]


@pytest.mark.parametrize("kind", BUSY)
def test_nothing_changes_in_a_cycle_without_input_or_due_wake_up(kind):
    rig = make(kind)
    due = inputs(rig.now, [0x4B, 0x00, 0xFF, 0x96], kind)
    end = due[-1][0] + 400
    now = rig.now
    before = (rig.chip.out, rig.chip.requests, registers(rig))
    while now < end:
        now += 1
        requested = rig.chip.next_wake == now
        played = [row for row in due if row[0] == now]
        for _, signal, level in played:
            rig.drive(now, signal, level)
        rig.run_until(now)
        after = (rig.chip.out, rig.chip.requests, registers(rig))
        assert after == before or requested or played, f"cycle {now}"
        before = after
    assert len(rig.edges) > 10 or kind == "address bit"


@settings(max_examples=15, deadline=None)
@given(kind=st.sampled_from(list(BUSY)), words=st.lists(st.integers(0, 255), min_size=1, max_size=5))
def test_early_wake_ups_and_debugger_reads_change_nothing(kind, words):
    quiet, disturbed = make(kind), make(kind)
    for rig in (quiet, disturbed):
        due = inputs(rig.now, words, kind)
        for time, signal, level in due:
            while rig is disturbed and rig.now + 7 < time:
                rig.wait(cycles=7)
                rig.chip.wake(rig.now)
                rig.observe()
                registers(rig)
            rig.drive(time, signal, level)
        rig.wait(30)
    assert disturbed.edges == quiet.edges
    assert (disturbed.requested["RXINT"], disturbed.requested["TXINT"]) == (
        quiet.requested["RXINT"],
        quiet.requested["TXINT"],
    )
    assert registers(disturbed) == registers(quiet)


def test_an_idle_module_requests_no_wake_up():
    rig = SciRig(brr=487)
    rig.wait(40)
    woken = 0
    while rig.chip.next_wake < rig.now + 10**7:
        rig.run_until(rig.chip.next_wake)
        woken += 1
    assert woken <= 1


@pytest.mark.parametrize("kind", BUSY)
def test_an_access_includes_changes_due_in_its_cycle(kind):
    # An access that precedes the wake-up in the same cycle finds all changes of that cycle applied.
    woken, not_woken = make(kind), make(kind)
    due = inputs(woken.now, [0x4B, 0x00], kind)
    end = due[-1][0] + 400
    while woken.chip.next_wake < end or due:
        now = woken.chip.next_wake
        while due and due[0][0] <= now:
            time, signal, level = due.pop(0)
            woken.drive(time, signal, level)
            not_woken.drive(time, signal, level)
            now = woken.chip.next_wake
        if now >= end:
            continue
        woken.run_until(now)
        not_woken.now = now
        offset = SCI_MAP["SCIRXST"].offset
        assert not_woken.chip.read(now, offset) == woken.chip.read(now, offset)
        not_woken.observe()
        assert registers(not_woken) == registers(woken)
        assert not_woken.chip.out == woken.chip.out


ANY_ACTION = st.one_of(
    st.tuples(st.just("RXD"), st.integers(0, 1)),
    st.tuples(st.just("READ"), st.just(0)),
    st.tuples(st.sampled_from(["GATE", "SUSPEND"]), st.integers(0, 1)),
    st.tuples(st.sampled_from(["SCICCR", "SCICTL2", "SCITXBUF", "SCIPRI", "SCILBAUD"]), st.integers(0, 255)),
    st.tuples(st.just("SCICTL1"), st.sampled_from([0x03, 0x23, 0x23, 0x22, 0x21, 0x27, 0x2B, 0x63])),
    st.tuples(st.just("SCIFFTX"), st.sampled_from([0xE000, 0xE040, 0xE063, 0xA000, 0xC000, 0x6000])),
    st.tuples(st.just("SCIFFRX"), st.sampled_from([0x201F, 0x2021, 0x6062, 0x0000])),
    st.tuples(st.just("SCIFFCT"), st.sampled_from([0x0000, 0x0003, 0x2000, 0x4000, 0x6001])),
    st.tuples(st.sampled_from(["TXWAKE", "SLEEP", "SWRESET", "TXENA", "RXENA", "LOOPBKENA"]), st.integers(0, 1)),
)


@settings(max_examples=60, deadline=None)
@given(script=st.lists(st.tuples(st.integers(0, 1500), ANY_ACTION), min_size=3, max_size=40))
def test_early_wake_ups_and_debugger_reads_change_nothing_with_any_inputs(script):
    quiet, disturbed = SciRig(brr=1), SciRig(brr=1)
    nap = 37
    for gap, (signal, level) in script:
        time = quiet.now + gap
        quiet.drive(time, signal, level)
        while disturbed.now + nap < time:
            disturbed.wait(cycles=nap)
            disturbed.chip.wake(disturbed.now)
            disturbed.observe()
            registers(disturbed)
        disturbed.drive(time, signal, level)
        assert registers(disturbed) == registers(quiet)
        assert disturbed.edges == quiet.edges
        assert (disturbed.requested["RXINT"], disturbed.requested["TXINT"]) == (
            quiet.requested["RXINT"],
            quiet.requested["TXINT"],
        )
