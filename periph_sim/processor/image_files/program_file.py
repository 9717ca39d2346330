"""Loading of a program from a linker's output file, or its assembly from a source (.asm)."""

from __future__ import annotations

from pathlib import Path

from .load import load
from .model import Image

SOURCE = ".asm"


def program_in(path: Path) -> Image:
    """Load an image from a file, or assemble a source file. Raise BadImage, with the path, if this fails."""
    if path.suffix != SOURCE:
        return load(path)
    from .assemble import assemble_file  # imported only for sources, because the import is slow

    return assemble_file(path)[0]
