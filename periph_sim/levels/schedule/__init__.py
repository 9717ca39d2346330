"""The level `schedule`: the reference firmware's rounds as arithmetic over arrays, without registers, wires or events.

    case --short edge runs--> terms --+
    changes --> inputs --> frames ----+--> rounds, read by read --> observables of every scenario

It knows one structure (`structure`), and refuses every other one.
"""

from __future__ import annotations

from .call import schedule
from .errors import BadSchedule
from .result import Observable, ScheduleResult
from .structure import Structure, structure_of

__all__ = ["BadSchedule", "Observable", "ScheduleResult", "Structure", "schedule", "structure_of"]
