"""Which channels are called as a line of a bus: a Capture and `scl` go in, the channels of that name come out."""

from __future__ import annotations

import re

from .capture import Capture, Channel


def channels_named(capture: Capture, line: str) -> list[Channel]:
    """The channels named `line` but for scopes (`tb.bus.scl`) and case; if none is, those with it as a word.

    `Channel 0 (SDA)`, `24LC515 SCL` and `i2c_scl` have the word; `SCL2` and `MISCL` do not.
    """
    names = {channel.index: channel.name.rpartition(".")[2].casefold() for channel in capture.channels}
    found = [channel for channel in capture.channels if names[channel.index].strip() == line]
    return found or [c for c in capture.channels if line in re.split(r"[^0-9a-z]+", names[c.index])]
