"""A slave by software, for any number of addresses: the I2C module's two pins as GPIO, their edges as interrupts.

    SDA GPIO32 --XINT3--> which line moved? --> START, STOP --> the address comes next, or nothing
    SCL GPIO33 --XINT4-->                       rise: a bit has come, or the master's ACK
                                                fall: a bit or an ACK goes out; at a byte's end SCL is held, too

    Low is driven: DIR = 1 with the latch at 0. High is let go: DIR = 0, and a pull-up does it.

An interrupt says that a line moved; the levels are read, both at once. Where both lines have moved by then, SDA's edge
was data. Nothing is lost as long as a routine reads the lines before they move again: docs/any_order.md tells how fast
SCL may be for that. SCL is held where a byte ends, while the target works.

Source: UM10204 sections 3.1.4 to 3.1.10, Table 10; SPRUFB0D sections 6 (GPIO) and 8.6 (XINT).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from periph_sim.firmware import Dsp

from .slave_module import Target

SDA, SCL = 1 << 0, 1 << 1  # GPIO32 and 33 in the registers of port B
BOTH_EDGES = 0xD  # XINTnCR
GROUP_12 = 0x800  # PIEACK
IDLE, ADDRESS, RECEIVE, SEND, OTHERS = range(5)  # OTHERS: up to the next START or STOP it is not for us


@dataclass
class PinCosts:
    """Cycles of the code between the accesses, which the unit's `code` does not count.

    edge: the branches over lines, phase and count, before what the edge asks for is done. byte: the target's part, SCL
    being held. set_up: SDA is out for so long when SCL is let go; 38 are the 250 ns of UM10204 Table 10, tSU;DAT.
    """

    edge: int = 15
    byte: int = 60
    set_up: int = 38


class SlavePins:
    """targets: by address. phase, count: what the next edges mean; so many bits of the byte are done, 9 its ACK too."""

    def __init__(self, dsp: Dsp, targets: Mapping[int, Target], costs: PinCosts) -> None:
        self.dsp = dsp
        self.targets = targets
        self.costs = costs
        self.gpio = dsp.module("GPIO")
        self.pieack = dsp.module("PIE").PIEACK
        self.lines = 0
        self.phase = OTHERS
        self.count = 0
        self.shift = 0  # the byte that comes or goes
        self.reads = False
        self.acked = False  # by the master
        self.target: Target | None = None
        self._others = 0  # of GPBDIR

    def start(self) -> None:
        """Pins and interrupts; nothing that is under way on the bus is for us."""
        dsp, gpio, xint = self.dsp, self.gpio, self.dsp.module("XINT")
        dsp.eallow()
        gpio.GPIOXINT3SEL.GPIOSEL = 0
        gpio.GPIOXINT4SEL.GPIOSEL = 1
        gpio.GPBCLEAR.all = SDA | SCL
        self._others = gpio.GPBDIR.all & ~(SDA | SCL)
        dsp.edis()
        xint.XINT3CR.all = BOTH_EDGES
        xint.XINT4CR.all = BOTH_EDGES
        self.lines = gpio.GPBDAT.all & (SDA | SCL)
        if self.lines == SDA | SCL:
            self.phase = IDLE

    def interrupt(self) -> None:
        """XINT3 and XINT4: a line moved, or several times."""
        before, lines = self.lines, self.gpio.GPBDAT.all & (SDA | SCL)
        self.lines = lines
        self.dsp.compute(self.costs.edge)
        if self.phase == IDLE and before == SDA | SCL and not lines:
            self.began()  # SCL fell before SDA's fall was read
        elif (before ^ lines) & SCL:
            if lines & SCL:
                self.rose(lines & SDA)
            else:
                self.fell()
        elif before != lines and lines & SCL:
            if lines & SDA:
                self.ended()
            else:
                self.began()
        self.pieack.all = GROUP_12

    # Conditions ----------------------------------------------------------------

    def began(self) -> None:
        """START, or repeated START."""
        self.phase, self.count, self.shift = ADDRESS, 0, 0

    def ended(self) -> None:
        """STOP, wherever in a byte."""
        self.phase = IDLE
        target, self.target = self.target, None
        if target is not None:
            target.over()

    # Clocks ----------------------------------------------------------------------

    def rose(self, sda: int) -> None:
        if self.phase == SEND:
            if self.count == 9:
                self.acked = not sda
        elif self.count < 8:
            self.shift = self.shift << 1 | bool(sda)
            self.count += 1

    def fell(self) -> None:
        phase, count = self.phase, self.count
        if phase == SEND:
            if count < 8:
                self.drive(self.bit())
            elif count == 8:
                self.drive(0)
                self.count = 9
                self.addressee.step()
            elif self.acked:
                self.send()
            else:
                self.phase = OTHERS
        elif phase in (ADDRESS, RECEIVE):
            if count == 8:
                self.acknowledge()
            elif count == 9 and self.reads:
                self.phase = SEND
                self.send()
            elif count == 9:
                self.phase, self.count, self.shift = RECEIVE, 0, 0
                self.drive(0)

    def acknowledge(self) -> None:
        """The eighth bit is over."""
        if self.phase == ADDRESS:
            target = self.targets.get(self.shift >> 1)
            if target is None:
                self.phase = OTHERS
                return
            self.target, self.reads = target, bool(self.shift & 1)
        self.drive(SDA | SCL)
        self.dsp.compute(self.costs.byte)
        if self.phase == ADDRESS:
            self.addressee.addressed(self.reads)
        else:
            self.addressee.received(self.shift)
        self.count = 9
        self.drive(SDA)

    def send(self) -> None:
        """The first bit of a byte, SCL being held until it is out."""
        self.drive(SCL)
        self.dsp.compute(self.costs.byte)
        self.shift, self.count = self.addressee.byte(), 0
        first = self.bit()
        self.drive(SCL | first)
        self.dsp.compute(self.costs.set_up)
        self.drive(first)

    def bit(self) -> int:
        """The next one, as what is to be driven low for it."""
        self.count += 1
        return 0 if self.shift >> 8 - self.count & 1 else SDA

    @property
    def addressee(self) -> Target:
        assert self.target is not None, "a phase with bytes begins with an address"
        return self.target

    def drive(self, low: int) -> None:
        """Pull these lines low, let go of the others. Protection is off until the routine returns."""
        self.dsp.eallow()
        self.gpio.GPBDIR.all = self._others | low
