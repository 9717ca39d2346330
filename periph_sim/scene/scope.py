"""Scope of a case: the names of units, modules, wires and other things that its budgets can refer to."""

from __future__ import annotations

import re
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from ..core.phrases import did_you_mean
from ..timing.language.scope import MAPS, BadEvent, Scope
from .case.model import BadCase, Case
from .case.origin import Source
from .case.wiring import Wiring, wiring_of

if TYPE_CHECKING:
    from ..processor.image_files.model import Image
    from ..processor.image_files.variables import Variable, Variables

ADDRESS = re.compile(r"0x[0-9a-f]{6}")


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
        {name: _ImageNames(unit.image) for name, unit in case.unit.items() if unit.image},
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


class _ImageNames:
    """The names in an image. The image is read at the first query. A query for an unknown name raises ValueError."""

    def __init__(self, path: str) -> None:
        self._path = path

    @cached_property
    def _image(self) -> Image:
        from ..processor.image_files.program_file import program_in

        return program_in(Path(self._path))

    @cached_property
    def _variables(self) -> Variables:
        from ..processor.image_files.variables import Variables

        return Variables(self._image)

    @cached_property
    def _functions(self) -> tuple[str, ...]:
        from ..processor.image_files.debug_info import FunctionMap

        return tuple(function.name for function in FunctionMap(self._image).functions)

    def variable(self, name: str) -> Variable:
        return self._variables.find(name)

    def function(self, name: str) -> str:
        """Return `name` unchanged if it names a function, or is an address such as "0x3ff4a2".

        An address names code that belongs to no function, such as code in ROM. Raise ValueError for any other name.
        """
        if name not in self._functions and not ADDRESS.fullmatch(name):
            raise ValueError(f"the image has no function {name!r}; {did_you_mean(name, self._functions)}")
        return name
