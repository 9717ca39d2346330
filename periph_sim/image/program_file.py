"""A program's file as an image: a path goes in; what a linker wrote is loaded, assembly (.asm) is assembled first."""

from __future__ import annotations

from pathlib import Path

from .load import load
from .model import Image

SOURCE = ".asm"


def program_in(path: Path) -> Image:
    """The image in a file, or of a source. BadImage, which names the file, where it is none of the F28335."""
    if path.suffix != SOURCE:
        return load(path)
    from .assemble import assemble_file  # and its table of syntaxes, for sources only

    return assemble_file(path)[0]
