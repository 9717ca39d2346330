"""Loading of a program from a linker's output file, or its assembly from a source (.asm)."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from .load import load
from .model import BadImage, Image

SOURCE = ".asm"
MOST_ASSEMBLED = 8  # number of sources whose images are kept


def program_in(path: Path) -> Image:
    """Load an image from a file, or assemble a source file. Raise BadImage, with the path, if this fails.

    A source is assembled again only if it, or a file that it includes, has changed.
    """
    if path.suffix != SOURCE:
        return load(path)
    from .assemble import assemble_file, sources_of, text_of  # imported only for sources, because the import is slow

    try:
        texts = tuple((str(file), text_of(file)) for file in sources_of(path))
    except BadImage:  # for a missing file, the assembler names the line, or uses a shipped program
        return assemble_file(path)[0]
    return _assembled(path, texts)


@lru_cache(maxsize=MOST_ASSEMBLED)
def _assembled(path: Path, texts: tuple[tuple[str, str], ...]) -> Image:
    """Assemble a source file. texts: the path and the text of this file, and of each file that it includes."""
    from .assemble import assemble_file

    return assemble_file(path)[0]
