"""Scope of a case: the names of units, modules, wires and other things that its budgets can refer to."""

from __future__ import annotations

from ..timing.language.scope import MAPS, BadEvent, ImageNames, Scope
from .case.model import BadCase, Case
from .case.origin import Source
from .case.wiring import Wiring, wiring_of


def scope_of_case(case: Case, wiring: Wiring | None = None) -> Scope:
    """Return the scope of a case's scene. wiring: the wiring of the case, if it is already known."""
    if wiring is None:
        wiring = wiring_of(case)
    wires = list(wiring.wires())
    wires += ["SDA", "SCL"] if case.controller is not None or case.rounds is not None or case.chip else []
    wires += ["RX"] if case.rx_sender else []
    units = {name: tuple(m for m in unit.modules if m in MAPS) for name, unit in case.unit.items()}
    rounds = case.controller is not None or case.rounds is not None
    lines = [wire for sci in wiring.scis for wire in (sci.rx, sci.tx)]
    pairs = tuple(dict.fromkeys(table.pair for table in case.transceiver))
    lines += pairs
    wires += pairs
    lines += ["RX"] if case.rx_sender else []
    return Scope(
        units,
        tuple(dict.fromkeys(wires)),
        case.controller is not None,
        case.host is not None,
        rounds,
        tuple(dict.fromkeys(lines)),
        pairs,
        {name: ImageNames(unit.image) for name, unit in case.unit.items() if unit.image},
        next((name for name, unit in case.unit.items() if not unit.firmware), ""),
        _own_measures(case) if case.measures or case.measures_from else {},
    )


def _own_measures(case: Case) -> dict[str, str]:
    """Return the texts of the user's own measures, by name.

    The measures are in [measures] of the case and in the file that the key `measures_from` names. Example: `"late
    rounds" = "count of record round missed"`. The measures are checked as far as possible without a scene. Raise
    BadCase, with file and line, for an invalid measure.
    """
    from ..timing.measures.factory import check_measure
    from .case.toml_file import read

    sentences = dict(case.measures)
    file = case.folder / case.measures_from
    source = Source(file, "")
    if case.measures_from:
        text, tree = read(file, "measures")
        source = Source(file, text)
        for name, sentence in tree.items():
            if not isinstance(sentence, str):
                raise _mistake(case, source, name, "it is no sentence in quotes")
            if name in sentences:
                what = f"{file} has a measure {name!r}, too; give one of them another name"
                raise case.mistake(what, "measures", name)
            sentences[name] = sentence
    for name in sentences:
        try:
            check_measure(name, sentences)
        except BadEvent as error:
            raise _mistake(case, source, name, str(error)) from None
    return sentences


def _mistake(case: Case, source: Source, name: str, what: str) -> BadCase:
    """Return an error about the measure `name`, with its place in the case or in the file `source`."""
    if name in case.measures:
        return case.mistake(what, "measures", name)
    return BadCase(f"{source.where((name,))}: {name}: {what}")
