"""Every gate on the way from a module's flag to its service routine, shut one at a time: nobody else is served either.

flag --enable of the module--> PIEIFR --PIEIER--> PIEACK open? --> IFR --IER--> INTM = 0 --> routine
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

import pytest

from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Recorder
from periph_sim.core.time import Timebase
from periph_sim.f28335.cpu.compiled_code_costs import BARE
from periph_sim.f28335.pie.register_map import CPU_VECTORS, LINES
from periph_sim.f28335.system_options import SystemOptions
from periph_sim.processor.dsp import Dsp, DspPlan

MODULES = ("SCI-A", "I2C-A", "GPIO", "XINT", "TIMER0", "TIMER1", "TIMER2")
TICKS = 20  # a cycle


def sci(dsp: Dsp, receive: int, transmit: int) -> None:
    """Loop-back: a word that is sent is received."""
    module = dsp.module("SCI-A")
    module.SCICCR.all = 0x17
    module.SCILBAUD.all = 1
    module.SCICTL1.all = 0x23
    module.SCICTL2.all = receive << 1 | transmit
    if not transmit:
        module.SCITXBUF.all = 0x55


def i2c(dsp: Dsp, enable: int) -> None:
    """XRDY is 1 from the reset on."""
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
    """XINT1 and 2 see GPIO0, which rises; XINT3 to 7 GPIO32, which falls."""

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
    """A wrong WDCHK with WDENINT = 1."""
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
@pytest.mark.parametrize(("source", "shut"), cases())
def test_a_shut_gate_holds_its_request_and_lets_no_other_through(source: str, shut: str):
    group, line = LINES.get(source, (0, 0))
    number = group or CPU_VECTORS[source]
    reset = 0xFFF if shut == "PIEACK" else 0
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

    def look() -> None:
        flags = [dsp.pie.peek(0, 2 * g + 1) for g in range(1, 13)]
        seen.append((dict(served), flags, dsp.core.ifr))

    def main() -> None:
        for name in (*LINES, "INT13", "INT14"):
            dsp.handle(name, routine(name))
        pie.PIECTRL.ENPIE = 1
        for g in range(1, 13):
            pie[f"PIEIER{g}"].all = 0xFF & ~(1 << line - 1 if g == group and shut == "PIEIER" else 0)
        dsp.cpu.or_ier(0xFFFF & ~(1 << number - 1 if shut == "IER" else 0))
        if shut != "INTM":
            dsp.eint()
        dsp.eallow()
        dsp.module("SYS").PCLKCR0.all = 1 << 10 | 1 << 4
        dsp.edis()
        dsp.compute(10)
        SOURCES[source](dsp, int(shut != "enable"))
        dsp.compute(30_000)
        look()
        if shut == "PIEIER":
            pie[f"PIEIER{group}"].all = 0xFF
        elif shut == "PIEACK":
            pie.PIEACK.all = 0xFFF
        elif shut == "IER":
            dsp.cpu.or_ier(0xFFFF)
        elif shut == "INTM":
            dsp.eint()
        dsp.compute(1000)
        look()

    dsp.start(main)
    kernel.run_until(50_000 * TICKS)
    flagged = [0] * 12
    if group and shut not in ("none", "enable"):
        flagged[group - 1] = 1 << line - 1
    latched = 1 << number - 1 if shut in ("IER", "INTM") else 0
    once = {source: 1}
    assert seen == [
        (once if shut == "none" else {}, flagged, latched),
        ({} if shut == "enable" else once, [0] * 12, 0),
    ]
