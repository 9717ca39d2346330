"""An EEPROM of 256 bytes in pages of 8, like a 24C02, at address 0x50.

A write begins with the address in the memory. Its bytes stay in one page: after the last byte of the page, the first
one follows. They are stored at the STOP, and the memory does not acknowledge its address while it stores them.
"""

from fractions import Fraction

from periph_sim.firmware import start_i2c

PAGE = 8
WRITE_TIME = Fraction(5, 1000)  # the maximum of the data sheet
SCD = 0x0020  # mask of SCD; I2CSTR.all = SCD clears only SCD, but I2CSTR.SCD = 1 would clear other flags, too


def main(dsp, settings):
    memory = [0xFF] * 256
    start_i2c(dsp, own_address=0x50)
    i2c = dsp.module("I2C-A")
    i2c.I2CMDR.IRS = 1
    place = 0
    while True:
        if dsp.spin_either(lambda: i2c.I2CSTR.RRDY == 1, lambda: i2c.I2CSTR.SDIR == 1):
            place = answer(dsp, i2c, memory, place)
        else:
            place = receive(dsp, i2c, memory)


def receive(dsp, i2c, memory):
    """Receive an address and bytes, and store the bytes at a STOP. Return the address after them."""
    i2c.I2CSTR.all = SCD  # clears SCD, which an earlier STOP has set
    place = i2c.I2CDRR.all
    page = []
    while True:
        dsp.spin(lambda: i2c.I2CSTR.RRDY == 1 or i2c.I2CSTR.SCD == 1 or i2c.I2CSTR.SDIR == 1)
        if i2c.I2CSTR.RRDY == 0:
            break
        page.append(i2c.I2CDRR.all)
    if page and i2c.I2CSTR.SDIR == 0:  # a write that ends in a repeated START is not stored
        for byte in page:
            memory[place] = byte
            place += 1
            if place % PAGE == 0:
                place -= PAGE
                # place += PAGE  # remove the first "#": bytes continue in the next page, so budget "wrong bytes" breaks
        with dsp.span("store"):
            i2c.I2CMDR.IRS = 0  # off the bus: the address is not acknowledged
            dsp.compute(WRITE_TIME)
            i2c.I2CMDR.IRS = 1
    return place


def answer(dsp, i2c, memory, place):
    """Send bytes until the controller stops. Return the address after them."""
    i2c.I2CSTR.all = SCD
    while True:
        i2c.I2CDXR.all = memory[place]
        if dsp.spin_either(lambda: i2c.I2CSTR.XRDY == 1, lambda: i2c.I2CSTR.SCD == 1):
            return place  # the last byte written to I2CDXR was not sent, so its address is returned
        place = (place + 1) % len(memory)
