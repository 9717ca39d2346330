"""Captures: file formats, decoders, compliance checks, comparison and drawing.

The tests use the decoders to check the models of chips and of the devices on their buses. Therefore the decoders share
no code with these models.

Terms of this package:

position: a time in a capture, as a whole number of samples or of ticks.
tick: the unit of time stamps, if a file states times instead of samples.
channel, line: a channel is the recording of a line (a wire).
rise, fall: a rising or falling edge.
span: a range of positions. In a known span, the levels of all lines in question are known.
condition: a START, repeated START or STOP on an I2C bus.
phase: the part of an I2C transfer from a START or repeated START to the next condition.
low phase, high phase: the time between two successive edges of a line, during which the line is low or high.
glitch: a pulse that is so short that receivers may ignore it.
salvage: to read a damaged file up to the damage instead of raising an error.
"""
