"""Measures of rounds: what the controller's schedule wanted and what became of it go in, times and counts come out."""

from __future__ import annotations

from abc import ABC, abstractmethod

from ..devices.sensor_head import Round
from .measures import Counter, Happenings, Measure


class OfRounds(Measure, ABC):
    """A measure of rounds. Its occasions are the rounds that were due; one that the end of the run cuts off is none."""

    needs = "controller"
    asked = "rounds due"

    def listen(self, scene: Happenings) -> None:
        self._open: list[int] = []  # rounds that were due and are not over, by when
        scene.listen_due(self._due)
        scene.listen_missed(self._missed)
        scene.listen_rounds(self._over)

    def _due(self, due: int) -> None:
        self._open.append(due)
        self.occasion(due)

    def _missed(self, due: int) -> None:
        self._open.remove(due)

    def _over(self, over: Round) -> None:
        if over.due in self._open:
            self._open.remove(over.due)
        self.round(over)

    @abstractmethod
    def round(self, over: Round) -> None:
        """A round is over."""

    def finish(self, now: int) -> None:
        for due in self._open:
            self.occasion(due, -1)


class RoundTime(OfRounds):
    """From the begin of a round to its last STOP. How late the controller itself begins is left out."""

    def round(self, over: Round) -> None:
        self.take(over.end - over.start, over.start)


class MissedRounds(Counter):
    """Rounds that could not begin when they were due, since the one before still ran."""

    needs = "controller"

    def listen(self, scene: Happenings) -> None:
        scene.listen_missed(self.one_more)


class NackedRounds(OfRounds, Counter):
    """Rounds with at least one request whose address nobody acknowledged."""

    def listen(self, scene: Happenings) -> None:
        self._rounds = 0
        super().listen(scene)

    @property
    def measured(self) -> int:
        return self._rounds

    def round(self, over: Round) -> None:
        self._rounds += over.due >= self.not_before
        if over.nacked:
            self.one_more(over.due)


class Slack(OfRounds):
    """From a round's last STOP to the moment at which the next round is due; negative where it came too late."""

    def listen(self, scene: Happenings) -> None:
        super().listen(scene)
        self._period = scene.round_period()

    def round(self, over: Round) -> None:
        self.take(over.due + self._period - over.end, over.end)

    def missing(self) -> str:
        return "no round was completed"
