"""Budgets that a table of groups can judge: those that a frame does not change, and those of the service routine alone.

    bus, I2C flags, writes, MODEL    the rest of the scene    equal for all groups of a cell
    SCIRXINTA, SCI accesses          the service routine      equal for all groups of a cell
    both                             left out                 the routine moves relative to the rest
    variables, reads, RX, RXFFST     left out                 a frame can move them

A group is a round, a frame, or both together (`pair_groups`). A cell is a set of groups with equal effects, of which
only the first and the last are run (`pair_table.Cell`). A budget is judged only if all its events are known to belong
to the first line, or all to the second line. The digests of `GroupDigest` contain the writes, bus events and
interrupts of the rest of the scene. Flags of the I2C module and levels of GPIO pins follow from these.
"""

from __future__ import annotations

from collections.abc import Collection

from ..core.records import Kind
from ..f28335.gpio.pin_mux_table import FUNCTIONS
from ..timing.language.matcher import Matcher
from .record_digests import SCI
from .stretch import CoveredCase

REST, ROUTINE, MOVES = "rest", "routine", "moves"  # what an event belongs to; MOVES: a frame can move the event
ALWAYS_REST = frozenset([Kind.BUS, Kind.TRANSFER, Kind.ROUND])
LINES = frozenset(["SCL", "SDA"])
I2C = "I2C"
OF_SCI = "PIEIFR9."  # the flags of PIE group 9, the group of SCI-A and SCI-B


def side(event: Matcher, pins: Collection[str]) -> str:
    """Return what an event belongs to: REST, ROUTINE or MOVES.

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
    """Leave out the budgets of a case that a table of groups cannot judge, each with the reason, and return the case.

    These budgets are left out:
    - budgets whose values depend on earlier rounds or frames, because a group does not contain them
    - budgets that relate the service routine to other events, because it moves relative to them within a wait
    - budgets of events that a frame can move, because not every start of a frame is run
    - budgets whose values do not depend on events only
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
            # "1st interrupt of transfer" depends on where the transfer begins
            is_numbered = any(one.group is not None for one in used)
            if MOVES in sides:
                covered.leave_out(name, f"a frame can move {sides[MOVES].text!r} in a way that is not run")
            elif len(sides) > 1 or (ROUTINE in sides and is_numbered):
                covered.leave_out(name, "it relates the service routine of the SCI to other events")
    return covered
