"""The C28x CPU with its FPU: decoding, assembling and executing instructions.

`encodings.toml` is the instruction set as data; everything here derives from it. It knows no chip, bus or file.
"""
