"""Models of the TMS320F28335's modules: chips in the sense of `core.chip`, one folder for each kind of module.

Terms of this package:
owner: the code that calls a chip, which is its socket (`core.socket`) or a test.
request: one pulse on an interrupt line. "X requests at once" means that the interrupt is requested in this cycle.
option: a question that TI's documents leave open, with its possible answers (`core.options`). The docstrings of the
    modules list further behaviour that these documents leave open under "Chosen"; it has no option.
Times are cycles of SYSCLKOUT unless a docstring says otherwise.
"""
