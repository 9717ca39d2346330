"""Call listeners are notified of calls and returns, here those of assembly programs."""

from __future__ import annotations

import pytest

from periph_sim.processor.image.observers import CallListener

from .rig import ENPIE, HEAD, Rig
from .test_image_program import CYCLE, TIMER


class CallLog(CallListener):
    """Calls and returns as text, with the cycles of their notifications."""

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


def calls_of(source: str, *modules: str, ticks: int = 6_000_000) -> CallLog:
    rig = Rig(source, *modules)
    log = CallLog(rig)
    rig.run(ticks)
    return log


LEAF = """
 .global _outer, _inner
_outer: LCR #_inner
 NOP
 LRETR
_inner: RPT #9 || NOP
 LRETR
"""


def test_a_nested_call_begins_at_its_first_instruction_and_ends_after_its_return():
    log = calls_of(HEAD + " LCR #_outer\n ESTOP0" + LEAF)
    assert log.lines == ["> _c_int00", "> _outer", "> _inner", "< _inner", "< _outer"]
    # 10 cycles before, two LCR of 4, one of them to an odd address; RPT 1 + 10, LRETR 4; NOP 1, LRETR 4
    assert [at - log.at[0] for at in log.at] == [0, 15, 19, 34, 39]


LEAVES = " NOP\n ESTOP0\n .global _leaf\n_leaf: NOP\n "
TRAP = " EALLOW\n MOVL XAR4,#_leaf\n MOVL XAR5,#0x0D80\n MOVL *XAR5,XAR4\n EDIS\n TRAP #5\n"
# Code after HEAD, and the notifications after that of the call of _c_int00.
CASES = {
    "LC": (f" LC #_leaf\n{LEAVES} LRET", "> _leaf < _leaf"),
    "FFC": (f" FFC XAR7,#_leaf\n{LEAVES} LB *XAR7", "> _leaf < _leaf"),
    "LCR *XAR7": (f" MOVL XAR7,#_leaf\n LCR *XAR7\n{LEAVES} LRETR", "> _leaf < _leaf"),
    "TRAP": (f"{ENPIE}{TRAP}{LEAVES} IRET", "> _leaf < _leaf"),
    "a branch within a function": (" MOVB ACC,#3\nagain: SUBB ACC,#1\n BF again,NEQ\n ESTOP0", ""),
    "a function that calls itself": (
        " MOVB ACC,#3\n LCR #_down\n ESTOP0\n .global _down\n"
        "_down: SUBB ACC,#1\n BF out,EQ\n LCR #_down\nout: LRETR",
        "> _down > _down > _down < _down < _down < _down",
    ),
    "a branch into another function, which returns to where the first one was called from": (
        " LCR #_outer\n NOP\n ESTOP0\n .global _outer, _tail\n"
        "_outer: NOP\n LB #_tail\n ESTOP0\n_tail: NOP\n LRETR",
        "> _outer < _outer > _tail < _tail",
    ),
    "a return to an address on the stack that nobody called from, as an RTOS makes it": (
        " LCR #_switch\n ESTOP0\n .global _switch, _task\n"
        "_switch: MOVL XAR4,#_task\n PUSH XAR4\n POP RPC\n LRETR\n ESTOP0\n_task: NOP\n ESTOP0",
        "> _switch < _switch > _task",
    ),
    "code without a symbol": (
        ' LCR #0x9200\n ESTOP0\n .sect "more", 0x9200\n NOP\n LRETR', "> 0x009200 < 0x009200"
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_listeners_are_notified_of_calls_and_returns(case: str):
    source, expected = CASES[case]
    assert " ".join(calls_of(f"{HEAD}{source}\n").lines) == f"> _c_int00 {expected}".strip()


def test_a_service_routine_is_a_call_that_begins_with_the_interrupt():
    log = calls_of(TIMER, "TIMER0", ticks=1_000_000)
    assert log.lines[:5] == ["> _c_int00", "> _routine", "< _routine", "> _routine", "< _routine"]
    _, began, over, again, _ = log.at[:5]
    # seven instructions of a cycle each, and IRET 8
    assert (over - began, again - began) == (15, 500)


def test_a_listener_added_late_is_notified_of_the_functions_being_executed():
    rig = Rig(HEAD + " LCR #_outer\n ESTOP0" + LEAF)
    first = CallLog(rig)
    assert first.lines == ["> _c_int00"]
