"""`periph-sim regs`: the register maps as tables, with their sources; and the options that answer open questions."""

from __future__ import annotations

import dataclasses
from textwrap import wrap

import click

from ...core.options import Answers, allowed
from ...core.registers import Register, RegisterMap
from ...core.suggest import did_you_mean
from ...devices.chips import chip_models
from ...f28335.parts.f28335 import PART
from .tables import WIDTH, PlainTable, Screen, say, terminal

OPTIONS: dict[str, type[Answers]] = {
    **PART.options_classes(),
    **{model: chip.OPTIONS for model, chip in chip_models().items()},
}


MAPS: dict[str, tuple[int, RegisterMap]] = {module.name: (module.base, module.registers) for module in PART.modules}

SECTION = "understand"
EXAMPLE = "periph-sim regs I2C-A.I2CSTR"


@click.command()
@click.argument("name", required=False)
@click.option("--options", "want_options", is_flag=True, help="List the open questions and their answers instead.")
def regs(name: str | None, want_options: bool) -> None:
    """Show the registers of MODULE, one register as MODULE.REGISTER, or all modules."""
    console = terminal()
    if want_options:
        show_options(console, name)
    elif name is None:
        show_modules(console)
    else:
        module, _, register = name.partition(".")
        if module not in MAPS:
            raise click.ClickException(f"there is no module {module!r}; {did_you_mean(module, MAPS)}")
        base, registers = MAPS[module]
        if not register:
            show_map(console, module, base, registers)
        elif register in registers:
            show_register(console, module, base, registers[register])
        else:
            hint = did_you_mean(register, (r.name for r in registers))
            raise click.ClickException(f"{module} has no register {register!r}; {hint}")


def show_modules(console: Screen) -> None:
    table = PlainTable(("module", "base", "registers", "source"))
    for module, (base, registers) in MAPS.items():
        table.add_row(module, f"{base:#06x}", str(len(registers.registers)), registers.source)
    console.print(table)


def show_map(console: Screen, module: str, base: int, registers: RegisterMap) -> None:
    say(console, module, "bold")
    table = PlainTable(("address", "register", "reset", "source"))
    for register in registers:
        table.add_row(f"{base + register.offset:#06x}", register.name, reset_of(register), register.source)
    console.print(table)


def show_register(console: Screen, module: str, base: int, register: Register) -> None:
    title = f"{module}.{register.name}  {base + register.offset:#06x}  reset {reset_of(register)}  [{register.source}]"
    say(console, title)
    if register.protected:
        say(console, "writes need EALLOW")
    table = PlainTable(("bits", "field", "access", "reset", "what it is"))
    for f in register.fields:
        table.add_row(f.bits, f.name, f.access, f"{f.reset:#x}" if f.reset > 9 else str(f.reset), f.doc)
    console.print(table)


def reset_of(register: Register) -> str:
    return f"{register.reset:#0{2 + register.width // 4}x}"


def show_options(console: Screen, name: str | None) -> None:
    """Show each option with its values, the default first, and its question below."""
    if name is not None and name not in OPTIONS:
        raise click.ClickException(f"there are no options for {name!r}; {did_you_mean(name, OPTIONS)}")
    for group, kind in OPTIONS.items():
        if name in (None, group):
            for f in dataclasses.fields(kind):  # type: ignore[arg-type]
                values = allowed(f)
                if "values" not in f.metadata:
                    values = f"{f.default} ({values})"
                title = f"{group}.{f.name}: {values}"
                for line in wrap(title, WIDTH, subsequent_indent="    ", break_on_hyphens=False):
                    say(console, line)
                for line in wrap(str(f.metadata["question"]), WIDTH, initial_indent="  ", subsequent_indent="  "):
                    say(console, line)
