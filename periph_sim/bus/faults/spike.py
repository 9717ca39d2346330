"""Noise on a line: a short pull to low for `width`, at any time.

    __________   _________     a spike shorter than the filters' limit is ignored
              |_|

A pull-up is weak, so noise can pull a high line low. A line that is already low does not change.
"""

from __future__ import annotations

from dataclasses import dataclass

from . import FaultContext, Length, Repeated, When, pulse


@dataclass(frozen=True, kw_only=True)
class Settings(When):
    """A short low pulse on a wire.

    wire: the wire, such as "SCL"
    width: duration of the pulse
    """

    wire: str
    width: Length


def attach(settings: Settings, place: FaultContext) -> Repeated:
    return pulse(settings, place, settings.wire, settings.width)
