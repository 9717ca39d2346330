"""Check of the wires that a case's [outside] names: each must exist and be named once."""

from __future__ import annotations

from collections.abc import Mapping

from ..core.suggest import did_you_mean
from ..core.wire import Wire
from .case.model import BadCase, Case


def check_outside(case: Case, wires: Mapping[str, Wire]) -> None:
    """Raise BadCase, with its line, if [outside] names an unknown wire, or one twice."""
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
    """Return the error for a case that is driven from outside and cannot be run like others."""
    assert case.outside is not None
    wires = " and ".join(case.outside.wires)
    what = (
        f"{wires} {'is' if len(case.outside.wires) == 1 else 'are'} driven from outside, and a run has no outside party"
    )
    way_out = "step it with periph_sim.outside.Session, or give its log, a [controller] or a [host]"
    return case.mistake(f"{what}; {way_out}", "outside")
