"""Models of the TMS320F28335's modules: chips in the sense of `core.chip`, one folder for each kind of module.

Terms of this package:
unit: one simulated F28335 with its program. scene: the units, devices and wires that are simulated together.
case: the TOML file that describes a scene.
chip: here, the model of one module, such as an SCI: a subclass of `core.chip.Chip`.
line side, CPU side: the parts of a chip that handle the module's pins, and the CPU's accesses to its registers.
owner: the code that calls a chip: its socket (`core.socket`), the unit, or a test. The owner of a part of a chip, such
    as a FIFO or a noise filter, is the chip.
wake-up: a call of the chip's method `wake`. The owner makes it at the cycle that the chip has put in `next_wake`.
note: a message for the user (`core.chip.Note`). Its code is "duty" if firmware does what the manual forbids.
request: one pulse on an interrupt line. "X requests at once" means that the interrupt is requested in this cycle.
option: a question that TI's documents leave open, with its possible answers (`core.options`). Under "Chosen", the
    docstrings list other behaviour that these documents leave open. It has no option: only one answer is modelled.
use of an option: a step of the run that depends on the answer. `assume` returns the answer and adds the name of the
    option to the set `touched`, which records the use; `unrecorded` only returns the answer.
XRS: the reset of the whole F28335, by its pin of this name or by the watchdog.
standard mode: the mode of an SCI or SPI without FIFOs (SCIFFENA = 0, SPIFFENA = 0).
SYSCLKOUT: the clock of the CPU. LSPCLK: the clock of SCI and SPI, SYSCLKOUT divided. OSCCLK: the clock of the crystal.
EALLOW: the instruction after which writes to protected registers take effect, until EDIS or a service routine begins.
mask: an integer in which each bit represents one thing, such as a pin or a line; bit i is thing i.
`# core:` begins a comment for the build of the compiled core, which translates modules to C.
Times are cycles of SYSCLKOUT unless a docstring says otherwise.
"""
