"""Divergences and the chip's side of each: a comparison goes in; divergences with their flag history come out.

The run is made once more, now recorded, and ends soon behind the last divergence.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction

from ..scene.scene import Scene
from .compare import Change, Divergence
from .history import FlagHistory


@dataclass(frozen=True)
class CaptureOrigin:
    """Where in a run the capture's time 0 is, and how long after an event its history is shown. Ticks."""

    scene: Scene
    origin: int
    after: int

    def moment(self, divergence: Divergence) -> tuple[int, int]:
        """The tick of a divergence, the chip's if it has one, and the last to be shown."""
        seconds = divergence.capture_s if divergence.replay_s is None else divergence.replay_s
        tick = self.scene.kernel.now if seconds is None else self.origin + self._ticks(seconds)
        return tick, tick + self.after

    def seconds(self, tick: int) -> float:
        return float(self.scene.timebase.seconds(tick - self.origin))

    def _ticks(self, seconds: float) -> int:
        return self.scene.timebase.ticks(Fraction(seconds), "nearest")


Run = Callable[[FlagHistory, int], None]  # the same run again, with this listening, up to that tick


def with_history(
    divergences: tuple[Divergence, ...], place: CaptureOrigin, unit: str, module: str, again: Run
) -> list[Divergence]:
    """The same divergences, each with what the chip did around it."""
    if not divergences:
        return []
    moments = [place.moment(divergence) for divergence in divergences]
    history = FlagHistory(moments, unit, module)
    again(history, max(until for _, until in moments))
    found = []
    for divergence, moment in zip(divergences, moments, strict=True):
        changes = tuple(
            Change(place.seconds(record.tick), _what(record.where, record.what), record.value)
            for record in history.of(moment)
        )
        found.append(replace(divergence, history=changes))
    return found


def _what(where: str, what: str) -> str:
    return what if what[:2] in ("R ", "W ") else f"{where.rpartition('.')[2]}.{what}"
