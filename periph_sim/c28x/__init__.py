"""The C28x CPU with its FPU: words of program memory go in; instructions, their text and their effects come out.

`encodings.toml` is the instruction set as data; everything here derives from it. No chip, no bus and no file format.
"""
