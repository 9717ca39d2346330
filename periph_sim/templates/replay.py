"""An I2C slave for `periph-sim replay`: each read is answered with the next of `replies`.

The replay fills in `address` and `replies` from the capture where the case leaves them open; put your own device here.
A fuller one, with FIFO, interrupts and refusals: from .responder import Settings, main
"""

from dataclasses import dataclass
from itertools import chain, cycle, repeat

from periph_sim.firmware import HexBytes, start_i2c

SCD = 0x0020  # of I2CSTR; written alone, since a write of the field would clear the other flags along with it
REPLAY = ("address", "replies")  # settings that a replay fills in from the capture


@dataclass
class Settings:
    address: int = 0x48
    replies: tuple[HexBytes, ...] = (b"\x19\x80",)


def main(dsp, settings):
    start_i2c(dsp, own_address=settings.address)
    i2c = dsp.module("I2C-A")
    i2c.I2CMDR.IRS = 1
    replies = cycle(settings.replies)
    while True:
        if dsp.spin_either(lambda: i2c.I2CSTR.RRDY == 1, lambda: i2c.I2CSTR.SDIR == 1):
            answer(dsp, i2c, next(replies))
        else:
            _ = i2c.I2CDRR.all  # a byte that the controller writes


def answer(dsp, i2c, data):
    i2c.I2CSTR.all = SCD  # any earlier STOP has set it
    for byte in chain(data, repeat(0xFF)):
        # dsp.compute(30_000)  # without the "#" in front, each byte comes 200 us later and "stretch" breaks
        i2c.I2CDXR.all = byte
        if dsp.spin_either(lambda: i2c.I2CSTR.XRDY == 1, lambda: i2c.I2CSTR.SCD == 1):
            return
