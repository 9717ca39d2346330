"""The names that Python firmware imports: the class `Dsp`, start-up functions, and types and conversions of settings.

    from periph_sim.firmware import Dsp, Duration, start_i2c, start_pie

Terms of this package:
unit: one F28335 with its program.
case: a TOML file that describes the units, their wires and the other parties. It gives each program its settings.
to start a module: to switch on its clock, set up its pins and write its registers, as TI's example code does.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..core.convert import After, Before
from ..core.registered import lazy_names
from ..core.table import Duration, DurationRange, Frequency, HexBytes, Share, Spread
from ..processor.dsp import Dsp
from .startup import sci_fifo_receiver, start_i2c, start_pie, start_pin

if TYPE_CHECKING:
    from .sci import start_sci

__all__ = [
    "After",
    "Before",
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
__getattr__ = lazy_names("periph_sim.firmware", {"sci": ("start_sci",)})
