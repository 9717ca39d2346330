"""Notes of chips and devices that are errors of the firmware with `strict`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from ..core.chip import Note

if TYPE_CHECKING:
    from ..processor.dsp import Dsp


def insist(units: Mapping[str, Dsp], name: str, note: Note) -> None:
    """Raise the error in the firmware. name: the name of the chip or device."""
    for dsp in units.values():
        dsp.processor.notes.raise_if_strict(note, name)
