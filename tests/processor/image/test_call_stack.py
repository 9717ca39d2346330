"""Which functions are under way: programs of our own in assembly, whose calls and returns are told as they come."""

from __future__ import annotations

import pytest

from periph_sim.processor.image.observers import CallListener
from periph_sim.processor.image_files.assemble import assemble

from .rig import ENPIE, HEAD, Rig
from .test_image_program import CYCLE, TIMER


class Told(CallListener):
    """Calls and returns as text, with the cycle at which they were told."""

    def __init__(self, rig: Rig) -> None:
        self.lines: list[str] = []
        self.at: list[int] = []
        rig.program.add_call_listener(self)

    def called(self, name: str, tick: int) -> None:
        self.lines.append(f"> {name}")
        self.at.append(tick // CYCLE)

    def returned(self, name: str, tick: int) -> None:
        self.lines.append(f"< {name}")
        self.at.append(tick // CYCLE)


def calls_of(source: str, *modules: str, ticks: int = 6_000_000) -> Told:
    rig = Rig(source, *modules)
    told = Told(rig)
    rig.run(ticks)
    return told


LEAF = """
 .global _outer, _inner
_outer: LCR #_inner
 NOP
 LRETR
_inner: RPT #9 || NOP
 LRETR
"""


def test_a_call_in_a_call_begins_at_its_first_instruction_and_ends_behind_its_return():
    told = calls_of(HEAD + " LCR #_outer\n ESTOP0" + LEAF)
    assert told.lines == ["> _c_int00", "> _outer", "> _inner", "< _inner", "< _outer"]
    # 10 cycles of the head, LCR 4 twice, once to an odd address; RPT 1 + 10, LRETR 4; NOP 1, LRETR 4
    assert [at - told.at[0] for at in told.at] == [0, 15, 19, 34, 39]


def test_a_branch_into_another_function_takes_its_frame_over():
    """_tail returns to where _outer was called from."""
    tail = " .global _outer, _tail\n_outer: NOP\n LB #_tail\n ESTOP0\n_tail: NOP\n LRETR\n"
    told = calls_of(HEAD + " LCR #_outer\n NOP\n ESTOP0\n" + tail)
    assert told.lines == ["> _c_int00", "> _outer", "< _outer", "> _tail", "< _tail"]


def test_a_branch_within_a_function_is_no_call():
    told = calls_of(HEAD + " MOVB ACC,#3\nagain: SUBB ACC,#1\n BF again,NEQ\n ESTOP0\n")
    assert told.lines == ["> _c_int00"]


def test_a_function_that_calls_itself_is_under_way_several_times():
    source = " .global _down\n_down: SUBB ACC,#1\n BF out,EQ\n LCR #_down\nout: LRETR\n"
    told = calls_of(HEAD + " MOVB ACC,#3\n LCR #_down\n ESTOP0\n" + source)
    assert told.lines == ["> _c_int00", *["> _down"] * 3, *["< _down"] * 3]


@pytest.mark.parametrize(
    ("call", "back"),
    [("LC #_leaf", "LRET"), ("FFC XAR7,#_leaf", "LB *XAR7"), ("MOVL XAR7,#_leaf\n LCR *XAR7", "LRETR")],
)
def test_each_kind_of_call_comes_back(call: str, back: str):
    told = calls_of(f"{HEAD} {call}\n NOP\n ESTOP0\n .global _leaf\n_leaf: NOP\n {back}\n")
    assert told.lines == ["> _c_int00", "> _leaf", "< _leaf"]


def test_a_service_routine_interrupts_what_goes_on():
    told = calls_of(TIMER, "TIMER0", ticks=1_000_000)
    assert told.lines[:5] == ["> _c_int00", "> _routine", "< _routine", "> _routine", "< _routine"]
    _, began, over, again, _ = told.at[:5]
    # seven instructions of a cycle each, and IRET 8
    assert (over - began, again - began) == (15, 500)


def test_a_trap_is_a_call():
    source = (
        HEAD
        + ENPIE
        + " EALLOW\n MOVL XAR4,#_routine\n MOVL XAR5,#0x0D80\n MOVL *XAR5,XAR4\n EDIS\n TRAP #5\n NOP\n ESTOP0\n"
    )
    told = calls_of(source + " .global _routine\n_routine: NOP\n IRET\n")
    assert told.lines == ["> _c_int00", "> _routine", "< _routine"]


def test_a_made_frame_leaves_the_function_that_runs():
    """As an RTOS does: _switch puts an address on the stack that nobody called from, and returns to it."""
    source = """
 LCR #_switch
 ESTOP0
 .global _switch, _task
_switch: MOVL XAR4,#_task
 PUSH XAR4
 POP RPC
 LRETR
 ESTOP0
_task: NOP
 ESTOP0
"""
    told = calls_of(HEAD + source)
    assert told.lines == ["> _c_int00", "> _switch", "< _switch", "> _task"]


def test_code_without_a_symbol_is_named_by_its_address():
    image = assemble(HEAD + ' LCR #0x9200\n ESTOP0\n .sect "more", 0x9200\n NOP\n LRETR\n')
    assert all(symbol.address != 0x9200 for symbol in image.symbols)
    told = calls_of(HEAD + ' LCR #0x9200\n ESTOP0\n .sect "more", 0x9200\n NOP\n LRETR\n')
    assert told.lines == ["> _c_int00", "> 0x009200", "< 0x009200"]


def test_who_listens_late_is_told_what_is_under_way():
    rig = Rig(HEAD + " LCR #_outer\n ESTOP0" + LEAF)
    first = Told(rig)
    assert first.lines == ["> _c_int00"]
