"""Execution of C28x instructions: effects on registers and memory, and cycles from the manual's table.

`registers.Cpu` has the registers and operand access; `accumulator`, `half_words`, `multiply`, `shifts`,
`moves`, `stack`, `branches`, `control` and `fpu` have one short function per form, named as in `encodings.toml`.
"""
