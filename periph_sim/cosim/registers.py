"""Reading of registers by name, such as "I2C-A.I2CSTR.SCD", without side effects on the run, as in a debugger."""

from __future__ import annotations

from ..core.phrases import did_you_mean
from ..outside.errors import OutsideError
from ..scene.scene import Scene


def peek(scene: Scene, place: str) -> int:
    """Return the present value of a register or field.

    place: "MODULE.REGISTER" or "MODULE.REGISTER.FIELD", with "UNIT." in front of it in a scene of several units. Raise
    OutsideError if it is unknown.
    """
    parts = place.split(".")
    if not scene.units:
        raise OutsideError(f"{place}: the scene has no unit, and only units have registers; add a [unit.NAME] table")
    if parts[0] not in scene.units:
        if len(scene.units) > 1:
            raise OutsideError(f"{place}: give the unit; {did_you_mean(parts[0], scene.units)}")
        parts.insert(0, next(iter(scene.units)))
    if len(parts) not in (3, 4):
        raise OutsideError(f"{place!r}: expected MODULE.REGISTER or MODULE.REGISTER.FIELD, such as I2C-A.I2CSTR.SCD")
    unit, module, name = parts[:3]
    modules = scene.case.unit[unit].modules
    if module not in modules:
        raise OutsideError(f"{place}: {unit} has no module {module!r}; {did_you_mean(module, modules)}")
    socket = scene.units[unit].sockets[module]
    registers = {register.name: register for register in socket.chip.MAP}
    if name not in registers:
        raise OutsideError(f"{place}: {module} has no register {name!r}; {did_you_mean(name, registers)}")
    register = registers[name]
    cycle = scene.units[unit].clock.cycle_at(scene.kernel.now)
    touched = frozenset(socket.chip.touched)
    value = socket.peek(cycle, register.offset)
    if register.width == 32:
        value |= socket.peek(cycle, register.offset + 1) << 16
    # `touched` has the undocumented behaviours on which the run depends. This read must not add any.
    socket.chip.touched.intersection_update(touched)
    if len(parts) == 3:
        return value
    fields = {field.name: field for field in register.fields}
    if parts[3] not in fields:
        raise OutsideError(f"{place}: {name} has no field {parts[3]!r}; {did_you_mean(parts[3], fields)}")
    return fields[parts[3]].extract(value)
