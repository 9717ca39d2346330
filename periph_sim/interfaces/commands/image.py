"""`periph-sim image FILE`: show the contents of a linker's output file for the F28335."""

from __future__ import annotations

from pathlib import Path

import click

from .command_frame import command, print_answer


@command("understand", "periph-sim image firmware.out", "periph-sim image firmware.out _main --cycles")
@click.argument("image", metavar="FILE", type=click.Path(path_type=Path))
@click.argument("function", metavar="[FUNCTION]", required=False)
@click.option("--cycles", is_flag=True, help="Explain the cycles of FUNCTION, one instruction a line.")
@click.option("-v", "--verbose", is_flag=True, help="List all functions, and all accesses to each register.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of text.")
def image(image: Path, function: str | None, cycles: bool, verbose: bool, as_json: bool) -> int:
    """Show the contents of FILE, the .out of TI's linker, COFF2 or C28x ELF, or assembly (.asm).

    The contents are the sections, the entry, vectors that the code stores, registers that it accesses, functions with
    their sizes, and words of code that are no instructions. Exit status 0: there are no such words, or
    --cycles is given; 1: there are some.
    """
    if cycles != (function is not None):
        raise click.UsageError("--cycles and FUNCTION belong together: periph-sim image --cycles FILE FUNCTION")
    from ...processor.image_files import function_cycles, inspection
    from ...processor.image_files.program_file import program_in

    program = program_in(image)
    if function is not None:
        spent = function_cycles.function_cycles(program, function)
        show = function_cycles.cycles_as_json if as_json else function_cycles.cycles_text
        print_answer("image_cycles", show(spent))
        return 0
    found = inspection.inspect(program)
    print_answer("image", inspection.as_json(found) if as_json else inspection.text(found, verbose))
    return 1 if found.unknown else 0
