"""Firmware of a thermometer: two bytes for each read, over I2C."""

from periph_sim.firmware import start_i2c


def main(dsp, settings):
    i2c = start_i2c(dsp, 0x48) or dsp.module("I2C-A")
    i2c.I2CMDR.IRS = 1
    values = iter([0x12, 0x34] * 100)
    while True:
        dsp.spin(lambda: i2c.I2CSTR.SDIR == 1)
        i2c.I2CSTR.all = 0x4000
        i2c.I2CDXR.all = next(values)
        dsp.spin(lambda: i2c.I2CSTR.XRDY == 1 or i2c.I2CSTR.SCD == 1)
        if i2c.I2CSTR.SCD == 0:
            i2c.I2CDXR.all = next(values)
            dsp.spin(lambda: i2c.I2CSTR.SCD == 1)
        i2c.I2CSTR.all = 0x0020
