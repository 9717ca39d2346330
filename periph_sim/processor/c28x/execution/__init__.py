"""Execution of C28x instructions: effects on registers and memory, and cycles from the manual's table.

`registers.Registers` has the registers, `cpu.Cpu` the access to operands, `engine.Engine` the order of instructions.
`accumulator`, `half_words`, `multiply`, `shifts`, `moves`, `stack`, `branches`, `control`, `fpu` and `fpu_moves` have
short functions that execute the forms. A form is one encoding of an instruction, a row of `encodings.toml`. It is
executed by the function of the same name, or by the one that `operations.EXECUTED_BY` names.
"""
