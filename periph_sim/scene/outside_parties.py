"""Replacement of parties of a case by the outside party that its table [outside] describes.

    outside party drives  replaced table   budgets that are still judged
    SDA and SCL           [controller]     all but those on `bus arbitration lost` and `bus clear`
    RX                    [host]           those that do not need the host's frames

The table [controller] is replaced by a table [rounds] with the same requests, so that the rounds of the outside party
can be recognized on the wires. With `beside_outside = true`, the [controller] stays: the outside party is then a second
controller, or a device.

Parties are replaced when a case is loaded, when a session chooses other wires, and when a scene is built. So the same
rule holds whether the outside party is a Python program, another simulator, a program at a network port, or a log.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ..core.phrases import did_you_mean
from ..core.time import Timebase
from ..core.wire import Wire
from ..timing.budget_plan import BadBudget, plan_of
from .case.model import BadCase, Case
from .case.party_tables import OutsideTable
from .context import CaseTicks
from .plan import limit_plans
from .scope import scope_of_case

BUS = frozenset(("SDA", "SCL"))


def drives_bus(outside: OutsideTable) -> bool:
    """Return True if the outside party drives both lines of the I2C bus."""
    return BUS.issubset(outside.wires)


def as_driven(case: Case) -> Case:
    """Return a case without the parties that its table [outside] replaces.

    Budgets that need a replaced party are left out. For each replaced party, `Case.replaced` has a sentence that names
    these budgets. Raise BadCase for a budget that would also be wrong without [outside].
    """
    outside, controller = case.outside, case.controller
    assert outside is not None
    if controller is not None and drives_bus(outside):
        if controller.beside_outside:
            sentence = "SDA and SCL are driven from outside, beside [controller]"
            case = case.model_copy(update={"_replaced": case._replaced | {"": sentence}})
        else:
            rounds = {"controller": None, "rounds": controller.as_rounds()}
            case = _without("controller", "SDA and SCL", case, case.model_copy(update=rounds))
    if case.host is not None and "RX" in outside.wires:
        case = _without("host", "RX", case, case.model_copy(update={"host": None}))
    return case


def with_outside(case: Case, wires: tuple[str, ...]) -> Case:
    """Return the case for an outside party that drives `wires` instead of the wires in the table [outside].

    Raise BadCase if [outside] has replaced a party and `wires` lack a wire of this party, because nothing would then
    drive that wire.
    """
    for party, lines in (("controller", BUS), ("host", frozenset(("RX",)))):
        if party in case._replaced and not lines.issubset(wires):
            what = f"the wires that it names replace [{party}], and {' and '.join(wires)} alone would not"
            raise case.mistake(f"{what}; name those too, or take [outside] out of the case", "outside", "wires")
    return as_driven(case.model_copy(update={"outside": OutsideTable(wires=wires)}))


def _without(party: str, lines: str, case: Case, driven: Case) -> Case:
    """Return `driven` with the budgets that can be judged without `party`, and a sentence about the replacement.

    party: the replaced party, "controller" or "host".
    lines: the wires of `party`, for the sentence.
    case: the case with `party`. Its budgets are those that are kept or left out.
    driven: the same case without `party`.
    """
    kept = tuple(budget for budget, judged in zip(case.budget, _judged(case, driven), strict=True) if judged)
    names = [budget.name for budget in kept]
    left_out = ", ".join(repr(budget.name) for budget in case.budget if budget.name not in names)
    sentence = f"{lines} {'are' if ' ' in lines else 'is'} driven from outside, in place of [{party}]"
    if left_out:
        sentence += f"; left out, since nothing else can judge them: {left_out}"
    update: dict[str, object] = {
        "budget": kept,
        "breaks": tuple(name for name in case.breaks if name in names),
        "_all_budgets": case._all_budgets or case.budget,
        "_replaced": case._replaced | {party: sentence},
    }
    if driven.host is None:  # without a host, there are no frames to compare bytes with
        for key, table in (("controller", driven.controller), ("rounds", driven.rounds)):
            if table is not None and table.check == "host":
                update[key] = table.model_copy(update={"check": "expect"})
    return driven.model_copy(update=update)


def _judged(case: Case, driven: Case) -> Iterator[bool]:
    """Yield, for each budget of `case`, True if the budget can be judged in `driven`, which lacks a replaced party."""
    timebase = Timebase(*(int(unit.oscclk * unit.pll / 2) for unit in case.unit.values()))
    start = timebase.ticks(case.start, "nearest")
    # This call is only a check: it raises BadCase for a budget that is wrong in itself. Budgets that only lack the
    # replaced party are found below.
    limit_plans(CaseTicks(case, timebase, start), scope_of_case(case))
    rounds = case.controller or case.rounds
    lost = case.host is not None and driven.host is None
    compares = rounds is not None and rounds.check == "host"
    scope = scope_of_case(driven)
    for budget in case.budget:
        try:
            plan = plan_of(budget, timebase, scope, start)
        except BadBudget:
            yield False
        else:
            needs_host = any(part.make().needs == "host" for part in (plan, *plan.joined))
            yield not (lost and (needs_host or (compares and budget.measure == "wrong bytes")))


def check_outside(case: Case, wires: Mapping[str, Wire]) -> None:
    """Raise BadCase if [outside] names an unknown wire, or names a wire twice."""
    assert case.outside is not None
    names = case.outside.wires
    for entry, name in enumerate(names):
        if name not in wires:
            what = f"there is no wire {name!r}; {did_you_mean(name, wires) if wires else 'the case has none'}"
        elif name in names[:entry]:
            what = f"{name} is named twice; once is enough"
        else:
            continue
        raise case.mistake(what, "outside", "wires")


def not_run(case: Case) -> BadCase:
    """Return the error for a run, without a session, of a case whose [outside] has no log: nothing drives its wires."""
    assert case.outside is not None
    wires = " and ".join(case.outside.wires)
    what = (
        f"{wires} {'is' if len(case.outside.wires) == 1 else 'are'} driven from outside, and a run has no outside party"
    )
    way_out = "step it with periph_sim.outside.Session, or give its log, a [controller] or a [host]"
    return case.mistake(f"{what}; {way_out}", "outside")
