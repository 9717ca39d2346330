"""`periph-sim image FILE`: the contents of a linker's output file for the F28335."""

from __future__ import annotations

from pathlib import Path

import click

from .command_output import print_answer, usage_errors_in_one_sentence

SECTION = "understand"
EXAMPLE = "periph-sim image firmware.out"


@click.command()
@click.argument("image", metavar="FILE", type=click.Path(path_type=Path))
@click.argument("function", metavar="[FUNCTION]", required=False)
@click.option("--cycles", is_flag=True, help="Explain the cycles of FUNCTION, one instruction a line.")
@click.option("-v", "--verbose", is_flag=True, help="List all functions, and all accesses to each register.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of text.")
def image(image: Path, function: str | None, cycles: bool, verbose: bool, as_json: bool) -> int:
    """Show the contents of FILE, the .out of TI's linker, COFF2 or C28x ELF, or assembly (.asm).

    Sections, entry, vectors that code stores, registers that it accesses, functions with their size, and unknown words
    of code. Exit status 0: all words are known; 1: some are not.
    """
    if cycles != (function is not None):
        raise click.UsageError("--cycles and FUNCTION belong together: periph-sim image --cycles FILE FUNCTION")
    if function is not None:
        return _explain(image, function, as_json)
    from ...processor.image_files.inspection import as_json as as_dict
    from ...processor.image_files.inspection import inspect, text
    from ...processor.image_files.program_file import program_in

    with usage_errors_in_one_sentence():
        found = inspect(program_in(image))
    print_answer("image", as_dict(found) if as_json else text(found, verbose))
    return 1 if found.unknown else 0


def _explain(image: Path, function: str, as_json: bool) -> int:
    """Show the cycles of one function."""
    from ...processor.image_files.function_cycles import cycles_as_json, cycles_text, function_cycles
    from ...processor.image_files.program_file import program_in

    with usage_errors_in_one_sentence():
        found = function_cycles(program_in(image), function)
    print_answer("image_cycles", cycles_as_json(found) if as_json else cycles_text(found))
    return 0
