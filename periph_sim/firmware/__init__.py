"""What firmware imports: start-up code that reads like TI's, and types for its settings.

from periph_sim.firmware import Duration, start_i2c, start_pie
"""

from __future__ import annotations

from ..core.settings import Duration, DurationRange, Frequency, HexBytes, Share, Spread
from ..processor.dsp import Dsp
from .sci import start_sci
from .startup import sci_fifo_receiver, start_i2c, start_pie, start_pin

__all__ = [
    "Dsp",
    "Duration",
    "DurationRange",
    "Frequency",
    "HexBytes",
    "Share",
    "Spread",
    "sci_fifo_receiver",
    "start_i2c",
    "start_pie",
    "start_pin",
    "start_sci",
]
