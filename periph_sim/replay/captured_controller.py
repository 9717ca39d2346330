"""Agents that play the controller's half of an I2C capture, and the answers of all targets except the firmware.

    transfers --> edges of the controller --longest_low, least_gap--> moves --> SCL, SDA
                     ^-- polls added or left out <-- ACK or NACK of the firmware --'

If the firmware refuses its address as a busy target does, the controller polls it until the firmware acknowledges (see
`polling`). In a session, exactly the captured polls are played, because the UART capture has fixed times.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial

from ..bus.i2c.replayed_sides import I2cPlayer, Move, ScriptedTarget
from ..core.kernel import Kernel
from ..core.time import NO_TIME, Timebase
from ..core.wire import Wire
from ..traces.decode.i2c import Transfer
from .i2c_script import Edge, controllers_half, hurried, is_addressed, moves, usual_hold
from .polling import PolledCapture
from .setup import HOLD, Played


@dataclass(frozen=True)
class PlaybackPlan:
    """The settings with which the agents play a capture.

    part: the part of the capture that is played.
    own: the addresses of the firmware.
    origin: the tick of the beginning of the capture.
    longest_low: the maximum time, in positions, for which the controller holds SCL low. None: as long as captured.
    least_gap: the minimum time, in ticks, between two transfers. After a delay, the controller shortens pauses to this
        minimum until transfers begin at their captured times again. None: pauses have their captured lengths, so a
        delay affects all later transfers.
    """

    part: Played
    own: Sequence[int]
    timebase: Timebase
    origin: int
    longest_low: Fraction | None = None
    least_gap: int | None = None

    @property
    def per_position(self) -> Fraction:
        """The number of ticks per position of the capture."""
        return self.timebase.per_second / self.part.rate


class CapturedController:
    """Plays the controller's half of each transfer, and the answers of all targets except the firmware.

    player: the agent that drives the edges.
    on_end: a function that is called after the last transfer, or when `gave_up` is set.
    patience: the maximum time, in ticks, for which polls are added while the firmware refuses its address. None: polls
        are played as captured.

    polled: the captured transfers, adapted by the polls that were added and removed.
    gave_up: the address that the firmware refused for longer than `patience`, and the tick of the first of these NACKs;
        None if there is no such address.
    """

    def __init__(
        self,
        plan: PlaybackPlan,
        kernel: Kernel,
        scl: Wire,
        sda: Wire,
        on_end: Callable[[], None],
        patience: int | None = None,
    ) -> None:
        self.player = I2cPlayer(kernel, scl, sda)
        self.polled = PolledCapture(plan.part.transfers, plan.own)
        self.gave_up: tuple[int, int] | None = None
        self._patience = patience
        self._refused_since = NO_TIME
        self._sda_level = sda
        self._captured: list[Edge] = []
        self._edges: list[Edge] = []  # as captured, but with low phases shortened to `longest_low`, if it is set
        self._moves: list[Move] = []
        # For each address of the firmware that is still to be sent: (index of its phase, number of moves up to the
        # rising edge of SCL in its ACK bit).
        self._answers: deque[tuple[int, int]] = deque()
        self._plan = plan
        self._kernel = kernel
        self._on_end = on_end
        self._hold = usual_hold(plan.part.transfers, plan.part.half_sample)
        self._late = 0  # ticks by which the last transfer ended later than captured; not used with `least_gap`
        self._cut = 0  # ticks by which `longest_low` has shortened the last transfer
        self._delay = 0  # sum of all stretches (`player.delay`) before the last transfer
        answers = plan.part.answers_of_others(plan.own)
        if answers:
            ScriptedTarget(kernel, scl, sda, answers, plan.timebase.ticks(HOLD, "nearest"))

    def go_on(self) -> None:
        """Play the next transfer when it is due, or call `on_end` if none is left."""
        self._late = max(0, self._late + self.player.delay - self._delay - self._cut)
        self._delay = self.player.delay
        if not self.polled.left:
            self._on_end()
        else:
            self._kernel.call_at(max(self._due(), self._kernel.now), self._play)

    def _due(self) -> int:
        plan = self._plan
        captured = plan.origin + int(self.polled.next_start * plan.per_position)
        if plan.least_gap is None:
            return captured + self._late
        return max(captured, self._kernel.now + plan.least_gap)

    def _play(self) -> None:
        transfer = self.polled.begin()
        self._prepare(transfer, 0)
        self._cut = int((self._captured[-1].at - self._edges[-1].at) * self._plan.per_position) if self._edges else 0
        self._play_from(0)

    def _prepare(self, transfer: Transfer, first: int) -> None:
        """Create the moves of a transfer from phase `first` on, and find where the firmware answers its address."""
        plan = self._plan
        half = Transfer(transfer.phases[first:], transfer.stop, None)
        self._captured = self._edges = controllers_half(half, self._hold, plan.part.half_sample)
        if plan.longest_low is not None:
            self._edges = hurried(self._captured, plan.longest_low, plan.part.step)
        self._moves = moves(self._edges, plan.per_position)
        after = {edge.at: index for index, edge in enumerate(self._captured, 1) if edge.clock and edge.level}
        self._answers = deque(
            (number, after[Fraction(phase.bytes[0].bits[8].at)])
            for number, phase in enumerate(half.phases, first)
            if is_addressed(phase) and phase.address in plan.own
        )

    def _play_from(self, move: int) -> None:
        """Play the prepared moves from index `move` on, up to the firmware's next ACK or NACK of its address.

        Play them to the end if there is none, or if polls are played as captured.
        """
        if not self._answers or self._patience is None:
            self.player.play(self._moves[move:], self.go_on)
        else:
            number, end = self._answers.popleft()
            self.player.play(self._moves[move:end], partial(self._answered, number, end))

    def _answered(self, phase: int, move: int) -> None:
        """Adapt the polls to the firmware's ACK or NACK of its address, and continue.

        If the firmware has refused its address for longer than `patience`, end the replay.

        phase: the index of the phase, in the transfer in progress, that has the address.
        move: the number of moves that have been played, up to the rising edge of SCL in the ACK bit.
        """
        acked, now = not self._sda_level.level, self._kernel.now
        changed = self.polled.answered(phase, acked)
        if changed:
            self._cut -= self._cut_after(move)
            self._prepare(self.polled.transfers[-1], phase)
            _, move = self._answers.popleft()
            self._cut += self._cut_after(move)
        if acked:
            self._refused_since = NO_TIME
        elif changed and self._refused_since == NO_TIME:
            self._refused_since = now
        elif changed and now - self._refused_since > (self._patience or 0):
            address = self.polled.transfers[-1].phases[phase].address
            self.gave_up = address or 0, self._refused_since
            self._on_end()
            return
        self._play_from(move)

    def _cut_after(self, move: int) -> int:
        """Return by how many ticks `longest_low` shortens the prepared moves from index `move` on, in total."""
        captured = self._captured[-1].at - self._captured[move - 1].at
        return int((captured - (self._edges[-1].at - self._edges[move - 1].at)) * self._plan.per_position)
