"""Parsing of questions about a run: a signal and a time, as "I2CA.I2CSTR.XRDY@12.345ms", or accesses to a register.

The unit may be left out of the name of a register, which then means the registers of all units. The first parts of the
name of a signal may be left out if only one signal has the rest. Hyphens and case do not matter, except that signals
that a name fits in its exact spelling have priority.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ..core.phrases import did_you_mean
from ..core.records import Kind
from ..core.registers import Field, Register
from ..core.time import TimeError, seconds
from ..f28335.memory.ram import MEMORY
from .register_maps import is_status, registers_of
from .run import Group, NotInRun, Run

# In seconds: a time whose last digit is worth more than this, such as "12 ms", is assumed to be exact, not rounded.
COARSEST = Fraction(1, 10**6)


@dataclass(frozen=True)
class RecordedSignal:
    """A field, a wire, a span, an interrupt or a variable.

    unit: the unit that has the signal; "" for a wire.
    where, what: `Record.where` and `Record.what` in the records of the signal.
    module, register, field: the module, register and field of a field; "", None and None for another signal.
    """

    kind: Kind
    name: str
    unit: str
    where: str
    what: str
    module: str = ""
    register: Register | None = None
    field: Field | None = None


def asked(run: Run, question: str) -> tuple[RecordedSignal, int]:
    """Return the signal and the tick of a question NAME@TIME.

    Raise NotInRun if the question has another form, if the time is invalid or outside the run, or as `named` does.
    """
    name, at, time = question.rpartition("@")
    if not at or not name.strip():
        raise NotInRun(f"{question!r}: expected NAME@TIME, as in I2C-A.I2CSTR.XRDY@12.345ms or SDA@3us")
    subject = named(run, name.strip())
    return subject, _tick(run, time, subject)


def named(run: Run, name: str) -> RecordedSignal:
    """Return the signal that a name means. Raise NotInRun if no signal matches, or if several signals match."""
    known = subjects(run)
    wanted = _folded(name)
    found = (
        [s for s in known if s.name == name]
        or [s for s in known if s.name.endswith("." + name)]
        # Names in another spelling are tried last. Otherwise, "model" would mean the wire "MODEL", not the span
        # "dsp.model".
        or [s for s in known if _folded(s.name) == wanted]
        or [s for s in known if _folded(s.name).endswith("." + wanted)]
    )
    if len(found) == 1:
        return found[0]
    if found:
        names = ", ".join(s.name for s in found[:8])
        raise NotInRun(f"{run.name}: {name!r} may mean {names}{', ...' if len(found) > 8 else ''}; give one of them")
    raise NotInRun(f"{run.name}: nothing in the run is called {name!r}; {_hint(known, name)}")


def subjects(run: Run) -> list[RecordedSignal]:
    """Return all signals of a run: every field of its modules, and the other signals that have at least one record."""
    found = []
    for unit, modules in run.units.items():
        for module in modules:
            for register in registers_of(module) or ():
                for f in register.fields:
                    what = f"{register.name}.{f.name}"
                    where = f"{unit}.{module}"
                    found.append(RecordedSignal(Kind.FLAG, f"{where}.{what}", unit, where, what, module, register, f))
    table = run.table
    for kind in (Kind.EDGE, Kind.SPAN, Kind.IRQ, Kind.FLAG):
        rows = run.rows(kind)
        if kind is Kind.FLAG:
            memories = [code for code, where in enumerate(table.names["where"]) if where.endswith(f".{MEMORY}")]
            rows = rows[np.isin(table.columns["where"][rows], memories)]
        codes = table.columns["where"][rows].astype(np.int64) << 32 | table.columns["what"][rows]
        rows = rows[np.sort(np.unique(codes, return_index=True)[1])]
        for place, thing in zip(table.texts("where", rows), table.texts("what", rows), strict=True):
            unit, name = ("", place) if kind is Kind.EDGE else (place, f"{place}.{thing}")
            unit = unit.removesuffix(f".{MEMORY}")
            found.append(RecordedSignal(kind, name, unit, place, thing))
    return found


def _tick(run: Run, text: str, subject: RecordedSignal) -> int:
    """Return the tick that a time in a question means.

    Reports show rounded times. Therefore, if the time of a change of the signal rounds to the typed time, the result is
    the tick of the nearest such change. A time whose last digit is worth more than COARSEST, such as "12 ms", is exact.
    """
    try:
        at = seconds(text)
    except TimeError as error:
        raise NotInRun(str(error)) from None
    tick = int(at * run.per_second // 1)
    if not 0 <= tick <= run.table.end:
        raise NotInRun(f"{run.name}: {text.strip()} is outside the run, which goes from 0 to {run.at(run.table.end)}")
    digit = _last_digit(text)
    if digit > COARSEST:
        return tick
    changes = run.rows(subject.kind, subject.where, subject.what)
    place = int(np.searchsorted(run.table.tick[changes], tick, "right"))
    around = [int(run.table.tick[row]) for row in changes[max(place - 1, 0) : place + 1]]
    meant = min(around, key=lambda one: abs(run.seconds(one) - at), default=tick)
    return meant if abs(run.seconds(meant) - at) <= digit / 2 else tick


def _last_digit(text: str) -> Fraction:
    """Return by how many seconds a time grows if its last digit grows by one: 1e-10 for "26730.2667us".

    Return 1 if the time begins with a sign, or if its number does not end with a digit.
    """
    number = text.strip()[: len(text.strip()) - len(text.strip().lstrip("0123456789._"))]
    zeros = re.sub(r"\d", "0", number)
    return seconds(f"{zeros[:-1]}1{text.strip()[len(number) :]}") if zeros[-1:] == "0" else Fraction(1)


def _hint(known: list[RecordedSignal], name: str) -> str:
    """Return a suggestion for `name`: the most similar known names.

    If `name` leaves out the first parts of a full name, such as the unit, known names are compared without these parts.
    If no name is similar, the suggestion lists the modules and wires of the run.
    """
    parts = name.count(".") + 1
    short = dict.fromkeys(".".join(s.name.split(".")[-parts:]) for s in known if s.name.count(".") + 1 >= parts)
    phrase = did_you_mean(name, short)
    if phrase.startswith("did you mean"):
        return phrase
    wires = [s.name for s in known if s.kind is Kind.EDGE]
    modules = dict.fromkeys(s.where for s in known if s.kind is Kind.FLAG)
    return f"it has fields of {', '.join(modules)}; wires {', '.join(wires) or 'none'}"


def _folded(name: str) -> str:
    return name.casefold().replace("-", "")


def groups_of(run: Run, register: str | None) -> list[tuple[Group, Field | None]]:
    """Return the groups of accesses to a register, each with the field that is selected; None for all fields.

    A group has all reads, or all writes, of the register by one unit. Raise NotInRun if the firmware never accessed
    the register.

    register: a name such as "I2C-A.I2CSTR" or "I2C-A.I2CSTR.XRDY"; None selects every status register.
    """
    if register is None:
        return [(group, None) for group in run.accesses if is_status(group.register)]
    wanted = _folded(register)
    known: dict[str, list[tuple[Group, Field | None]]] = {}
    for group in run.accesses:
        for unit in ("", f"{group.unit}."):
            text = f"{unit}{group.module}.{group.register.name}"
            known.setdefault(text, []).append((group, None))
            for f in group.register.fields:
                known.setdefault(f"{text}.{f.name}", []).append((group, f))
    for text, found in known.items():
        if _folded(text) == wanted:
            return found
    registers = [text for text in known if text.count(".") == min(max(register.count("."), 1), 2)]
    raise NotInRun(f"{run.name}: the firmware never accessed {register!r}; {did_you_mean(register, registers)}")
