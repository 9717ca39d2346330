"""Captures: file formats, decoders, compliance checks, comparison and drawing.

The decoders share no code with the chip models and the agents, because tests check those with the decoders.

Terms of this package:

position: a time in a capture, as a whole number of samples or of ticks of the file's time stamps.
span: a range of positions. In a known span, the levels of all lines in question are known.
condition: a START, repeated START or STOP on an I2C bus.
phase: the part of an I2C transfer from a START or repeated START to the next condition.
glitch: a pulse that is so short that receivers may ignore it.
salvage: to read a damaged file up to the damage instead of raising an error.
"""
