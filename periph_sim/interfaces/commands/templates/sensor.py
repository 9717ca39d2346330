"""Emulates a temperature sensor on the bus, at address 0x48: a new sample every 5 ms, two bytes in each answer."""

from fractions import Fraction

from periph_sim.firmware import start_i2c, start_pie

PERIOD = Fraction(5, 1000)
COST = Fraction(40, 10**6)  # run time of the model in seconds, measured on the chip or estimated
SCD = 0x0020  # mask of SCD; I2CSTR.all = SCD clears only SCD, but I2CSTR.SCD = 1 would clear other flags, too


def main(dsp, settings):
    sample = [0x19, 0x00]

    def tick():
        with dsp.span("model"):
            dsp.compute(COST)
            sample[1] = (sample[1] + 1) & 0xFF  # changes the sample; replace this line by your model
        dsp.module("PIE").PIEACK.all = 1

    start_i2c(dsp, own_address=0x48)
    i2c = dsp.module("I2C-A")
    i2c.I2CMDR.IRS = 1
    timer = dsp.module("TIMER0")
    timer.PRD.all = int(PERIOD * dsp.control.sysclk_hz) - 1
    timer.TCR.all = 0x4020  # sets TIE and TRB
    start_pie(dsp, {"TINT0": tick})
    while True:
        dsp.spin(lambda: i2c.I2CSTR.SDIR == 1)
        with dsp.span("answer"):
            i2c.I2CSTR.all = SCD  # clears SCD, which an earlier STOP has set
            # dsp.compute(15_000)  # remove the first "#": each answer comes 100 us later, so budget "response" breaks
            whole = tuple(sample)  # both bytes of the same sample, even if a new one comes meanwhile
            for byte in whole:
                i2c.I2CDXR.all = byte
                dsp.spin(lambda: i2c.I2CSTR.XRDY == 1 or i2c.I2CSTR.SCD == 1)
            dsp.spin(lambda: i2c.I2CSTR.SCD == 1)
