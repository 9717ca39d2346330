"""Checks of a capture's time base before a replay: its rate, and a maximum length."""

from __future__ import annotations

from fractions import Fraction

from ..traces.capture.capture import Capture
from ..traces.capture.resample import rate_text
from . import BadReplay

LONGEST = 24 * 3600  # simulated seconds


def rate_of(capture: Capture) -> Fraction:
    """Return the number of positions in a second. BadReplay if the file states none."""
    if capture.rate is None:
        raise BadReplay(f"{capture.path}: a replay needs a time base and the file states no rate; state the rate")
    return capture.rate


def check_length(capture: Capture, end: int) -> None:
    """Raise BadReplay if playing up to position `end` takes longer than a day."""
    rate = rate_of(capture)
    if end > LONGEST * rate:
        raise BadReplay(
            f"{capture.path}: at {rate_text(rate)} there are {float(end / rate / 3600):.0f} hours to play; expected at "
            f"most {LONGEST // 3600}; state the right rate with --rate, or cut it with periph-sim convert --window"
        )
