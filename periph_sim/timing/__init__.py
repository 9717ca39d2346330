"""Measures, budgets and verdicts. For recorded runs: `between`, `periods`, `happened`, `races` and `lost_flags`.

Terms of this package:

round: one execution of the list of transfers that a controller repeats periodically; it is due at its planned start.
frame: the values that the [host] sends in one message over UART.
occurrence: an event, or a time between two events, that has one value of a measure.
occasion: an event at which a measure should take a value.
clause: a part of a measure's text after a comma that names one more event, such as "given EVENT".
place, thing: the `where` and the `what` of a record, such as "dsp.I2C-A" and "I2CSTR.XRDY". A place in the firmware is
    a statement.
tag: a number that a measure gives to the records of one kind, place and thing that it needs.
model run: one execution of the firmware's sensor models; "run" alone is a run of the simulation.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..core.registered import lazy_names

if TYPE_CHECKING:
    from .measures.over_table import Distances, Durations, between, happened, lost_flags, periods, races

__all__ = ["Distances", "Durations", "between", "happened", "lost_flags", "periods", "races"]

__getattr__ = lazy_names(__name__, {"measures.over_table": tuple(__all__)})
