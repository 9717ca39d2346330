"""Loading of images from a linker's output file, checked for the F28335.

`parse` checks that a section is loaded, that no two loaded sections overlap, that each is in loadable memory, and that
the entry is in loaded code. Reserved memory, and the memory to which code is copied, may overlap, because UNION in the
linker's command file makes sections share memory on purpose.
"""

from __future__ import annotations

from itertools import combinations, pairwise
from pathlib import Path

from ...core.input_files import read_input, similar_file
from ...f28335.descriptor import Part
from ...f28335.memory.address_space import Content, area_at, not_loadable
from ...f28335.parts.f28335 import PART
from . import coff2
from .model import BadImage, Image, quoted

OTHER_PART = "a part with a CLA (F2803x, F2806x or F2837x)"  # its images have sections whose names begin with "Cla1"
ELF_MAGIC = b"\x7fELF"
WAY_OUT = "give the linker's .out file, or assembly (.asm)"
LARGEST = 1 << 28  # maximum number of bytes of a file; in a file of this size, most bytes are debug data


def load(path: Path) -> Image:
    """Load an image from a file. Raise BadImage, with the path, if it cannot be read or is not an F28335 image."""
    try:
        data = read_input(path, LARGEST)
    except OSError as error:
        raise BadImage(f"{path}: {error.strerror}; {similar_file(path) or WAY_OUT}") from None
    try:
        return parse(data)
    except BadImage as error:
        raise BadImage(f"{path}: {error}") from None


def parse(data: bytes) -> Image:
    """Return the image in the bytes of a TI COFF or ELF file. Raise BadImage if it is not an F28335 image."""
    if coff2.is_coff(data):
        image = coff2.read(data)
    elif data.startswith(ELF_MAGIC):
        from . import elf  # imported only for ELF files, because the module imports a large library

        image = elf.read(data)
    else:
        raise BadImage(f"it is neither TI COFF nor ELF; {WAY_OUT}")
    for section in image.sections:
        if section.name.startswith("Cla1") and section.size:
            raise BadImage(
                f"section {quoted(section.name)} belongs to {OTHER_PART}, not to the F28335; link it for the F28335"
            )
    loaded = sorted(image.loaded, key=lambda section: section.address)
    if not loaded:
        raise BadImage("it has no loaded section, so there is nothing to run")
    require_loadable(image, PART)
    for before, after in pairwise(loaded):
        if after.address < before.end:
            raise BadImage(
                f"sections {quoted(before.name)} and {quoted(after.name)} overlap at {after.address:#08x}; "
                "each word can be loaded once"
            )
    if not any(section.address <= image.entry < section.end for section in image.code):
        raise BadImage(f"its entry {image.entry:#08x} is not in a loaded code section; link it with an entry point")
    return image


def require_loadable(image: Image, part: Part) -> None:
    """Raise BadImage if words are at addresses that cannot be loaded, or that this part of the family does not have.

    The words are those of loaded sections, at their load and run addresses, and the initial values.
    """
    named = [(f"section {quoted(one.name)} lies", one) for one in image.loaded]
    placed = [(what, address, one.size) for what, one in named for address in (one.address, one.run)]
    placed += [(f".cinit initialises {len(words)} words", address, len(words)) for address, words in image.initial]
    for what, address, size in placed:
        why = not_loadable(address, size, part)
        if why:
            raise BadImage(f"{what} {why}")


def shared_memory(image: Image) -> list[str]:
    """Return a sentence about each pair of sections whose run addresses overlap in RAM."""
    placed = [section for section in image.sections if section.allocated and section.size]
    in_ram = [one for one in placed if (area := area_at(one.run)) is not None and area.content is Content.RAM]
    notes = []
    for one, other in combinations(sorted(in_ram, key=lambda section: section.run), 2):
        end = min(one.run + one.size, other.run + other.size)
        if other.run < end:
            notes.append(
                f"sections {one.name} and {other.name} share {other.run:#08x} to {end - 1:#08x}: "
                "unless this is a UNION in the linker's command file, one overwrites the other"
            )
    return notes
