"""The I2C module (SPRUG03B).

Terms of this package:
rise 8, fall 8: the edges of the SCL pulse of the last bit of a byte, even if I2CMDR.BC selects fewer than eight bits.
rise 9, fall 9: the edges of the SCL pulse of the acknowledge bit. Fall 9 ends the byte.
acknowledge slot: the time from fall 8 to fall 9.
module clock: SYSCLKOUT divided by I2CPSC + 1.
bit engines: the master and the slave, which process SCL and SDA bit by bit.
skipped bits: bits of a byte that are applied in one step, because nothing observes them (`bus.i2c.bit_skip`).
"""
