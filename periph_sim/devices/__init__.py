"""Devices that are connected to the F28335s: I2C targets, sensor chips, the sensor head, the host PC, wire watchers.

Terms of this package:
chip: a model of a sensor with registers, independent of the bus (`chips`).
target: a device with an address on an I2C bus (`targets`); `register_pointer` makes a target of a chip.
sensor head: an I2C master that reads the sensors once in each period; the reads of one period are a round.
reply: the object that the method `answer` of a target returns if the target acknowledges its address. It handles the
    data bytes of the transfer.
host: the PC, which sends frames over a UART; a frame contains several 16-bit values, such as angles and accelerations.
motion: the movement of the sensors as a function of time, from which the values of frames are computed.
case: the TOML file that describes what is simulated; [device.NAME], [chip.NAME] and [host] are tables in it.
tick: the time unit of the simulation; a second has a whole number of ticks.
"""
