"""What C28x instructions do: registers and memory before go in; after, with the cycles of the manual's table, come out.

`registers.Cpu` has the registers and how operands are found; `accumulator`, `half_words`, `multiply`, `shifts`,
`moves`, `stack`, `branches`, `control` and `fpu` have one short function a form, named as in `encodings.toml`.
"""
