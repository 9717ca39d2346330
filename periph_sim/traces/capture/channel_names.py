"""Find the channels of a capture that are named like a line of a bus, such as `scl`."""

from __future__ import annotations

import re

from .capture import Capture, Channel


def channels_named(capture: Capture, line: str) -> list[Channel]:
    """Return the channels named `line`, ignoring scopes (`tb.bus.scl`) and case; if none, those with it as a word.

    `Channel 0 (SDA)`, `24LC515 SCL` and `i2c_scl` have the word; `SCL2` and `MISCL` do not.
    """
    names = {channel.index: channel.name.rpartition(".")[2].casefold() for channel in capture.channels}
    found = [channel for channel in capture.channels if names[channel.index].strip() == line]
    return found or [c for c in capture.channels if line in re.split(r"[^0-9a-z]+", names[c.index])]
