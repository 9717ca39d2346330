"""Notes on modules that firmware has put on pins without a wire, with the keys to add.

Source: SPRUFB0D Tables 46 to 49.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

if TYPE_CHECKING:
    from ..f28335.descriptor import ModuleDescriptor
    from ..f28335.gpio.module import Gpio
    from ..processor.dsp import Dsp


def unwired_pins(dsp: Dsp) -> list[str]:
    """Return notes on pins by GPxMUX at the end of the run; empty if every module in use has its wires."""
    gpio, part = cast("Gpio", dsp.socket("GPIO").chip), dsp.plan.part
    told = []
    for module in dsp.sockets:
        descriptor = part.by_name[module]
        if descriptor.bus:
            continue
        pins = {end: _pins(gpio, descriptor, signal) for end, signal in descriptor.wires.items()}
        bare = {end: min(on) for end, on in pins.items() if on and not set(on) & set(dsp.plan.wires)}
        if bare:
            places = " and ".join(f"{end} on GPIO{pin}" for end, pin in bare.items())
            keys = ", ".join(
                f"{_key(dsp.plan.wires[part.pins[descriptor.wires[end]]].name)} = {pin}" for end, pin in bare.items()
            )
            told.append(
                f"{dsp.name}: {module} has {places}, where the case has no wire; add pins = {{ {keys} }} to the unit"
            )
    return told


def _pins(gpio: Gpio, descriptor: ModuleDescriptor, signal: str) -> tuple[int, ...]:
    """Return the pins that GPxMUX connects to a signal."""
    if signal in descriptor.outputs:
        return gpio.sink(signal)
    source = gpio.source(signal)
    return () if source is None else (source,)


def _key(name: str) -> str:
    """Return a name as a TOML key."""
    return f'"{name}"' if "." in name else name
