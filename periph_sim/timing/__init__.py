"""Measures, budgets and verdicts. The functions in `__all__` apply measures to recorded runs.

Terms of this package:

record: a recorded event of a run, with its kind, tick, place, thing and value (`core.records`).
derived record: a record that `timing/derived` makes from transfers, rounds or frames, such as the age of data.
measure: a rule that takes values from the records of a run, such as the times from one event to another.
budget: a measure with limits. Its verdict says whether a run has kept the limits. A budget is refuted if an event, such
    as a wrong reply, breaks it whatever the values are.
joined condition: a further measure with limits, under the key `and` of a budget.
scene: the simulated wires with all units, chips and other parties on them.
unit: one simulated F28335 with its firmware.
master: the party that controls the I2C bus: the simulated controller of the table [controller], a unit, or another
    program.
request: a write, a read, or both, that a master makes to one chip. In measures of the replies of an SCI, a request is
    the send, the event or the time after which a case expects the reply.
round: one execution of the requests that a master repeats periodically; it is due at its planned start.
frame: the values that the [host], a PC, sends in one message over UART. In events such as "frame TX 0x06", and in
    bursts, a frame is one UART character.
span: a part of the firmware with a name, such as a function, whose start and end are recorded.
occurrence: an event, or a pair of events, for which a measure takes one value.
occasion: an event at which a measure should take a value. The verdict of a budget shows at how many occasions a value
    was taken. "Asked" means that a value should be taken, as in "reads asked".
phase: the part of an I2C transfer from a START or repeated START to the next one, or to the STOP.
clause: a part of a measure's text after a comma that names one more event, such as "given EVENT".
place, thing: the `where` and the `what` of a record, such as "dsp.I2C-A" and "I2CSTR.XRDY". A place in the firmware is
    a statement.
topic: all records of one kind, place and thing.
tag: a number by which a measure recognizes the records of a topic.
chain: a possible sequence of the frames that successive model runs used.
model run: one execution of the firmware's sensor models; "run" alone is a run of the simulation.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..core.registered import lazy_names

if TYPE_CHECKING:
    from .measures.over_table import Distances, Durations, between, happened, lost_flags, periods, races

__all__ = ["Distances", "Durations", "between", "happened", "lost_flags", "periods", "races"]

__getattr__ = lazy_names(__name__, {"measures.over_table": tuple(__all__)})
