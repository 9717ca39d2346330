"""Execution of C28x instructions: effects on registers and memory, and cycles from the manual's table.

`registers.Registers` has the registers, `cpu.Cpu` the access to operands, `engine.Engine` the order of instructions.
`accumulator`, `half_words`, `multiply`, `shifts`, `moves`, `stack`, `branches`, `control`, `fpu` and `fpu_moves` have
one short function for each form, which is one encoding of an instruction, a row of `encodings.toml`. The function and
the row have the same name. `operations.EXECUTED_BY` lists the forms that are executed by a function of another name.
"""
