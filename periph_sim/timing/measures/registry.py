"""The measures that a budget calls by a fixed name. Measures of events that users name are in `event`."""

from __future__ import annotations

from ..budget_schema import REPLY, SPAN, WATCH
from .age import Age, ModelAge
from .bus import Nacked, Response, Stretch, Stuck, WrongBytes
from .measure import Measure
from .reply import Reply
from .round import MissedRounds, NackedRounds, RoundTime
from .sci import FifoHighWater, Overruns
from .span import SpanTime
from .watched_wire import WatchedWire

MEASURES: dict[str, type[Measure]] = {
    "response": Response,
    "stretch": Stretch,
    "round": RoundTime,
    "missed rounds": MissedRounds,
    "nacked rounds": NackedRounds,
    "nacked": Nacked,
    "wrong bytes": WrongBytes,
    "age": Age,
    "model age": ModelAge,
    "fifo high-water": FifoHighWater,
    "overruns": Overruns,
    "stuck": Stuck,
}


def make(name: str) -> Measure:
    """The measure that a budget names: one of MEASURES, "span:NAME", "reply:NAME", "watch:NAME". KeyError otherwise."""
    if name.startswith(REPLY):
        return Reply(name.removeprefix(REPLY))
    if name.startswith(SPAN):
        return SpanTime(name.removeprefix(SPAN))
    if name.startswith(WATCH):
        return WatchedWire(name.removeprefix(WATCH))
    return MEASURES[name]()
