"""The C28x CPU with its FPU: decoding, assembling and executing instructions.

`encodings.toml` describes the instruction set. All modules of this package use it; none depends on a chip or a bus.
"""
