"""Load a program from a linker's output file, or assemble it from a source (.asm)."""

from __future__ import annotations

from pathlib import Path

from .load import load
from .model import Image

SOURCE = ".asm"


def program_in(path: Path) -> Image:
    """Load or assemble the image in a file. Raise BadImage naming the file if it is not an F28335 image."""
    if path.suffix != SOURCE:
        return load(path)
    from .assemble import assemble_file  # slow import, needed for sources only

    return assemble_file(path)[0]
