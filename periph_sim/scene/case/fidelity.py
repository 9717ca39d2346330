"""How the lines of a case are simulated: `fidelity`, one word or a table, goes in; the level of each bus comes out.

fidelity = "adaptive"        every bus

[fidelity]                   each bus of its own, those that are not named at edges
I2C-A = "byte"
left.SCI-B = "adaptive"      as [[serial.send]] names an SCI
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias, get_args

from msgspec import Struct

from ... import removed
from ...core.convert import Before
from ...core.suggest import did_you_mean
from .wiring import SciLines, Wiring, sci_lines, sci_named

if TYPE_CHECKING:
    from .model import Case

Level: TypeAlias = Literal["edge", "adaptive", "byte"]
LEVELS: tuple[str, ...] = get_args(Level)
EDGE, BYTE = "edge", "byte"
I2C = "I2C-A"


def _checked(value: object) -> object:
    """A word, or a table with the names of SCIs in one piece: {"left": {"SCI-B": ...}} is {"left.SCI-B": ...}."""
    if not isinstance(value, dict):
        if value not in LEVELS:
            _refuse_removed(value)
            raise ValueError(f"it is one of {', '.join(LEVELS)}, or a table with one of them for each bus")
        return value
    table = dict(_flat(value))
    for name, level in table.items():
        if level not in LEVELS:
            _refuse_removed(level)
            raise ValueError(f"{name}: there is no level {level!r} of a bus; {did_you_mean(str(level), LEVELS)}")
    return table


def _refuse_removed(level: object) -> None:
    """Raise ValueError, which says what to use instead, for a level of an earlier version."""
    if isinstance(level, str) and level in removed.LEVELS:
        raise ValueError(removed.LEVELS[level])


def _flat(table: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, object]]:
    for name, level in table.items():
        if isinstance(level, dict):
            yield from _flat(level, f"{before}{name}.")
        else:
            yield f"{before}{name}", level


Fidelity: TypeAlias = Annotated[Level | dict[str, Level | dict[str, Level]], Before(_checked)]


class BusLevels(Struct, frozen=True):
    """i2c: of SCL and SDA. lines: of each UART line that is not at edges. named: the key of the table that says it."""

    i2c: str
    lines: Mapping[str, str]
    named: Mapping[str, str]

    @property
    def has_bytes(self) -> bool:
        """Whether any bus is to be at level "byte"."""
        return BYTE in (self.i2c, *self.lines.values())


def bus_levels(case: Case, wiring: Wiring) -> BusLevels:
    """BadCase, with its line, for a bus that there is not, or that is named twice.

    A line between two SCIs is as the one of them says that is closer to edges.
    """
    if case.fidelity == EDGE:
        return BusLevels(EDGE, {}, {})
    scis = sci_lines(case, wiring)
    of_sci: dict[tuple[str, str], tuple[str, str]] = {}
    if isinstance(case.fidelity, str):
        i2c: str = case.fidelity
        of_sci = {(sci.unit, sci.module): ("", i2c) for sci in scis}
    else:
        i2c = EDGE
        for name, level in case.fidelity.items():
            if name == I2C:
                i2c = str(level)
                _check_i2c(case, scis)
                continue
            place = ("fidelity", *name.split("."))
            sci = sci_named(case, name, *place)
            if (sci.unit, sci.module) in of_sci:
                before, _ = of_sci[sci.unit, sci.module]
                raise case.mistake(f"that is {before}, which has a level already; leave one of them out", *place)
            of_sci[sci.unit, sci.module] = name, str(level)
    lines: dict[str, str] = {}
    named: dict[str, str] = {}
    for sci in scis:
        name, said = of_sci.get((sci.unit, sci.module), ("", EDGE))
        for wire in (sci.rx, sci.tx):
            if wire not in lines or LEVELS.index(said) < LEVELS.index(lines[wire]):
                lines[wire], named[wire] = said, name
    return BusLevels(i2c, {wire: level for wire, level in lines.items() if level != EDGE}, named)


def _check_i2c(case: Case, scis: Sequence[SciLines]) -> None:
    """Refuse a level for a bus that nobody is on."""
    if case.controller or case.chip or case.device or any(I2C in unit.modules for unit in case.unit.values()):
        return
    known = ", ".join(f"{sci.unit}.{sci.module}" for sci in scis)
    raise case.mistake(f"nobody is on {I2C}; {f'there is {known}' if known else 'there is no bus'}", "fidelity", I2C)


def fidelity_text(fidelity: str | Mapping[str, object]) -> str:
    """For people: `byte`, or `I2C-A=byte SCI-A=edge`."""
    return fidelity if isinstance(fidelity, str) else " ".join(f"{name}={level}" for name, level in fidelity.items())
