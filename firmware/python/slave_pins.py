"""A software slave for any number of addresses. It uses the I2C module's two pins as GPIO, with edge interrupts.

    SDA GPIO32 --XINT3--> SDA changed while SCL is high --> START: the address follows; STOP: the transfer is over
    SCL GPIO33 --XINT4--> SCL rose --> a bit was received, or the master's ACK
                          SCL fell --> send a bit or an ACK; at the end of a byte, also hold SCL low

    Low is driven: DIR = 1 with the latch at 0. High is released: DIR = 0, with a pull-up.

An interrupt shows only that a line has changed, so the routine reads both levels. If both have changed, SDA was data,
or a START if both fell on an idle bus. No edge is lost if the routine reads the lines before they change again:
docs/any_order.md gives the SCL rate for this. SCL is held at the end of a byte, while the target prepares the next one.

Source: UM10204 sections 3.1.4 to 3.1.10, Table 10; SPRUFB0D sections 6 (GPIO) and 8.6 (XINT).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from periph_sim.firmware import Dsp

from .slave_module import Target

SDA, SCL = 1 << 0, 1 << 1  # GPIO32 and 33 in the registers of port B
BOTH_EDGES = 0xD  # value of XINTnCR for interrupts at both edges
GROUP_12 = 0x800  # mask of group 12 in PIEACK
IDLE, ADDRESS, RECEIVE, SEND, OTHERS = range(5)  # OTHERS: the transfer is for another slave


@dataclass
class PinCosts:
    """Cycles that parts of this program take, in addition to the cycles that the case gives in [unit.NAME.code].

    edge: time to choose how an edge is handled. byte: time to process or supply a byte, with SCL low.
    set_up: time from the change of SDA to the release of SCL; 38 cycles are 250 ns (tSU;DAT in UM10204 Table 10).
    """

    edge: int = 15
    byte: int = 60
    set_up: int = 38


class SlavePins:
    """The slave. targets: its targets by address. count: bits of the present byte so far; the ninth is its ACK."""

    def __init__(self, dsp: Dsp, targets: Mapping[int, Target], costs: PinCosts) -> None:
        self.dsp = dsp
        self.targets = targets
        self.costs = costs
        self.gpio = dsp.module("GPIO")
        self.pieack = dsp.module("PIE").PIEACK
        self.lines = 0
        self.phase = OTHERS
        self.count = 0
        self.shift = 0  # the byte being received or sent
        self.reads = False
        self.acked = False  # True if the master has acknowledged the last byte
        self.target: Target | None = None
        self._others = 0  # the bits of GPBDIR of all other pins

    def start(self) -> None:
        """Set up pins and interrupts. A transfer that is already in progress is ignored."""
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
        """Serve XINT3 and XINT4: a line has changed, perhaps several times."""
        before, lines = self.lines, self.gpio.GPBDAT.all & (SDA | SCL)
        self.lines = lines
        self.dsp.compute(self.costs.edge)
        if self.phase == IDLE and before == SDA | SCL and not lines:
            self.began()  # a START: SDA has fallen, and then SCL
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
        """Handle a START or repeated START."""
        self.phase, self.count, self.shift = ADDRESS, 0, 0

    def ended(self) -> None:
        """Handle a STOP, which may also come within a byte."""
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
        """Handle the fall of SCL after the eighth bit: acknowledge the byte, but not the address of another slave."""
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
        """Begin a byte: hold SCL until the target has supplied the byte and SDA shows its first bit."""
        self.drive(SCL)
        self.dsp.compute(self.costs.byte)
        self.shift, self.count = self.addressee.byte(), 0
        first = self.bit()
        self.drive(SCL | first)
        self.dsp.compute(self.costs.set_up)
        self.drive(first)

    def bit(self) -> int:
        """Advance to the next bit, and return the mask of the lines to drive low for it."""
        self.count += 1
        return 0 if self.shift >> 8 - self.count & 1 else SDA

    @property
    def addressee(self) -> Target:
        assert self.target is not None, "a phase with bytes begins with an address"
        return self.target

    def drive(self, low: int) -> None:
        """Pull the lines in mask `low` low and release the others. EALLOW stays set until the routine returns."""
        self.dsp.eallow()
        self.gpio.GPBDIR.all = self._others | low
