"""Firmware that worker processes import by its name."""

from __future__ import annotations

import os
from typing import Any


def pausing(dsp: Any, settings: Any) -> None:
    """Run ten spans of 10 us and wait for ever."""
    for _ in range(10):
        with dsp.span("work"):
            dsp.compute(1500)
    dsp.spin(lambda: False)


def dying(dsp: Any, settings: Any) -> None:
    """End the process."""
    dsp.compute(100)
    os._exit(3)
