"""Devices that are connected to the F28335s: I2C targets, sensor chips, the sensor head, the host PC, wire watchers.

Terms of this package:
chip: a model of a sensor with registers, independent of the bus (`chips`).
target: a device with an address on an I2C bus (`targets`); `register_pointer` makes a target of a chip.
sensor head: an I2C master that reads the sensors once in each period; the reads of one period are a round.
host: the PC, which sends frames over a UART; a frame contains several 16-bit values, such as angles and accelerations.
"""
