"""An I2C master that stores four bytes in an EEPROM (24LC64 at 0x50) and reads them back."""

from periph_sim.firmware import start_i2c

EEPROM = 0x50
PLACE = [0x00, 0x20]  # address in the memory, high byte first
DATA = [0xCA, 0xFE, 0x12, 0x34]
READ_START = 0x6C20  # I2CMDR: FREE, STT, STP, MST, IRS
WRITE_START = 0x6620  # FREE, STT, MST, TRX, IRS
WRITE_STOP = 0x6E20  # FREE, STT, STP, MST, TRX, IRS


def main(dsp, settings):
    start_i2c(dsp)
    i2c = dsp.module("I2C-A")
    i2c.I2CCLKL.all = 45  # 100 kHz, from the module clock of 10 MHz that start_i2c sets
    i2c.I2CCLKH.all = 45
    i2c.I2CMDR.IRS = 1
    with dsp.span("store"):
        write(dsp, i2c, [*PLACE, *DATA], WRITE_STOP)
        while not write(dsp, i2c, PLACE, WRITE_START):  # a 24LC64 acknowledges nothing while it stores
            pass
    # dsp.compute(600_000)  # remove the first "#": the bytes are read 4 ms later, so budget "stored and read" breaks
    got = read(dsp, i2c, len(DATA))
    if got == DATA:
        with dsp.span("right data"):
            pass


def write(dsp, i2c, data, start):
    """Send bytes. Return False if they were not acknowledged; the bus is then free."""
    dsp.spin(lambda: i2c.I2CMDR.STP == 0 and i2c.I2CSTR.BB == 0)
    i2c.I2CSTR.all = 0x0026  # clears SCD, ARDY and NACK
    i2c.I2CSAR.all = EEPROM
    i2c.I2CCNT.all = len(data)
    i2c.I2CMDR.all = start
    for byte in data:
        if dsp.spin_either(lambda: i2c.I2CSTR.XRDY == 1, lambda: i2c.I2CSTR.NACK == 1):
            break
        i2c.I2CDXR.all = byte
    dsp.spin(lambda: i2c.I2CSTR.ARDY == 1 or i2c.I2CSTR.SCD == 1 or i2c.I2CSTR.NACK == 1)
    if i2c.I2CSTR.NACK == 1:
        i2c.I2CMDR.STP = 1
        dsp.spin(lambda: i2c.I2CSTR.BB == 0)
        i2c.I2CMDR.IRS = 0  # drops the byte in I2CDXR, which would begin the next transfer
        i2c.I2CMDR.IRS = 1
        return False
    return True


def read(dsp, i2c, count):
    """Read bytes from the address written last, after a repeated START."""
    i2c.I2CCNT.all = count
    i2c.I2CMDR.all = READ_START
    got = []
    for _ in range(count):
        dsp.spin(lambda: i2c.I2CSTR.RRDY == 1)
        got.append(i2c.I2CDRR.all)
    dsp.spin(lambda: i2c.I2CSTR.SCD == 1)
    return got
