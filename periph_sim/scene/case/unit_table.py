"""The table of a unit: one F28335, its program, the costs of its code, and its crystal."""

from __future__ import annotations

from collections.abc import Set
from fractions import Fraction
from typing import Annotated, Literal

from msgspec import Meta, field

from ...core.table import Duration, Table
from ...f28335.cpu.code_costs import CodeCosts
from .scalars import Answer, CodeCycles, Crystal, PassCycles, Ppm, VariableValues

COMPILED = CodeCosts()


class Code(Table, frozen=True, kw_only=True):
    """Cycles of code between the register accesses of Python firmware and C sources. The defaults were counted in
    compiled programs.

    between_accesses: cycles before each register access outside wait conditions; compiled programs had 1 to 15
    poll_pass: cycles of each pass of a wait that reads one register of peripheral frame 2 (SCI, I2C); compiled
        programs had 7 to 21; `dsp.spin(..., pass_cycles=21)` sets them for one wait
    isr_prologue: cycles that save registers, besides the 14 words that the CPU saves; compiled programs had 6 to 22
    isr_epilogue: cycles that restore registers before IRET; compiled programs had 3 to 18
    """

    between_accesses: CodeCycles = COMPILED.between_accesses
    poll_pass: PassCycles = COMPILED.poll_pass
    isr_prologue: CodeCycles = COMPILED.isr_prologue
    isr_epilogue: CodeCycles = COMPILED.isr_epilogue


class StubTable(Table, frozen=True, kw_only=True):
    """The value that an image reads from a register that is not modelled.

    register: address, or name as `periph-sim image` shows it, such as `ADC.ADCST` or `eCAN-A + 0x08`
    value: value read, whatever was written
    after: valid from this time; a register may have several entries
    """

    register_: str | int = field(name="register")
    value: Annotated[int, Meta(ge=0, le=0xFFFF)]
    after: Duration = Fraction(0)


class Compile(Table, frozen=True, kw_only=True):
    """Settings of the PC's gcc for C sources.

    include: header folders
    defines: macros, `{ CPU_FRQ_150MHZ = 1 }`
    undefined: UBSan reports undefined behaviour on standard error
    """

    include: tuple[str, ...] = ()
    defines: dict[str, str | int] = {}
    undefined: bool = False


class Unit(Table, frozen=True, kw_only=True):
    """One F28335 with its program: exactly one of `firmware`, `image` and `sources`.

    firmware: shipped program (file of `firmware/python` without suffix) or `.py` file; `from .NAME import ...`
        imports files beside it and shipped programs
    image: `.out` file of TI's linker, or assembly (`.asm`); see images.md. Excludes `settings`, `code`, `pll` and
        `from_boot`
    sources: C files, compiled for the PC
    compile: compiler settings, `[unit.NAME.compile]`
    boot: start of an image: `entry`, `flash`, `ram`
    stub: values of unmodelled registers, `[[unit.NAME.stub]]`
    memory: initial values of an image's variables: `{ _gain = 3, "table[2]" = 1 }`
    settings: values of the firmware's `Settings`
    part: `F28335`, or `F28334` with half the flash
    modules: modules that are simulated, any of SCI-A, SCI-B, SCI-C, I2C-A, SPI-A, GPIO, XINT, TIMER0, TIMER1, TIMER2
    oscclk: crystal or XCLKIN, 4 to 150 MHz
    pll: PLLCR.DIV; SYSCLKOUT is oscclk * pll / 2
    ppm: crystal error, parts per million
    from_boot: `true`: main starts with reset clocks and a running watchdog; `false`: after TI's start-up code
    skip_polls: `false`: each pass of a wait is executed, which is slower and gives equal results
    pins: wire names of GPIO pins: `{ MODEL = 34 }`
    code: cycles between the accesses of Python firmware or C sources, `[unit.NAME.code]`
    options: choices for undocumented behaviour, `[unit.NAME.options.i2c]`, `.sci`, `.spi`, `.system`; see
        options.md
    """

    firmware: str = ""
    image: str = ""
    sources: tuple[str, ...] = ()
    compile: Compile = Compile()
    boot: Literal["entry", "flash", "ram"] = "entry"
    stub: tuple[StubTable, ...] = ()
    memory: VariableValues = {}
    settings: dict[str, object] = {}
    part: str = "F28335"
    modules: tuple[str, ...]
    oscclk: Crystal = Fraction(30_000_000)
    pll: Annotated[int, Meta(ge=1, le=10)] = 10
    ppm: Ppm = Fraction(0)
    from_boot: bool = False
    skip_polls: bool = True
    pins: dict[str, Annotated[int, Meta(ge=0, le=87)]] = {}
    code: Code = Code()
    # `options` maps a group of open questions to their answers; `periph-sim regs --options` lists all groups.
    options: dict[str, dict[str, Answer]] = {}

    def check_together(self, given: Set[str]) -> None:
        programs = [name for name in ("firmware", "image", "sources") if getattr(self, name)]
        if not programs:
            raise ValueError("a unit needs a program; give firmware, or image")
        if len(programs) > 1:
            raise ValueError(f"a unit has one program; give {' or '.join(programs)}, not both")
        if self.sources and "settings" in given:
            raise ValueError(
                "only Python firmware has settings; sources take [unit.NAME.compile] defines, so leave it out"
            )
        if self.memory and not self.image:
            raise ValueError("memory is of an image's variables; settings are what Python firmware takes")
        said = sorted({"settings", "code", "pll", "from_boot"} & given)
        if self.image and said:
            raise ValueError(f"{said[0]} is of Python firmware; an image says that by itself, so leave it out")
        said = sorted({"boot", "stub"} & given)
        if self.firmware and said:
            raise ValueError(f"{said[0]} is of an image; Python firmware begins at main, so leave it out")
