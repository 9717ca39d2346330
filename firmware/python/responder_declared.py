"""The polled responder with wait conditions that are declared by `when` and so not evaluated in Python.

    address, replies, busy  -->  polled, without FIFO  -->  the bus

Its records equal those of responder.py, so the difference in run time shows how much time declared conditions save.
"""

from __future__ import annotations

from periph_sim.processor.dsp import Dsp

from .responder import REPLAY, Responder, Settings, Waits

__all__ = ["REPLAY", "Settings", "main"]


class DeclaredResponder(Responder):
    def conditions(self) -> Waits:
        status = self.i2c.I2CSTR
        return Waits(
            addressed=status.when(AAS=1),
            over=status.when(AAS=0),
            wants_byte=status.when(XRDY=1),
            has_byte=status.when(RRDY=1),
        )


def main(dsp: Dsp, settings: Settings) -> None:
    if settings.style != "polled" or settings.fifo:
        raise ValueError("responder_declared is polled and has no FIFO; use responder for the other styles")
    DeclaredResponder(dsp, settings).run()
