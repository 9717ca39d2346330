"""Firmware images: sections, symbols, source lines and code of a linker's output file.

`load.load` reads a file of either format; `inspection.inspect` summarises its contents.
"""
