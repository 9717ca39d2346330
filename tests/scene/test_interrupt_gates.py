"""Interrupts of a whole unit, from a module's flag or a pin edge to the service routine.

Each gate on the path is closed, one at a time, and no other interrupt is served meanwhile. A pin edge passes the
qualifier and XINT first.

flag --enable of the module--> PIEIFR --PIEIER--> PIEACK open? --> IFR --IER--> INTM = 0 --> routine
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from functools import partial

import pytest

from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.time import Timebase
from periph_sim.core.wire import Wire
from periph_sim.f28335.cpu.code_costs import BARE
from periph_sim.f28335.pie.register_map import CPU_VECTORS, LINES
from periph_sim.f28335.system_options import SystemOptions
from periph_sim.firmware import start_pie
from periph_sim.processor.dsp import Dsp, DspPlan

MODULES = ("SCI-A", "I2C-A", "GPIO", "XINT", "TIMER0", "TIMER1", "TIMER2")
TICKS = 20  # a cycle


def sci(dsp: Dsp, receive: int, transmit: int) -> None:
    """Start the SCI in loop-back, so that a word that is sent is received."""
    module = dsp.module("SCI-A")
    module.SCICCR.all = 0x17
    module.SCILBAUD.all = 1
    module.SCICTL1.all = 0x23
    module.SCICTL2.all = receive << 1 | transmit
    if not transmit:
        module.SCITXBUF.all = 0x55


def i2c(dsp: Dsp, enable: int) -> None:
    """Enable I2C interrupts; XRDY is 1 from the reset on."""
    dsp.module("I2C-A").I2CMDR.all = 0x20
    dsp.module("I2C-A").I2CIER.all = enable << 4


def i2c_fifo(dsp: Dsp, enable: int) -> None:
    dsp.module("I2C-A").I2CMDR.all = 0x20
    dsp.module("I2C-A").I2CFFTX.all = 0x6000 | enable << 5


def timer(number: int) -> Callable[[Dsp, int], None]:
    def provoke(dsp: Dsp, enable: int) -> None:
        module = dsp.module(f"TIMER{number}")
        module.PRD.all = 20_000
        module.TCR.all = 0x8020 | enable << 14

    return provoke


def xint(line: int) -> Callable[[Dsp, int], None]:
    """XINT1 and XINT2 select GPIO0, which rises; XINT3 to XINT7 select GPIO32, which falls."""

    def provoke(dsp: Dsp, enable: int) -> None:
        dsp.module("XINT")[f"XINT{line}CR"].all = (4 if line < 3 else 0) | enable
        gpio, port = dsp.module("GPIO"), "A" if line < 3 else "B"
        if line < 3:
            gpio.GPASET.all = 1
        dsp.eallow()
        gpio[f"GP{port}DIR"].all = 1
        dsp.edis()

    return provoke


def watchdog(dsp: Dsp, enable: int) -> None:
    """Write a wrong WDCHK with WDENINT = 1."""
    dsp.eallow()
    system = dsp.module("SYS")
    system.SCSR.all = 2
    system.WDCR.all = 0x28
    system.WDCR.all = 0
    dsp.edis()


SOURCES: dict[str, Callable[[Dsp, int], None]] = {
    "SCIRXINTA": lambda dsp, enable: sci(dsp, enable, 0),
    "SCITXINTA": lambda dsp, enable: sci(dsp, 0, enable),
    "I2CINT1A": i2c,
    "I2CINT2A": i2c_fifo,
    "TINT0": timer(0),
    "INT13": timer(1),
    "INT14": timer(2),
    **{f"XINT{line}": xint(line) for line in range(1, 8)},
    "WAKEINT": watchdog,
}

GATES = ["none", "enable", "PIEIER", "PIEACK", "IER", "INTM"]


def cases() -> list[tuple[str, str]]:
    not_there = {("WAKEINT", "enable"), *((name, gate) for name in ("INT13", "INT14") for gate in ("PIEIER", "PIEACK"))}
    return [(source, gate) for source in SOURCES for gate in GATES if (source, gate) not in not_there]


@pytest.mark.rule("SYS-096", "SYS-099", "SYS-100", "SYS-101", "SYS-128")
@pytest.mark.parametrize(("source", "closed"), cases())
def test_a_closed_gate_holds_its_request_and_no_other_interrupt_is_served(source: str, closed: str):
    group, line = LINES.get(source, (0, 0))
    number = group or CPU_VECTORS[source]
    reset = 0xFFF if closed == "PIEACK" else 0
    kernel, system = Kernel(), SystemOptions(pieack_reset=reset)
    dsp = Dsp(kernel, Timebase(150_000_000), Recorder(), DspPlan("dsp", MODULES, {}, code=BARE, system=system))
    served: Counter[str] = Counter()
    seen: list[tuple[dict[str, int], list[int], int]] = []
    pie = dsp.module("PIE")

    def routine(name: str) -> Callable[[], None]:
        def serve() -> None:
            served[name] += 1
            pie.PIEACK.all = 1 << LINES.get(name, (1, 0))[0] - 1

        return serve

    def note_state() -> None:
        flags = [dsp.pie.peek(0, 2 * g + 1) for g in range(1, 13)]
        seen.append((dict(served), flags, dsp.core.ifr))

    def main() -> None:
        for name in (*LINES, "INT13", "INT14"):
            dsp.handle(name, routine(name))
        pie.PIECTRL.ENPIE = 1
        for g in range(1, 13):
            pie[f"PIEIER{g}"].all = 0xFF & ~(1 << line - 1 if g == group and closed == "PIEIER" else 0)
        dsp.cpu.or_ier(0xFFFF & ~(1 << number - 1 if closed == "IER" else 0))
        if closed != "INTM":
            dsp.eint()
        dsp.eallow()
        dsp.module("SYS").PCLKCR0.all = 1 << 10 | 1 << 4
        dsp.edis()
        dsp.compute(10)
        SOURCES[source](dsp, int(closed != "enable"))
        dsp.compute(30_000)
        note_state()
        if closed == "PIEIER":
            pie[f"PIEIER{group}"].all = 0xFF
        elif closed == "PIEACK":
            pie.PIEACK.all = 0xFFF
        elif closed == "IER":
            dsp.cpu.or_ier(0xFFFF)
        elif closed == "INTM":
            dsp.eint()
        dsp.compute(1000)
        note_state()

    dsp.start(main)
    kernel.run_until(50_000 * TICKS)
    flagged = [0] * 12
    if group and closed not in ("none", "enable"):
        flagged[group - 1] = 1 << line - 1
    latched = 1 << number - 1 if closed in ("IER", "INTM") else 0
    once = {source: 1}
    assert seen == [
        (once if closed == "none" else {}, flagged, latched),
        ({} if closed == "enable" else once, [0] * 12, 0),
    ]


CYCLE = 20  # ticks
WINDOW = {0: 0, 1: 2, 2: 5}  # QSEL -> qualification window in SYSCLKOUT cycles, QUALPRD = 0


@pytest.mark.rule("SYS-140", "SYS-079", "SYS-080", "SYS-121")
@pytest.mark.parametrize("qsel", [0, 1, 2])
@pytest.mark.parametrize("phase", [0, 1, 7, 19])
def test_a_pin_edge_reaches_the_vector_fetch_within_its_window_and_twelve_cycles(qsel, phase):
    kernel, recorder = Kernel(), Recorder()
    wire = Wire(kernel, "BUTTON", recorder)
    hand = wire.attach("hand")
    dsp = Dsp(kernel, Timebase(150_000_000), recorder, DspPlan("dsp", ("GPIO", "XINT"), {7: wire}, code=BARE))
    entered: list[int] = []

    def main() -> None:
        gpio, xint = dsp.module("GPIO"), dsp.module("XINT")
        dsp.eallow()
        gpio.GPAQSEL1.GPIO7 = qsel
        gpio.GPIOXINT1SEL.all = 7
        dsp.edis()
        xint.XINT1CR.all = 1  # falling edge, enabled
        start_pie(dsp, {"XINT1": lambda: entered.append(dsp.cpu.cycle)})
        dsp.compute(10_000)

    dsp.start(main)
    edge = 2000 * CYCLE + phase
    kernel.call_at(edge, lambda: hand.drive(0))
    kernel.run_until(5000 * CYCLE)
    (first_instruction,) = entered
    vector_fetch = dsp.clock.tick(first_instruction - 9)
    assert 0 < vector_fetch - edge <= (WINDOW[qsel] + 12) * CYCLE


def count_served(
    levels: list[tuple[int, int]], modules: tuple[str, ...], pin: int, setup: Callable[[Dsp], None]
) -> int:
    """Return how often XINT1 is served. It selects both edges of a pad that has these levels at these ticks."""
    kernel, recorder = Kernel(), Recorder()
    wire = Wire(kernel, "PAD", recorder)
    hand = wire.attach("hand")
    dsp = Dsp(kernel, Timebase(150_000_000), recorder, DspPlan("dsp", modules, {pin: wire}))
    served: list[int] = []

    def main() -> None:
        gpio, xint, pie = dsp.module("GPIO"), dsp.module("XINT"), dsp.module("PIE")
        dsp.eallow()
        setup(dsp)
        gpio.GPIOXINT1SEL.all = pin
        dsp.edis()
        xint.XINT1CR.all = 0b1101  # both edges, enabled
        start_pie(dsp, {"XINT1": lambda: served.append(dsp.cpu.cycle) or pie.PIEACK.__setattr__("all", 1)})
        dsp.compute(10_000)

    dsp.start(main)
    for tick, level in levels:
        kernel.call_at(2000 * CYCLE + tick, partial(hand.drive, level))
    kernel.run_until(5000 * CYCLE)
    return len(served)


def to_sci(dsp: Dsp) -> None:
    gpio = dsp.module("GPIO")
    gpio.GPAMUX2.GPIO28 = 1
    gpio.GPAQSEL2.GPIO28 = 3


@pytest.mark.parametrize("setup", [lambda dsp: None, to_sci], ids=["synchronised", "asynchronous"])
def test_a_pin_of_the_sci_can_interrupt_as_well(setup):
    """The start bit can wake the CPU, for example: GPIOXINTnSEL selects the pad whatever the multiplexer selects."""
    assert count_served([(0, 0), (40_000, 1)], ("GPIO", "XINT", "SCI-A"), 28, setup) == 2


@pytest.mark.parametrize("setup", [lambda dsp: None, to_sci], ids=["synchronised", "asynchronous"])
@pytest.mark.parametrize(
    ("rise", "seen"),
    [
        (19, 0),  # falls and rises between two SYSCLKOUT edges: no sample is low
        (21, 1),  # two edges a cycle apart, one flag in PIEIFR
    ],
)
def test_a_pulse_between_two_sysclkout_edges_is_not_seen(setup, rise, seen):
    assert count_served([(1, 0), (rise, 1)], ("GPIO", "XINT", "SCI-A"), 28, setup) == seen
