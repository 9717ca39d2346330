"""Firmware images: the sections, symbols, source lines and code in the output file of a linker.

`load.load` reads a file in TI COFF or ELF; `inspection.inspect` summarises its contents.
"""
