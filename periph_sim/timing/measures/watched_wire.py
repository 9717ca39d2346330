"""Measure of the deviations of a watched wire."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .measure import Measure
from .measured_scene import MeasuredScene

if TYPE_CHECKING:
    from ...devices.watchers import WireWatcher


class WatchedWire(Measure):
    """Between an edge of a watched wire and when it was expected. One that is missing or wrong breaks it."""

    def __init__(self, name: str) -> None:
        super().__init__()
        self.name = name
        self.refuted = ""
        self._watcher: WireWatcher | None = None
        self._now = 0

    def listen(self, scene: MeasuredScene) -> None:
        self._watcher = scene.watcher(self)

    def refute(self, why: str, at: int) -> None:
        """Break the budget, whatever values follow."""
        if not self.refuted and at >= self.not_before:
            self.refuted, self.refuted_at, self.refuted_until = why, at, at

    def finish(self, now: int) -> None:
        assert self._watcher is not None
        self._watcher.finish(now)

    def why_silent(self) -> str:
        return "" if self._watcher is None else self._watcher.missing()
