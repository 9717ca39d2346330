"""The polled responder with its waits declared: equal records, and no pass of a wait is made by Python.

    address, replies, busy  -->  polled, without FIFO  -->  the bus

Beside responder.py it shows what a condition that is declared once saves: cycles, events and bytes are the same.
"""

from __future__ import annotations

from periph_sim.processor.dsp import Dsp

from .responder import Responder, Settings

__all__ = ["Settings", "main"]


class DeclaredResponder(Responder):
    """Its conditions: addressed, not addressed any more, the next byte wanted, a byte received."""

    def __init__(self, dsp: Dsp, settings: Settings) -> None:
        super().__init__(dsp, settings)
        status = self.i2c.I2CSTR
        self.is_addressed, self.is_over = status.when(AAS=1), status.when(AAS=0)
        self.wants_byte, self.has_byte = status.when(XRDY=1), status.when(RRDY=1)

    def poll(self) -> None:
        while True:
            self.dsp.spin(self.is_addressed)
            if self.i2c.I2CSTR.SDIR == 1:
                self.send()
            else:
                self.receive()

    def send(self) -> None:
        i2c, dsp = self.i2c, self.dsp
        data = self.next_reply()
        while True:
            i2c.I2CDXR.all = next(data)
            if dsp.spin_either(self.wants_byte, self.is_over):
                return

    def receive(self) -> None:
        i2c, dsp = self.i2c, self.dsp
        taken = bytearray()
        self.received.append(taken)
        while not dsp.spin_either(self.has_byte, self.is_over):
            taken.append(i2c.I2CDRR.all)
        if i2c.I2CSTR.BB == 0:  # a STOP, not a repeated START, ended the write
            self.be_busy()


def main(dsp: Dsp, settings: Settings) -> None:
    if settings.style != "polled" or settings.fifo:
        raise ValueError("responder_declared is polled and has no FIFO; take responder for the other styles")
    DeclaredResponder(dsp, settings).run()
