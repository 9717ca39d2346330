"""An I2C slave at address 0x48 with four registers.

A controller writes the number of a register. Then it writes values, or reads them, from this register on.
"""

from periph_sim.firmware import start_i2c

SCD = 0x0020  # mask of SCD; I2CSTR.all = SCD clears only SCD, but I2CSTR.SCD = 1 would clear other flags, too


def main(dsp, settings):
    registers = [0x11, 0x22, 0x33, 0x44]
    start_i2c(dsp, own_address=0x48)
    i2c = dsp.module("I2C-A")
    i2c.I2CMDR.IRS = 1
    pointer = 0
    while True:
        if dsp.spin_either(lambda: i2c.I2CSTR.RRDY == 1, lambda: i2c.I2CSTR.SDIR == 1):
            pointer = answer(dsp, i2c, registers, pointer)
        else:
            pointer = receive(dsp, i2c, registers)


def receive(dsp, i2c, registers):
    """Receive the number of a register, then values until STOP or repeated START. Return the pointer after them."""
    i2c.I2CSTR.all = SCD  # clears SCD, which an earlier STOP has set
    pointer = i2c.I2CDRR.all
    while True:
        dsp.spin(lambda: i2c.I2CSTR.RRDY == 1 or i2c.I2CSTR.SCD == 1 or i2c.I2CSTR.SDIR == 1)
        if i2c.I2CSTR.RRDY == 0:
            return pointer
        registers[pointer % len(registers)] = i2c.I2CDRR.all
        pointer += 1


def answer(dsp, i2c, registers, pointer):
    """Send registers until the controller stops. Return the pointer after them."""
    i2c.I2CSTR.all = SCD
    # dsp.compute(3000)  # remove the first "#": a byte left in I2CDXR is sent first, so budget "wrong bytes" breaks
    while True:
        i2c.I2CDXR.all = registers[pointer % len(registers)]
        if dsp.spin_either(lambda: i2c.I2CSTR.XRDY == 1, lambda: i2c.I2CSTR.SCD == 1):
            return pointer  # the last byte written to I2CDXR was not sent, so the number of its register is returned
        pointer += 1
