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
    """Numbers of cycles that compiled code takes in addition to register accesses and computations.

    The defaults were counted in compiled images.
    """

    between_accesses: CodeCycles = COMPILED.between_accesses
    poll_pass: PassCycles = COMPILED.poll_pass
    isr_prologue: CodeCycles = COMPILED.isr_prologue
    isr_epilogue: CodeCycles = COMPILED.isr_epilogue


class StubTable(Table, frozen=True, kw_only=True):
    """The value that a register without a model returns from the time `after` on. register: the name or the address."""

    register_: str | int = field(name="register")
    value: Annotated[int, Meta(ge=0, le=0xFFFF)]
    after: Duration = Fraction(0)


class Compile(Table, frozen=True, kw_only=True):
    """Settings for compiling C sources.

    include: folders of headers.
    defines: a dictionary from the name of a macro to its value.
    undefined: True to compile with the undefined behaviour sanitizer (UBSan).
    """

    include: tuple[str, ...] = ()
    defines: dict[str, str | int] = {}
    undefined: bool = False


class Unit(Table, frozen=True, kw_only=True):
    """An F28335 with its program: one of `firmware`, `image` and `sources`.

    firmware: a Python program.
    image: a linker's .out file, or assembly (.asm).
    sources: C sources, which are compiled for the computer that runs periph_sim.
    boot: where the execution of an image begins.
    memory: a dictionary from the name of an image's variable to its initial value.
    part: the name of the device in the F2833x family: F28335 or F28334.
    pins: a dictionary from the name of a wire to the GPIO number of its pin. SDA, SCL, RX and TX need no entry.
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
    # `options` maps a group to the answers to its open questions; `periph-sim regs --options` lists all groups.
    options: dict[str, dict[str, Answer]] = {}

    def check_together(self, given: Set[str]) -> None:
        programs = [name for name in ("firmware", "image", "sources") if getattr(self, name)]
        if not programs:
            raise ValueError("a unit needs a program; give firmware, or image")
        if len(programs) > 1:
            raise ValueError(f"a unit has one program; give {' or '.join(programs)}, not both")
        if self.sources and "settings" in given:
            raise ValueError(
                "settings is of Python firmware; sources take [unit.NAME.compile] defines, so leave it out"
            )
        if self.memory and not self.image:
            raise ValueError("memory is of an image's variables; settings are what Python firmware takes")
        said = sorted({"settings", "code", "pll", "from_boot"} & given)
        if self.image and said:
            raise ValueError(f"{said[0]} is of Python firmware; an image says that by itself, so leave it out")
        said = sorted({"boot", "stub"} & given)
        if self.firmware and said:
            raise ValueError(f"{said[0]} is of an image; Python firmware begins at main, so leave it out")
