"""The length of a bit depends on LSPCLK and BRR."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.f28335.sci_rig import SciRig, frame

SYSCLKOUT = 150_000_000


def bit_length(rig: SciRig, divider: int = 4) -> int:
    """Return the length of a bit on TXD in cycles, measured from the edges of a sent 0x55."""
    seen = len(rig.edges)
    rig.put(0x55, cycles=12 * 8 * divider * (max(rig.brr, 1) + 1))
    times = [time for time, _ in rig.edges[seen:]]
    lengths = {b - a for a, b in pairwise(times)}
    assert len(times) == 10
    assert len(lengths) == 1
    return lengths.pop()


@pytest.mark.rule("SCI-079", "SCI-080", "SCI-082", "SCI-028")
@pytest.mark.parametrize(("brr", "baud"), [(1952, 2400), (976, 4798), (487, 9606), (243, 19211), (121, 38422)])
def test_the_rates_in_the_table_of_the_manual(brr, baud):
    rig = SciRig(brr=brr)
    assert rig.flags("SCIHBAUD", "SCILBAUD") == {"SCIHBAUD": brr // 256, "SCILBAUD": brr % 256}
    assert 32 * (brr + 1) == bit_length(rig)
    # the manual rounds: 9605.5 is printed as 9606
    assert abs(SYSCLKOUT / (32 * (brr + 1)) - baud) <= 0.51


@pytest.mark.rule("SCI-080", "SCI-081")
@pytest.mark.parametrize(("brr", "lspclks"), [(0, 16), (1, 16), (2, 24), (3, 32), (24, 200), (0x100, 2056)])
def test_a_bit_is_eight_times_brr_plus_one_lspclks(brr, lspclks):
    assert bit_length(SciRig(brr=brr)) == 4 * lspclks


@pytest.mark.rule("SCI-080", "SCI-081")
@pytest.mark.parametrize("brr", [0, 1, 7, 120])
def test_the_receiver_runs_at_the_same_rate(brr):
    rig = SciRig(brr=brr, fifo=True)
    for data in range(0, 256, 17):
        rig.send(frame(data), bit=32 * (max(brr, 1) + 1), at=rig.now)
        assert rig.received(wait=1) == [data]
    assert rig.peek("SCIRXST") == 0


@pytest.mark.rule("SCI-083")
@pytest.mark.parametrize("divider", [1, 2, 4, 6, 8, 10, 12, 14])
def test_the_rate_follows_lspclk(divider):
    rig = SciRig(brr=24)
    rig.chip.set_lspclk(rig.now, divider, 0)
    assert bit_length(rig, divider) == 200 * divider


@pytest.mark.rule("SCI-083")
def test_the_receiver_follows_lspclk_too():
    rig = SciRig(brr=24, fifo=True)
    rig.chip.set_lspclk(rig.now, 2, 0)
    rig.send(frame(0x4B) + "1", bit=400)
    assert rig.received(wait=1) == [0x4B]


@pytest.mark.rule("SCI-083")
@pytest.mark.parametrize("phase", range(4))
def test_edges_are_at_lspclk_ticks(phase):
    rig = SciRig(brr=24)
    rig.chip.set_lspclk(rig.now, 4, phase)
    rig.wait(2)
    rig.put(0x55, 12)
    assert {time % 4 for time, _ in rig.edges} == {(rig.edges[0][0]) % 4}
    other = SciRig(brr=24)
    other.chip.set_lspclk(other.now, 4, 0)
    other.wait(2)
    other.write("SCITXBUF", 0x55)
    other.wait(12)
    assert (rig.edges[0][0] - other.edges[0][0]) % 4 == phase


@pytest.mark.rule("SCI-084")
def test_sw_reset_leaves_brr():
    rig = SciRig(brr=0x1234)
    rig.restart()
    assert rig.flags("SCIHBAUD", "SCILBAUD") == {"SCIHBAUD": 0x12, "SCILBAUD": 0x34}
    assert bit_length(rig) == 32 * 0x1235


@pytest.mark.rule("SCI-085")
def test_a_new_rate_begins_at_the_end_of_the_current_sciclk():
    rig = SciRig(brr=24).put(0x55, sciclk=1)
    start = rig.falls()[0]
    rig.run_until(start + 350)
    rig.set_brr(49)
    rig.wait(12)
    edges = [time - start for time, _ in rig.edges]
    # four SCICLK of 100, then four of 200 end the start bit; every bit after it is eight of 200
    assert edges[:3] == [0, 4 * 100 + 4 * 200, 4 * 100 + 4 * 200 + 1600]


@settings(max_examples=25, deadline=None)
@given(brr=st.integers(0, 3000), divider=st.sampled_from([1, 2, 4, 6, 8, 10, 12, 14]))
def test_the_length_of_a_bit_with_any_brr_and_any_lospcp_divider(brr, divider):
    rig = SciRig(brr=brr)
    rig.chip.set_lspclk(rig.now, divider, 0)
    assert bit_length(rig, divider) == 8 * divider * (max(brr, 1) + 1)


@pytest.mark.rule("SCI-085")
@pytest.mark.parametrize(("write", "bit"), [(399, 400 + 4 * 200), (400, 500 + 3 * 200), (401, 500 + 3 * 200)])
def test_a_new_divider_is_loaded_with_an_sciclk_after_the_cycle_of_the_write(write: int, bit: int):
    """A start bit has eight SCICLK: 100 cycles each before the new divider is loaded, then 200."""
    rig = SciRig().put(0x55, sciclk=1)
    start = rig.falls()[0]
    rig.run_until(start + write)
    rig.set_brr(49)
    rig.wait(12)
    assert rig.edges[1][0] - start == bit


@pytest.mark.rule("SCI-085")
def test_a_divider_is_used_for_a_whole_sciclk_after_it_was_loaded():
    """BRR is written one cycle before an SCICLK begins and again in that cycle: this SCICLK is 200 cycles long."""
    rig = SciRig().put(0x55, sciclk=1)
    start = rig.falls()[0]
    for write, brr in ((399, 49), (400, 24)):
        rig.run_until(start + write)
        rig.set_brr(brr)
    rig.wait(12)
    assert rig.edges[1][0] - start == 400 + 200 + 3 * 100
