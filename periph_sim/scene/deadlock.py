"""Detection of firmware that waits for an event that cannot occur, with the reason.

    the wait depends on         what can end the wait
    registers of a module       if the module's clock is on: its events, and changes of its wires by other parties;
                                if the CPU takes interrupts: also the events and wires of the modules whose interrupts
                                are enabled; the watchdog, if no service routine restarts it
    registers without a model   the watchdog, if no service routine restarts it
    memory                      service routines of interrupts, and the watchdog
    IDLE                        the watchdog; events and wires of the modules whose interrupts IER and PIEIER enable

A unit is idle, not stuck, if it waits for an agent that has completed its schedule, or for firmware that has ended,
because the wait could end with a longer schedule or other firmware. Units that wait only for each other are stuck.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, cast

from ..core.chip import NEVER
from ..core.wire import Wire
from ..f28335.i2c.register_map import STR_NACK
from ..f28335.pie.register_map import CPU_VECTORS, GROUPS, LINES, PIEIER

if TYPE_CHECKING:
    from ..f28335.gpio.module import Gpio
    from ..f28335.i2c.module import I2c
    from ..processor.dsp import Dsp
    from ..processor.polling import Spin
    from .scene import Scene


OFF = ("IER = 0", "INTM = 1")  # why no interrupt is taken, indexed by the value of INTM
ENABLE = "enable interrupts before the wait (CLRC INTM, bits of IER)"
# A wait that has lasted for this number of watchdog periods shows that a service routine restarts the watchdog in time,
# because otherwise the watchdog would have reset or interrupted the unit.
RESTARTED = 2


def deadlock_reason(dsp: Dsp, may_move: Callable[[Wire, list[str]], bool], instant: Callable[[int], str]) -> str:
    """Return a phrase that says why the wait of `dsp` cannot end; "" if it can end, or if there is no wait.

    may_move: a function that takes a wire and its parties outside the unit, and returns True if any of these parties
        may still change the wire.
    instant: a function that returns a tick as text.
    """
    wait = dsp.program.unanswered_wait()
    if wait is not None:
        return "" if watchdog_ends(dsp, wait.since) else wait.unanswered
    if not dsp.processor.time.waits_for_input and not polls_for_input(dsp):
        return ""
    if dsp.core.idlestat:
        return sleep_reason(dsp) or ("" if watchdog_runs(dsp) else nothing_comes(dsp, waking(dsp), may_move, instant))
    spin = dsp.program.spin
    if spin is None:
        return ""
    awaited = dsp.program.awaited()
    unanswered = awaited.unanswered
    if not spin.polls and not unanswered:
        if not awaited.memory or watchdog_runs(dsp):
            return ""  # firmware loops without a wait, or the watchdog will end its wait
        if not takes_interrupts(dsp):
            return f"only a service routine could change that, and {OFF[bool(dsp.core.intm)]}; {ENABLE}"
    if spin.polls and watchdog_ends(dsp, spin.since):
        return ""
    gates = {module: dsp.plan.part.by_name[module].gate for module in signals_behind(dsp, spin)}
    modules = [module for module, gate in gates.items() if not gate or dsp.control.enabled(gate)]
    if spin.polls and not modules and not unanswered:
        return f"PCLKCR gives {' and '.join(dict.fromkeys(poll.place.name for poll in spin.polls))} no clock"
    found = nothing_comes(dsp, modules, may_move, instant)
    return unanswered or found if found else ""


def nothing_comes(
    dsp: Dsp, modules: list[str], may_move: Callable[[Wire, list[str]], bool], instant: Callable[[int], str]
) -> str:
    """Return a phrase that says why no event of these modules and no wire will end a wait.

    Return "" if an event or a wire may end the wait.

    modules: the modules on whose events the end of the wait depends.
    """
    wires = {wire.name: wire for module in modules for wire in wires_into(dsp, module)}
    for wire in wires.values():
        others = [who for who in wire.parties() if not who.startswith(f"{dsp.name}.")]
        if others and may_move(wire, others):
            return ""
    if any(dsp.sockets[module].chip.next_wake < NEVER for module in modules) or dsp.core.next_wake < NEVER:
        return ""
    if not modules:
        return "no module of the unit has an interrupt that IER and PIEIER enable; enable one, or name its module"
    due = f"{' and '.join(modules)} {'has' if len(modules) == 1 else 'have'} nothing due"
    inputs = [name for name in wires if name not in outputs(dsp)]
    moved = f"no party will change {' or '.join(inputs)}" if inputs else "no wire leads there"
    ignored = refused(dsp, instant) if "I2C-A" in modules else ""
    return f"{due} and {moved}{f'; {ignored}' if ignored else ''}"


def polls_for_input(dsp: Dsp) -> bool:
    """Return True if firmware polls without a timeout, and only an input from outside the CPU can end its polls.

    A further pass of the wait would read the values of the previous pass, and no write or interrupt is pending. This
    function is for runs in which the simulator executes every poll. In runs in which polls are skipped,
    `CpuTime.waits_for_input` is True for such a wait.
    """
    spin, time = dsp.program.spin, dsp.processor.time
    waits = spin is not None and spin.ends == NEVER and spin.unchanged(time.cycle)
    return waits and time.lands == NEVER and dsp.core.earliest() == NEVER


def sleep_reason(dsp: Dsp) -> str:
    """Return the reason why no interrupt can end IDLE; "" if an interrupt or a reset by the watchdog can end it."""
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
    """Return True if the watchdog will reset the unit or interrupt it."""
    return dsp.control.next_wake < NEVER


def watchdog_ends(dsp: Dsp, since: int) -> bool:
    """Return True if the watchdog will end a wait by a reset or an interrupt.

    It will if it is enabled, and no service routine restarts it during the wait (see RESTARTED).

    since: the cycle at which the wait began.
    """
    now = dsp.clock.cycle_at(dsp.processor.time.instant()[1])
    return watchdog_runs(dsp) and dsp.control.watchdog_rounds(since, now) < RESTARTED


def takes_interrupts(dsp: Dsp) -> bool:
    return bool(dsp.core.ier and not dsp.core.intm)


def refused(dsp: Dsp, instant: Callable[[int], str]) -> str:
    """Return when I2CSTR.NACK was set, and, if known, what was not acknowledged, as a phrase; "" if NACK is 0."""
    state = cast("I2c", dsp.sockets["I2C-A"].chip).state
    if not state.str & STR_NACK:
        return ""
    since = f"I2CSTR.NACK is set since {instant(dsp.clock.tick(state.nack_since))}"
    return f"{since}: {state.nack_of} was not acknowledged" if state.nack_of else since


def outputs(dsp: Dsp) -> list[str]:
    """Return the names of the wires that the unit drives through pins configured as general-purpose outputs."""
    socket = dsp.sockets.get("GPIO")
    driven = 0 if socket is None else cast("Gpio", socket.chip).driven
    return [wire.name for pin, wire in dsp.plan.wires.items() if driven >> pin & 1]


def signals_behind(dsp: Dsp, spin: Spin) -> list[str]:
    """Return the names of the modules whose events may end a wait.

    These are the polled modules and, if the CPU takes interrupts, the modules whose interrupts are enabled. If the PIE
    is polled, they are all modules of the unit.
    """
    read = list(dict.fromkeys(poll.place.name for poll in spin.polls))
    if "PIE" in read:
        return list(dsp.sockets)
    return list(dict.fromkeys([*read, *waking(dsp)])) if takes_interrupts(dsp) else read


def waking(dsp: Dsp) -> list[str]:
    """Return the names of the unit's modules whose interrupts IER and PIEIER enable; IER alone for INT13 and INT14."""
    ier = dsp.core.ier
    enabled = [
        name
        for name, (group, line) in LINES.items()
        if ier >> group - 1 & 1 and dsp.pie.peek(0, PIEIER[group - 1].offset) >> line - 1 & 1
    ]
    direct = (name for name, number in CPU_VECTORS.items() if number > GROUPS and ier >> number - 1 & 1)
    found = dict.fromkeys(module for vector in (*enabled, *direct) for module in dsp.plan.part.requesters(vector))
    return [module for module in found if module in dsp.sockets]


