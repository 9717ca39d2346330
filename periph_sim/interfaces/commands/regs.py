"""`periph-sim regs`: tables of the register maps with their sources, and of the options for open questions."""

from __future__ import annotations

import dataclasses
from textwrap import wrap

import click

from ...core.options import Answers, allowed
from ...core.phrases import did_you_mean, nearest
from ...core.registers import Register, RegisterMap
from ...core.text_table import WIDTH
from ...devices.chips import chip_models
from ...f28335.parts.f28335 import PART
from ...records.record_text import number
from .command_frame import command, print_table, say
from .completion import complete_register

OPTIONS: dict[str, type[Answers]] = {
    **PART.options_classes(),
    **{model: chip.OPTIONS for model, chip in chip_models().items()},
}


MAPS: dict[str, tuple[int, RegisterMap]] = {module.name: (module.base, module.registers) for module in PART.modules}


@command("understand", "periph-sim regs I2C-A.I2CSTR", "periph-sim regs i2c --options")
@click.argument("name", required=False, shell_complete=complete_register)
@click.option("--options", "want_options", is_flag=True, help="List the open questions and their answers instead.")
def regs(name: str | None, want_options: bool) -> None:
    """Show the registers of MODULE, one register as MODULE.REGISTER or REGISTER, or all modules."""
    if want_options:
        show_options(name)
    elif name is None:
        modules = [((m, f"{base:#06x}", str(len(of.registers)), of.source), "") for m, (base, of) in MAPS.items()]
        print_table(("module", "base", "registers", "source"), modules)
    else:
        show_registers(*named(name))


def named(name: str) -> tuple[str, str]:
    """Return the module and the register that a user's text names. The register is "" if the text names a module.

    A register may be named without its module, in upper or lower case. Raise ClickException if several modules have a
    register of this name, or if the text is no such name but resembles the name of a register and of no module.
    """
    register = name.upper()
    modules = [] if name in MAPS else [module for module, (_, registers) in MAPS.items() if register in registers]
    if len(modules) > 1:
        ways = ", ".join(f"{module}.{register}" for module in modules)
        raise click.ClickException(f"{len(modules)} modules have a register {register}; write one of {ways}")
    if modules:
        return modules[0], register
    module, dot, register = name.partition(".")
    names = [register.name for _, registers in MAPS.values() for register in registers]
    if not dot and not nearest(name, MAPS) and nearest(name, names):
        raise click.ClickException(f"there is no module or register {name!r}; {did_you_mean(name, names)}")
    return module, register


def show_registers(module: str, register: str) -> None:
    """Print one register with its fields, or all registers of a module if `register` is ""."""
    if module not in MAPS:
        raise click.ClickException(f"there is no module {module!r}; {did_you_mean(module, MAPS)}")
    base, registers = MAPS[module]
    if not register:
        say(module, style="bold")
        rows = [((f"{base + r.offset:#06x}", r.name, reset_of(r), r.source), "") for r in registers]
        print_table(("address", "register", "reset", "source"), rows)
        return
    if register not in registers:
        hint = did_you_mean(register, (r.name for r in registers))
        raise click.ClickException(f"{module} has no register {register!r}; {hint}")
    shown = registers[register]
    say(f"{module}.{register}  {base + shown.offset:#06x}  reset {reset_of(shown)}  [{shown.source}]")
    if shown.protected:
        say("writes need EALLOW")
    fields = [((f.bits, f.name, f.access, number(f.reset), f.doc), "") for f in shown.fields]
    print_table(("bits", "field", "access", "reset", "what it is"), fields)


def reset_of(register: Register) -> str:
    return f"{register.reset:#0{2 + register.width // 4}x}"


def show_options(name: str | None) -> None:
    """Print each option with its values, the default value first, and below it the question that the option answers.

    name: the group whose options are printed; None for all groups.
    """
    if name is not None and name not in OPTIONS:
        raise click.ClickException(f"there are no options for {name!r}; {did_you_mean(name, OPTIONS)}")
    for group, kind in OPTIONS.items():
        if name in (None, group):
            for f in dataclasses.fields(kind):  # type: ignore[arg-type]
                values = allowed(f)
                if "values" not in f.metadata:
                    values = f"{f.default} ({values})"
                title = f"{group}.{f.name}: {values}"
                say(*wrap(title, WIDTH, subsequent_indent="    ", break_on_hyphens=False))
                say(*wrap(str(f.metadata["question"]), WIDTH, initial_indent="  ", subsequent_indent="  "))
