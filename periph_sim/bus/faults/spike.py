"""Noise on a line: it is pulled low for `width`, wherever it stands.

    __________   _________     width below what filters let pass: nobody sees it
              |_|

A line with a pull-up is weak only while it is high, so what is pulled low already stays as it is.
"""

from __future__ import annotations

from dataclasses import dataclass

from . import FaultContext, pulse
from .when import Length, When


@dataclass(frozen=True, kw_only=True)
class Settings(When):
    """wire: its name, as in "SCL"."""

    wire: str
    width: Length


def attach(settings: Settings, place: FaultContext) -> None:
    pulse(settings, place, settings.wire, settings.width)
