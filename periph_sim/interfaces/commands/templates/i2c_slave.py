"""An I2C slave at address 0x48: a controller writes the number of a register, then reads from there on."""

from periph_sim.firmware import start_i2c

REGISTERS = [0x11, 0x22, 0x33, 0x44]
SCD = 0x0020  # of I2CSTR; written as a word: a write of the field would also clear the other flags


def main(dsp, settings):
    start_i2c(dsp, own_address=0x48)
    i2c = dsp.module("I2C-A")
    i2c.I2CMDR.IRS = 1
    pointer = 0
    while True:
        if dsp.spin_either(lambda: i2c.I2CSTR.RRDY == 1, lambda: i2c.I2CSTR.SDIR == 1):
            pointer = answer(dsp, i2c, pointer)
        else:
            pointer = i2c.I2CDRR.all


def answer(dsp, i2c, pointer):
    """Send registers until the controller stops; return the pointer after them."""
    i2c.I2CSTR.all = SCD  # set by any earlier STOP
    # dsp.compute(3000)  # remove the "#": a byte of the last answer is sent first and "wrong bytes" breaks
    while True:
        i2c.I2CDXR.all = REGISTERS[pointer % len(REGISTERS)]
        pointer += 1
        if dsp.spin_either(lambda: i2c.I2CSTR.XRDY == 1, lambda: i2c.I2CSTR.SCD == 1):
            return pointer
