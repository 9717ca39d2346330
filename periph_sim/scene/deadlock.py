"""Firmware that waits for what cannot come: a unit's wait goes in, the reason why it is hopeless, or none, comes out.

    registers that the wait reads <-- their modules, if they have a clock: what they have due by themselves,
                                      and wires, moved by other parties
                                  <-- service routines, if interrupts are on: then every module counts
    memory that the wait reads    <-- service routines
    IDLE                          <-- interrupts that IER and PIEIER enable

An agent whose schedule is over could have gone on: who waits for more of it is idle, not stuck.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, cast

from ..core.chip import NEVER
from ..core.wire import Wire
from ..f28335.cpu.pie_map import GROUPS, PIEIER
from ..f28335.i2c.register_map import STR_NACK
from ..f28335.unit_modules import GATED, PIN_OF

if TYPE_CHECKING:
    from ..f28335.gpio.module import Gpio
    from ..f28335.i2c.module import I2c
    from ..processor.dsp import Dsp
    from ..processor.polling import Spin

INPUTS = {
    "I2C-A": ("SDAA", "SCLA"),
    "SCI-A": ("SCIRXDA",),
    "SCI-B": ("SCIRXDB",),
    "SCI-C": ("SCIRXDC",),
    "TIMER0": (),
    "TIMER1": (),
    "TIMER2": (),
    "SYS": (),
}
OFF = ("IER = 0", "INTM = 1")  # by whether INTM is
ENABLE = "enable interrupts before the wait (CLRC INTM, bits of IER)"
OUTPUTS = {pin for signal, pin in PIN_OF.items() if signal.startswith("SCITXD")}
FOREIGN = {  # by module: pins that it does not see
    module: OUTPUTS.union(PIN_OF[signal] for name, signals in INPUTS.items() if name != module for signal in signals)
    for module in INPUTS
}


def deadlock_reason(dsp: Dsp, may_move: Callable[[Wire, list[str]], bool], instant: Callable[[int], str]) -> str:
    """Why the wait that `dsp` is in cannot end, as a clause; empty if it can, or if it is in none.

    may_move: whether the named parties, who are not of this unit, may ever move the wire. instant: a tick for people.
    """
    if not dsp.processor.time.waits_for_input:
        return ""
    if dsp.core.idlestat:
        return sleep_reason(dsp)
    spin = dsp.program.spin
    if spin is None:
        return ""
    unanswered = dsp.program.unanswered()
    if not spin.polls and not unanswered:
        if not dsp.program.waits_for_memory() or watchdog_runs(dsp):
            return ""  # an endless loop of the program's own
        if not takes_interrupts(dsp):
            return f"only a service routine could change that, and {OFF[bool(dsp.core.intm)]}; {ENABLE}"
    modules = [module for module in signals_behind(dsp, spin) if has_clock(dsp, module)]
    if not modules and not unanswered:
        return f"PCLKCR gives {' and '.join(dict.fromkeys(poll.place.name for poll in spin.polls))} no clock"
    wires = {wire.name: wire for module in modules for wire in wires_into(dsp, module)}
    for wire in wires.values():
        others = [who for who in wire.parties() if not who.startswith(f"{dsp.name}.")]
        if others and may_move(wire, others):
            return ""
    if any(dsp.socket(module).chip.next_wake < NEVER for module in modules) or dsp.core.next_wake < NEVER:
        return ""
    if unanswered:
        return unanswered
    due = f"{' and '.join(modules)} {'has' if len(modules) == 1 else 'have'} nothing due"
    inputs = [name for name in wires if name not in outputs(dsp)]
    moved = f"nobody will move {' or '.join(inputs)}" if inputs else "no wire leads there"
    ignored = refused(dsp, instant) if "I2C-A" in modules else ""
    return f"{due} and {moved}{f'; {ignored}' if ignored else ''}"


def sleep_reason(dsp: Dsp) -> str:
    """Why no interrupt can end IDLE; empty if one can, or the watchdog's reset."""
    ier = dsp.core.ier
    if watchdog_runs(dsp) or ier >> GROUPS:
        return ""
    if not ier:
        return "IER = 0, so that no interrupt can wake it; enable one in IER before IDLE"
    groups = [group for group in range(1, GROUPS + 1) if ier >> group - 1 & 1]
    if any(dsp.pie.peek(0, PIEIER[group - 1].offset) for group in groups):
        return ""
    lines = " and ".join(f"INT{group}" for group in groups)
    closed = " and ".join(f"PIEIER{group} = 0" for group in groups)
    return f"IER enables {lines} only, with {closed}; set the bit of a line in its PIEIER before IDLE"


def watchdog_runs(dsp: Dsp) -> bool:
    """Its reset will come, or an interrupt by it."""
    return dsp.control.next_wake < NEVER


def takes_interrupts(dsp: Dsp) -> bool:
    return bool(dsp.core.ier and not dsp.core.intm)


def refused(dsp: Dsp, instant: Callable[[int], str]) -> str:
    """That I2CSTR.NACK is set, as a clause with since when and why; empty if it is not. It ended the transfer."""
    state = cast("I2c", dsp.socket("I2C-A").chip).state
    if not state.str & STR_NACK:
        return ""
    since = f"I2CSTR.NACK is set since {instant(dsp.clock.tick(state.nack_since))}"
    return f"{since}: {state.nack_of} was not acknowledged" if state.nack_of else since


def outputs(dsp: Dsp) -> list[str]:
    """Wires at pins that the unit itself drives as general-purpose outputs."""
    socket = dsp.sockets.get("GPIO")
    driven = 0 if socket is None else cast("Gpio", socket.chip).driven
    return [wire.name for pin, wire in dsp.plan.wires.items() if driven >> pin & 1]


def signals_behind(dsp: Dsp, spin: Spin) -> list[str]:
    """Modules on which the end of a wait depends."""
    read = list(dict.fromkeys(poll.place.name for poll in spin.polls))
    if takes_interrupts(dsp) or "PIE" in read:
        return list(dsp.sockets)
    return read


def has_clock(dsp: Dsp, module: str) -> bool:
    return module not in GATED or dsp.control.enabled(module)


def wires_into(dsp: Dsp, module: str) -> list[Wire]:
    """Wires that a module may see: those of its usual pins, and all whose pins are of no module in particular."""
    wires = dsp.plan.wires
    if module not in INPUTS:
        return list(wires.values())
    if not INPUTS[module]:
        return []
    foreign = FOREIGN[module]
    return [wire for pin, wire in wires.items() if pin not in foreign]
