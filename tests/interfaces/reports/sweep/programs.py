"""Firmware that workers of another process import by name."""

from __future__ import annotations

import os
from typing import Any


def pausing(dsp: Any, settings: Any) -> None:
    """Ten spans of 10 us."""
    for _ in range(10):
        with dsp.span("work"):
            dsp.compute(1500)
    dsp.spin(lambda: False)


def dying(dsp: Any, settings: Any) -> None:
    """Takes its process with it."""
    dsp.compute(100)
    os._exit(3)
