"""Sections that overlap in RAM.

Overlapping loaded sections are refused by `load`. Reserved memory, or the run addresses of copied code, may overlap on
purpose (UNION in the linker's command file).
"""

from __future__ import annotations

from itertools import combinations

from ...f28335.memory.address_space import Content, area_at
from .model import Image


def shared_memory(image: Image) -> list[str]:
    """Return a sentence for each pair of sections that overlap in RAM."""
    in_ram = [section for section in image.sections if section.allocated and section.size and _is_ram(section.run)]
    notes = []
    for one, other in combinations(sorted(in_ram, key=lambda section: section.run), 2):
        end = min(one.run + one.size, other.run + other.size)
        if other.run < end:
            notes.append(
                f"sections {one.name} and {other.name} share {other.run:#08x} to {end - 1:#08x}: "
                "unless this is a UNION in the linker's command file, one overwrites the other"
            )
    return notes


def _is_ram(address: int) -> bool:
    area = area_at(address)
    return area is not None and area.content is Content.RAM
