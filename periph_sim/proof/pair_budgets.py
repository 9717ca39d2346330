"""Choice of the budgets that a closed table with rounds and frames can judge.

    events of a budget                     they belong to           judged?
    bus, I2C flags, writes, other pins     the rest of the scene    yes: equal for all groups of a cell of groups
    SCIRXINTA, SCI accesses                the service routine      yes: equal for all groups of a cell of groups
    some of both                                                    no: the routine moves relative to the rest
    variables, reads, pins and flags of    neither                  no: a frame can move them
    the SCI, such as RX and RXFFST

"Other pins" are GPIO pins that no SCI can use, for example a pin that is high while the firmware computes.

Of a cell of groups, only the first and the last group are run, so a budget is judged only if its values are equal for
all groups of it: if all its events are in the first line, or all are in the second one. `GroupDigest` has the writes,
bus events and interrupts of the rest of the scene. Flags of the I2C module and levels of GPIO pins follow from these.

The glossary in `periph_sim.proof` has the terms.
"""

from __future__ import annotations

from collections.abc import Collection

from ..core.records import Kind
from ..f28335.gpio.pin_mux_table import FUNCTIONS
from ..timing.language.matcher import Matcher
from .record_digests import SCI
from .stretch import CoveredCase

REST, ROUTINE, MOVES = "rest", "routine", "moves"  # what an event belongs to; MOVES: a frame can move it
ALWAYS_REST = frozenset([Kind.BUS, Kind.TRANSFER, Kind.ROUND])
LINES = frozenset(["SCL", "SDA"])
I2C = "I2C"
OF_SCI = "PIEIFR9."  # the flags of PIE group 9, the group of SCI-A and SCI-B


def side(event: Matcher, pins: Collection[str]) -> str:
    """Return what an event belongs to: REST for the rest of the scene, ROUTINE, or MOVES if a frame can move it.

    pins: the names of the wires of GPIO pins that cannot be pins of an SCI.
    """
    kind, what = event.kind, event.what
    modules = {where.partition(".")[2] for where in event.where or ()}
    if kind in ALWAYS_REST or (kind is Kind.EDGE and event.where and LINES.union(pins) >= event.where):
        return REST
    if kind is Kind.FLAG and modules:
        if all(module.startswith(I2C) for module in modules):
            return REST
        return ROUTINE if modules == {"PIE"} and what.startswith(OF_SCI) else MOVES
    if kind is Kind.IRQ and what:
        return ROUTINE if what.startswith(SCI) else REST
    if kind is Kind.ACCESS and what:
        module = what.split()[-1].partition(".")[0]
        if module.startswith(SCI):
            return ROUTINE
        return REST if what.startswith("W ") and module != "PIE" else MOVES
    return MOVES


def within_round(covered: CoveredCase) -> CoveredCase:
    """Leave out the budgets of a case that a closed table with rounds and frames cannot judge, and return the case.

    These budgets are left out:
    - budgets whose values depend on earlier rounds or frames, because those are not in the group
    - budgets that relate the service routine to other events, because it moves relative to them
    - budgets of events that a frame can move, because not every start of a frame is run
    - budgets whose values do not follow from events alone
    """
    pins = {
        name
        for unit in covered.case.unit.values()
        for name, number in unit.pins.items()
        if not any(function.startswith(SCI) for function in FUNCTIONS[number])
    }
    events = covered.events()
    for name, further in covered.looks_further().items():
        used = events[name]
        if further:
            covered.leave_out(name, f"its values depend on {further[0]}")
        elif used is None:
            covered.leave_out(name, "it does not consist of events")
        else:
            sides = {side(one, pins): one for one in used}
            # such as "1st SCIRXINTA of transfer", which also depends on the begin of the transfer
            is_numbered = any(one.group is not None for one in used)
            if MOVES in sides:
                covered.leave_out(name, f"a frame can move {sides[MOVES].text!r} in a way that is not run")
            elif len(sides) > 1 or (ROUTINE in sides and is_numbered):
                covered.leave_out(name, "it relates the service routine of the SCI to other events")
    return covered
