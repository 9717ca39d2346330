"""What events of a case can be about: a case goes in; units, modules and wires come out as a Scope."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..timing.language.scope import MAPS, Scope
from .case.model import Case
from .case.wiring import Wiring, sci_lines, wiring_of

if TYPE_CHECKING:
    from ..image.variables import Variable, Variables


def scope_of_case(case: Case, wiring: Wiring | None = None) -> Scope:
    """What a case's scene consists of. wiring: of the case, where it is known already."""
    if wiring is None:
        wiring = wiring_of(case)
    wires = list(wiring.wires())
    wires += ["SDA", "SCL"] if case.controller is not None or case.chip else []
    wires += ["RX"] if case.host is not None else []
    units = {name: tuple(m for m in unit.modules if m in MAPS) for name, unit in case.unit.items()}
    rounds = case.controller is not None or case.rounds is not None
    lines = [wire for sci in sci_lines(case, wiring) for wire in (sci.rx, sci.tx)]
    pairs = tuple(dict.fromkeys(table.pair for table in case.transceiver))
    lines += pairs
    wires += pairs
    lines += ["RX"] if case.host is not None else []
    return Scope(
        units,
        tuple(dict.fromkeys(wires)),
        case.controller is not None,
        case.host is not None,
        rounds,
        tuple(dict.fromkeys(lines)),
        pairs,
        {name: _Variables(unit.image) for name, unit in case.unit.items() if unit.image},
    )


class _Variables:
    """Names of an image's variables. The image is read when the first one is asked for."""

    def __init__(self, path: str) -> None:
        self._path = path
        self._known: Variables | None = None

    def __call__(self, name: str) -> Variable:
        """The variable of this name. ValueError where there is none, or no such image."""
        if self._known is None:
            from ..image.program_file import program_in
            from ..image.variables import Variables

            self._known = Variables(program_in(Path(self._path)))
        return self._known.find(name)
