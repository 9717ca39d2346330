"""An I2C slave for `periph-sim replay`, which answers each read with the next of `replies`. Replace it by your device.

If the case does not set `address` and `replies`, the replay takes them from the capture. For a more complete slave,
with FIFO, interrupts and refusals, use: from .responder import Settings, main
"""

from dataclasses import dataclass
from itertools import chain, cycle, repeat

from periph_sim.firmware import HexBytes, start_i2c

SCD = 0x0020  # mask of SCD; I2CSTR.all = SCD clears only SCD, but I2CSTR.SCD = 1 would clear other flags, too
REPLAY = ("address", "replies")  # settings that a replay sets from the capture


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
            _ = i2c.I2CDRR.all  # a byte written by the controller


def answer(dsp, i2c, data):
    i2c.I2CSTR.all = SCD  # clears SCD, which an earlier STOP has set
    for byte in chain(data, repeat(0xFF)):
        # dsp.compute(30_000)  # remove the first "#": each byte comes 200 us later, so budget "stretch" breaks
        i2c.I2CDXR.all = byte
        if dsp.spin_either(lambda: i2c.I2CSTR.XRDY == 1, lambda: i2c.I2CSTR.SCD == 1):
            return
