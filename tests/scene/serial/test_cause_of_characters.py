"""The cause of each edge of TX: the write of its own character, even if further characters wait.

CPU  w(O) w(K) w(!)
TX       |---O---|---K---|---!---|     the edges of O name w(O), those of K w(K)
"""

from __future__ import annotations

from itertools import pairwise

import pytest

from periph_sim.core.records import Kind, Record
from periph_sim.firmware import start_sci
from periph_sim.processor.dsp import Dsp
from tests.scene.serial.programs import Program, scene, sender
from tests.scene.small import unit


def causes(program: Program, duration: str = "1 ms") -> list[tuple[int, int]]:
    """Return, for each frame on TX, its value and the only value whose write caused its edges."""
    seen: list[Record] = []
    scene({"dsp": program}, seen, unit={"dsp": unit("SCI-A")}, duration=duration).run()
    by_number = {one.number: one for one in seen}
    begins = [one.tick for one in seen if one.kind is Kind.FRAME and one.where == "TX" and one.what == "begin"]
    values = [one.value for one in seen if one.kind is Kind.FRAME and one.where == "TX" and one.what == "end"]
    edges = [one for one in seen if one.kind is Kind.EDGE and one.where == "TX"]
    found = []
    for (begin, end), value in zip(pairwise([*begins, 1 << 62]), values, strict=True):
        (cause,) = {one.cause for one in edges if begin <= one.tick < end}
        wrote = by_number[cause]
        assert (wrote.kind, wrote.what) == (Kind.ACCESS, "W SCI-A.SCITXBUF")
        found.append((value, wrote.value))
    return found


def from_standard_mode(dsp: Dsp) -> None:
    sci = start_sci(dsp, "SCI-A")
    sci.SCIFFTX.SCIFFENA = 0
    for byte in b"OK!":
        dsp.spin(lambda: sci.SCICTL2.TXRDY == 1)
        sci.SCITXBUF.all = byte


@pytest.mark.parametrize("program", [sender("SCI-A", b"OK!"), from_standard_mode])
def test_each_edge_names_the_write_of_its_own_character(program: Program):
    assert causes(program) == [(byte, byte) for byte in b"OK!"]


def test_a_character_that_a_reset_cuts_off_ends_with_the_reset():
    seen: list[Record] = []

    def main(dsp: Dsp) -> None:
        sci = start_sci(dsp, "SCI-A")
        sci.SCITXBUF.all = 0
        dsp.compute(3000)
        sci.SCICTL1.SWRESET = 0

    scene({"dsp": main}, seen, unit={"dsp": unit("SCI-A")}, duration="200 us").run()
    by_number = {one.number: one for one in seen}
    fall, rise = (one for one in seen if one.kind is Kind.EDGE and one.where == "TX")
    assert by_number[fall.cause].what == "W SCI-A.SCITXBUF"
    assert by_number[rise.cause].what == "W SCI-A.SCICTL1"
