"""Measures of rounds: rounds seen on the bus, due and missed ones go in; times and counts come out."""

from __future__ import annotations

from abc import ABC, abstractmethod

from ...devices.sensor_rounds import Round
from .measure import Counter, Measure, SceneEvents


class RoundMeasure(Measure, ABC):
    """A measure of rounds. Its occasions are the rounds that were due; one that the end of the run cuts off is none."""

    needs = "rounds"
    asked = "rounds due"

    def listen(self, scene: SceneEvents) -> None:
        scene.on_round_due(self.occasion)
        scene.on_round(self.round)

    @abstractmethod
    def round(self, over: Round) -> None:
        """A round is over."""


class RoundTime(RoundMeasure):
    """From a round's begin to its last STOP. How late the controller itself begins is left out."""

    def round(self, over: Round) -> None:
        self.take(over.end - over.start, over.start)

    def missing(self) -> str:
        return "no round was completed"


class MissedRounds(Counter):
    """Rounds that did not begin while they were due, or that lack a request."""

    needs = "rounds"
    asked = "rounds due"

    @property
    def silent(self) -> bool:
        """No round was due, as where an outside controller asks for something else."""
        return not self.occasions

    @property
    def measured(self) -> int:
        """Of a round that is due it is always known whether it began."""
        return self.occasions or 0

    def missing(self) -> str:
        return "no round was due"

    def listen(self, scene: SceneEvents) -> None:
        scene.on_round_due(self.occasion)
        scene.on_missed_round(self.one_more)


class NackedRounds(RoundMeasure, Counter):
    """Rounds with at least one request whose address nobody acknowledged."""

    def listen(self, scene: SceneEvents) -> None:
        self._rounds = 0
        super().listen(scene)

    @property
    def silent(self) -> bool:
        return not self._rounds

    @property
    def measured(self) -> int:
        return self._rounds

    def missing(self) -> str:
        return "no round was completed"

    def round(self, over: Round) -> None:
        self._rounds += over.due >= self.not_before
        if over.nacked:
            self.one_more(over.due)


class Slack(RoundMeasure):
    """From a round's last STOP to the moment at which the next round is due; negative where it came too late."""

    def listen(self, scene: SceneEvents) -> None:
        super().listen(scene)
        self._period = scene.round_period()

    def round(self, over: Round) -> None:
        self.take(over.due + self._period - over.end, over.end)

    def missing(self) -> str:
        return "no round was completed"
