"""Budgets that a table of groups can judge: those that a frame does not change, and those of the service routine alone.

I2C events, MODEL rise   the rest of the scene     equal for all groups of a cell
SCIRXINTA, SCIFFRX       the service routine       equal for all groups of a cell
both                     left out                  the routine moves relative to the rest
RX fall                  left out                  the frame moves relative to its cell
"""

from __future__ import annotations

from collections.abc import Collection

from ..core.records import Kind
from ..timing.language.matcher import ANYTHING, Matcher
from .closed_table import WITHIN_ROUND
from .group_records import SCI
from .stretch import CoveredCase

OF_FRAME, OF_ROUTINE, OF_REST = "frame", "routine", "rest"  # what an event belongs to
OF_REST_ONLY = frozenset([Kind.BUS, Kind.TRANSFER, Kind.ROUND, Kind.SPAN, Kind.DATA])


def sides(event: Matcher, pins: Collection[str]) -> set[str]:
    """Return what an event may belong to: a frame, the service routine of the SCI, or the rest of the scene.

    pins: the names of wires whose edges do not belong to a frame.
    """
    if event.kind is Kind.FRAME or (event.kind is Kind.EDGE and not set(pins).issuperset(event.where or {""})):
        return {OF_FRAME}
    if event.kind is Kind.EDGE or event.kind in OF_REST_ONLY:
        return {OF_REST}
    of_routine = event.kind is Kind.RECEIVER or (event.kind is Kind.IRQ and event.what.startswith(SCI))
    if event.kind in (Kind.FLAG, Kind.ACCESS) and event.where is not None:
        names = {name.partition(".")[2] for name in event.where} if event.kind is Kind.FLAG else {_module(event.what)}
        if all(name.startswith(SCI) or name == "PIE" for name in names):
            of_routine = True
        elif event.what != ANYTHING and not any(name.startswith(SCI) or name == "PIE" for name in names):
            return {OF_REST}
    return {OF_ROUTINE} if of_routine else {OF_ROUTINE, OF_REST}


def _module(what: str) -> str:
    return what.split()[-1].partition(".")[0]


def within_round(covered: CoveredCase) -> CoveredCase:
    """Leave out the budgets of a case that a table of groups cannot judge, with the reason.

    Groups may lack the rounds and frames to which a budget looks back. The start of a frame is not run at each tick of
    its cell. Within a wait, the service routine moves relative to everything else.
    """
    pins = {"SCL", "SDA", *(pin for unit in covered.case.unit.values() for pin in unit.pins)}
    events = covered.events()
    for name, looks_back in covered.looks_back().items():
        further = sorted(looks_back - WITHIN_ROUND)
        if further:
            covered.leave_out(name, f"its values depend on {further[0]}")
            continue
        found = set[str]().union(*(sides(one, pins) for one in events[name] or ()))
        if events[name] is None:
            covered.leave_out(name, "it does not consist of events")
        elif OF_FRAME in found:
            covered.leave_out(name, "it measures from an edge or a byte of a frame, which is not run at each tick")
        elif len(found) > 1:
            covered.leave_out(name, "it relates the service routine of the SCI to other events")
    return covered
