"""Firmware images: the sections, symbols, source lines and code in the output file of a linker.

`load.load` reads a file in the format TI COFF or ELF; `inspection.inspect` summarises the image.

Terms of this package:

load address: the address at which a loader stores the contents of a section.
run address: the address at which the program uses a section. If it is not the load address, start-up code copies the
    section.
piece: in `assemble`, the words that an instruction or one operand of a directive adds to a section.
part: a member of the F2833x family; in `variables`, a member or an element of a variable.
"""
