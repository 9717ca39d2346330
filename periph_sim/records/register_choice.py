"""Choice of the accesses that a question is about, by a register's name.

"I2C-A.I2CSTR", "dsp.I2C-A.I2CSTR.XRDY", None for every status register --> groups, each with the named field
"""

from __future__ import annotations

from ..core.registers import Field
from ..core.suggest import did_you_mean
from .register_maps import is_status
from .run import Group, NotInRun, Run


def groups_of(run: Run, register: str | None) -> list[tuple[Group, Field | None]]:
    """Return the groups of accesses to a register, each with the named field, None for the whole register.

    register: None for every status register. Raise NotInRun if the firmware never accessed what is named.
    """
    if register is not None:
        return _named(run, register)
    return [(group, None) for group in run.accesses if is_status(group.register)]


def _named(run: Run, name: str) -> list[tuple[Group, Field | None]]:
    wanted = _folded(name)
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
    registers = [text for text in known if text.count(".") == min(max(name.count("."), 1), 2)]
    raise NotInRun(f"{run.name}: the firmware never accessed {name!r}; {did_you_mean(name, registers)}")


def _folded(name: str) -> str:
    return name.casefold().replace("-", "")
