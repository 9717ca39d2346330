"""What events of a case can be about: a case goes in; units, modules and wires come out as a Scope."""

from __future__ import annotations

from ..timing.language.scope import MAPS, WIRES, Scope
from .case.model import Case


def scope_of_case(case: Case) -> Scope:
    """What a case's scene consists of."""
    wires = [wire for unit in case.unit.values() for module in unit.modules for wire in WIRES.get(module, ())]
    wires += [label for unit in case.unit.values() for label in unit.pins]
    wires += ["SDA", "SCL"] if case.controller is not None or case.chip else []
    wires += ["RX"] if case.host is not None else []
    units = {name: tuple(m for m in unit.modules if m in MAPS) for name, unit in case.unit.items()}
    rounds = case.controller is not None or case.rounds is not None
    return Scope(units, tuple(dict.fromkeys(wires)), case.controller is not None, case.host is not None, rounds)
