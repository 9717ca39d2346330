"""The register or field that a measure of races or of lost flags names.

text + Scope --raced, losing, clearing--> Watched, or BadEvent if the measure is impossible for this register
"""

from __future__ import annotations

from msgspec import Struct

from ...core.phrases import did_you_mean
from ...core.records import Kind
from ...records.register_maps import is_status, one_clears
from ..language.scope import MAPS, BadEvent, Scope


class Watched(Struct, frozen=True):
    """The status register, or one field of it, that a measure names.

    text: the name of the register or field in the measure's text.
    unit, module, register: empty if all registers of the scene are meant.
    field: empty if the whole register is meant.
    units: the units of the scene, if all their registers are meant.
    """

    text: str
    unit: str = ""
    module: str = ""
    register: str = ""
    field: str = ""
    units: tuple[str, ...] = ()

    @property
    def name(self) -> str | None:
        """The name of the register or field as `periph_sim.records` uses it; None for all registers."""
        return ".".join(filter(None, (self.unit, self.module, self.register, self.field))) or None

    def is_about(self, kind: Kind, where: str, what: str) -> bool:
        """Return True if records of this kind, place and thing are accesses to the register or changes of the field.

        If `field` is empty, the changes of all fields of the register are included. If `register` is empty, accesses to
        all registers and the changes of all their fields are included.
        """
        if kind is Kind.ACCESS:
            place = f"{self.module}.{self.register}" if self.register else what[2:]
            return self.concerns(kind, where, what) and what[2:] == place
        field = f"{self.register}.{self.field}" if self.field else what
        return kind is Kind.FLAG and self.concerns(kind, where, what) and what == field

    def concerns(self, kind: Kind, where: str, what: str) -> bool:
        if kind is Kind.ACCESS:
            return where == self.unit or not self.unit
        if not self.unit:
            return True
        return where == f"{self.unit}.{self.module}" and what.startswith(f"{self.register}.")


def raced(unit: str, text: str, scope: Scope) -> Watched:
    """Return the register or field of a name such as "I2C-A.I2CSTR.XRDY" or "I2C-A.I2CSTR".

    Raise BadEvent if hardware changes no flag in the register.
    """
    if text.count(".") == 2:
        owner, module, register, f = scope.field(unit, text)
        field = f.name
    else:
        owner, module, register = scope.register(unit, text)
        field = ""
    if not is_status(register):
        flags = [r.name for r in MAPS[module] if is_status(r)]
        raise BadEvent(
            f"{register.name} is no status register: hardware sets no flag in it; {did_you_mean(register.name, flags)}"
        )
    return Watched(text, owner, module, register.name, field)


def losing(unit: str, text: str, scope: Scope) -> Watched:
    """Return the register whose flags may be lost; all registers of the scene if `text` is empty.

    Raise BadEvent for a register that has no flag that writing 1 clears.
    """
    if not text:
        if not scope.units:
            raise BadEvent("the scene has no unit")
        return Watched("", units=tuple(scope.units))
    owner, module, register = scope.register(unit, text)
    if not one_clears(register):
        flags = [r.name for r in MAPS[module] if one_clears(r)]
        raise BadEvent(
            f"writing 1 clears no flag of {register.name}, so none can be lost; {did_you_mean(register.name, flags)}"
        )
    return Watched(text, owner, module, register.name)


def clearing(unit: str, text: str, scope: Scope) -> Watched:
    """Return the flag that a write may clear along with another flag.

    Raise BadEvent for a flag that is not cleared by writing 1.
    """
    owner, module, register, f = scope.field(unit, text)
    clearable = [each.name for each in one_clears(register)]
    if f.name not in clearable:
        raise BadEvent(f"writing 1 does not clear {text}; {did_you_mean(f.name, clearable)}")
    return Watched(text, owner, module, register.name, f.name)
