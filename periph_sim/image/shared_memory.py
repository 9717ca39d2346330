"""Sections that lie over one another in RAM: an image goes in; a sentence for each pair of them comes out.

Two that are loaded there are refused (`load`). Of memory that is only reserved, or to which code is copied, a linker's
UNION may mean it.
"""

from __future__ import annotations

from itertools import combinations

from ..f28335.system.address_space import Content, area_at
from .model import Image


def shared_memory(image: Image) -> list[str]:
    """Where two sections run or lie at the same addresses."""
    in_ram = [section for section in image.sections if section.allocated and section.size and _is_ram(section.run)]
    told = []
    for one, other in combinations(sorted(in_ram, key=lambda section: section.run), 2):
        end = min(one.run + one.size, other.run + other.size)
        if other.run < end:
            told.append(
                f"sections {one.name} and {other.name} share {other.run:#08x} to {end - 1:#08x}: "
                "unless the linker's UNION is meant, one overwrites the other"
            )
    return told


def _is_ram(address: int) -> bool:
    area = area_at(address)
    return area is not None and area.content is Content.RAM