def wires_into(dsp: Dsp, module: str) -> list[Wire]:
    """Return the wires that a module can read.

    For a module with input pins, these are the wires of these pins, and of the pins that belong to no module. For a
    module without input pins, there are none. For a module that can read any pin, these are all wires of the unit.
    """
    wires, part = dsp.plan.wires, dsp.plan.part
    inputs = part.by_name[module].inputs
    if inputs is None:
        return list(wires.values())
    if not inputs:
        return []
    foreign = {pin for signal, pin in part.pins.items() if signal not in inputs}
    return [wire for pin, wire in wires.items() if pin not in foreign]


SETTLED = Fraction(1, 1_000_000)  # seconds after which delayed outputs and hold times are over


def deadlocks_of(scene: Scene) -> list[str]:
    """Return a sentence for each unit whose firmware waits for an event that cannot occur.

    The sentence names the wait and the reason, and the start of a wait outside IDLE. If the run was aborted because
    firmware or a device let no simulated time pass, return only the sentence about this code.
    """
    if scene.stalled:
        return [scene.stalled]
    instant = partial(_instant, scene)
    stuck = dict.fromkeys(scene.units, "")
    before = -1
    while len(stuck) != before:  # a unit that is not stuck may end the wait of another unit
        before, may_move = len(stuck), partial(_may_move, scene, set(stuck))
        found = {name: deadlock_reason(scene.units[name], may_move, instant) for name in stuck}
        stuck = {name: why for name, why in found.items() if why}
    return [f"{name} {scene.doing(scene.units[name])} and would for ever: {why}" for name, why in stuck.items()]


def _instant(scene: Scene, tick: int) -> str:
    return scene.timebase.show(tick - scene.start)


def _may_move(scene: Scene, stuck: set[str], wire: Wire, parties: list[str]) -> bool:
    """Return True if one of these parties may still change the wire, or if an event is due within SETTLED.

    stuck: the units whose waits cannot end, as far as known.

    - A unit may change the wire if it is not in `stuck`.
    - A chip or device on SCL or SDA may change the wire if it holds the wire low and an event is due.
    - The controller agent may change the wire if it does not wait within a round, or if an event is due.
    - Any other party may change the wire.
    """
    coming = scene.kernel.next_time()
    if coming <= scene.kernel.now + scene.timebase.ticks(SETTLED):
        return True
    held = wire.held_by()
    for who in parties:
        name = who.partition(".")[0]
        if name in scene.units:
            may = name not in stuck
        elif wire.name in ("SCL", "SDA") and (name in scene.chips or name in scene.devices):
            may = who in held and coming < NEVER
        elif name == "controller" and scene.head is not None:
            may = scene.head.at_rest or coming < NEVER
        else:
            may = True
        if may:
            return True
    return False
