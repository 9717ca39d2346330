"""I2C master: outputs change only at inputs and at `next_wake`, and spurious wake-ups have no effect."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ..i2c_bus import SLOT, Bench, Edge, Foreign, Target, with_
from ..i2c_registers import OFFSET

pytestmark = pytest.mark.long

DATA = [0x5A, 0xC3]


def scene(name: str) -> Bench:
    """Return a bench whose module has just been given a transfer."""
    if name == "transmit":
        b = Bench(Target(stretch={(0, 9): 400, (1, 4): 1000}))
    elif name == "receive":
        b = Bench(Target(gives=DATA, stretch={(0, 9): 400, (1, 4): 1000}))
    elif name == "refused":
        b = Bench()
    elif name == "lost":
        b = Bench(Target(0x48), Foreign("S 48W 77 P", at=None))
    elif name == "slow rise":
        b = Bench(Target(), rise=45)
    else:
        b = Bench(own=0x2A)
    b.w("I2CIER", 0x7F)
    b.w("I2CCNT", 2)
    way = "" if name == "receive" else "TRX"
    b.mode(f"FREE MST {way} STT STP " + ("DLB" if name == "loopback" else ""))
    return b


SCENES = ["transmit", "receive", "refused", "lost", "slow rise", "loopback"]


def serve(b: Bench, left: list[int]) -> None:
    if left and b.flag("XRDY"):
        b.w("I2CDXR", left.pop(0))
    if b.flag("RRDY"):
        b.r("I2CDRR")


def visible_state(b: Bench) -> list[int]:
    return [b.m.out, b.m.requests, b.m.held, *(b.m.peek(b.now, offset) for offset in OFFSET.values())]


@pytest.mark.parametrize("name", SCENES)
def test_nothing_changes_in_a_cycle_without_input_or_due_wake(name: str):
    b = scene(name)
    left = list(DATA)
    for cycle in range(36 * SLOT):
        before, due = visible_state(b), b.nearest() <= b.now + 1
        b.run(1)
        if not due:
            assert visible_state(b) == before, f"at cycle {b.now}"
        if cycle % 40 == 0:
            serve(b, left)
    assert "P" in b.decoded() or name == "refused"


@pytest.mark.parametrize("name", SCENES)
def test_waking_too_early_changes_nothing(name: str):
    runs: list[list[Edge]] = []
    for nag in (False, True):
        b = scene(name)
        left = list(DATA)
        for _ in range(36 * SLOT // 10):
            b.run(10)
            if nag:
                b.m.wake(b.now)
                b.settle()
            serve(b, left)
        runs.append(b.edges)
    assert runs[0] == runs[1]


@settings(max_examples=25, deadline=None)
@given(
    st.lists(st.integers(0, 255), min_size=1, max_size=3),
    st.dictionaries(st.tuples(st.integers(0, 3), st.integers(1, 9)), st.integers(1, 3000), max_size=5),
    st.sampled_from([0, 15, 30, 100]),
    st.sampled_from([0, 1, 2]),
)
def test_any_bytes_with_any_stretch_rise_time_and_filter_arrive(
    data: list[int], stretch: dict[tuple[int, int], int], rise: int, width: int
):
    b = Bench(Target(stretch=stretch), rise=rise, options=with_(noise_filter_cycles=width))
    said = b.write_all(data)
    assert said == " ".join(["S 50W A", *(f"{d:02x} A" for d in data), "P"])
    b.target.gives = list(data)
    assert b.read_all(len(data)) == data
