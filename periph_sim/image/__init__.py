"""Firmware as it is flashed: a linker's output file goes in; sections, symbols, lines and what its code does come out.

`load.load` reads a file of either format; `inspection.inspect` says what is in it.
"""
