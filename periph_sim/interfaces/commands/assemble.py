"""`periph-sim assemble SOURCE FILE`: assemble a program in C28x assembly, and write it as an image."""

from __future__ import annotations

from pathlib import Path

import click

from .command_frame import command


@command(
    "understand",
    "periph-sim assemble firmware/c28x/sci_echo.asm sci_echo.out",
    "periph-sim assemble firmware/c28x/imu_hil.asm firmware.out",
)
@click.argument("source", type=click.Path(path_type=Path))
@click.argument("file", type=click.Path(path_type=Path))
def assemble(source: Path, file: Path) -> None:
    """Assemble SOURCE into FILE, a .out in TI's COFF2.

    This assembler is for small programs in one source, in which `.sect "NAME", ADDRESS` sets the address of a section.
    It knows all instructions of the C28x and its FPU. docs/images.md has the directives.
    """
    from ...processor.image_files.assemble import assemble_file
    from ...traces.formats import atomic_write

    image, data = assemble_file(source)
    with atomic_write(file) as temporary:
        temporary.write_bytes(data)
    words = sum(len(section.words) for section in image.loaded)
    sections = f"{len(image.loaded)} section{'s' * (len(image.loaded) != 1)}"
    click.echo(f"{file}: {words} words in {sections}, entry {image.entry:#08x}")
