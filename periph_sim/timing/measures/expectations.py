"""Measures of expected replies, of unsolicited characters, and of expected edges on watched wires.

The scene reports to these measures what was sent, what was received, and the edges of watched wires.

The time of a reply:

send begins          send ends                       last character of the reply ends
|====================|------------- time ------------|
'-- window: a character that begins here or later can belong to the reply
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING, ClassVar

from msgspec import Struct, field

from ...core.state import State
from ...core.time import NO_TIME
from .measure import Measure, MeasuredScene

if TYPE_CHECKING:
    from ...devices.watchers import WireWatcher

WRONG = "whose first wrong character ended at"  # other code recognizes the text about a wrong reply by these words
BAD = 0x100  # this number is added to the value of a character with a wrong parity or without a stop bit


class Expected(Struct, frozen=True):
    """An expected reply.

    characters: the characters of the reply.
    source: the SCI that should send the reply, such as "dsp.SCI-A".
    show: a function that returns characters as text for messages.
    within: the maximum time of the reply, in ticks.
    anywhere: True if other characters may come before the reply.
    """

    characters: tuple[int, ...]
    show: Callable[[tuple[int, ...]], str]
    source: str
    within: int
    anywhere: bool


class _Occasion(Struct):
    """One request for a reply, and the characters that were received after the request.

    window: the tick from which characters on the line can be part of the reply.
    since: the tick at which the request ended. The reply's time counts from this tick. NO_TIME while the request is
        being sent.
    came: the characters received so far; if `Expected.anywhere` is True, only the last of them.
    wrong_at: the tick at which the first wrong character ended; NO_TIME if there is none.
    """

    STATE: ClassVar[State] = State("came shut", ticks="window since first ended wrong_at ends next_send", made=True)
    window: int
    since: int = NO_TIME
    came: list[int] = field(default_factory=list)
    first: int = NO_TIME  # the tick at which the first character began
    ended: int = NO_TIME  # the tick at which the last character so far ended
    wrong_at: int = NO_TIME
    ends: int = NO_TIME  # a wrong character that begins after this tick is not part of the reply; NO_TIME: no limit yet
    next_send: int = NO_TIME  # the tick at which the first send after the request begins
    shut: bool = False  # True after a wrong character that begins after `ends`; all later characters are ignored


class Reply(Measure):
    """Time from the end of a request to the end of the last character of its reply.

    A reply that is wrong, or that never comes, gives no value and breaks the budget.

    last: the tick at which the last character that belongs to a reply began; NO_TIME before the first such character.
    """

    STATE = State("_open", ticks="last")
    needs = "serial"
    asked = "times that the reply was asked for"

    _expected: Expected

    def __init__(self, name: str) -> None:
        super().__init__()
        self.name = name
        self.last = NO_TIME
        self._open: deque[_Occasion] = deque()
        self._judged = 0
        self._cut = False
        self._why_never: Callable[[], str] = str
        self._began, self._per_second = 0, 1

    @property
    def measured(self) -> int:
        return self._judged

    def listen(self, scene: MeasuredScene) -> None:
        self._began, self._per_second = scene.began, scene.ticks_per_second
        self._expected, self._why_never = scene.on_reply(self)

    # Events from the scene ----------------------------------------------------

    def window(self, tick: int) -> None:
        """Start to wait for a reply. Characters that begin at `tick` or later can be part of the reply."""
        self._give_up(tick)
        self._open.append(_Occasion(tick))

    def due(self, tick: int) -> None:
        """Start the time of the reply, because the request for this reply ended at `tick`."""
        waiting = next((one for one in self._open if one.since == NO_TIME), None)
        if waiting is not None:
            waiting.since = tick
            if waiting.ends == NO_TIME:
                waiting.ends = tick + self._expected.within
            self._settle()

    def sent(self, tick: int) -> None:
        """Handle the start of a send, at `tick`, to the SCI from which replies are expected."""
        for one in self._open:
            if one.next_send == NO_TIME < one.since < tick:
                one.next_send = tick

    def others_turn(self, tick: int) -> None:
        """Handle the start of another request at `tick`.

        End the replies that already have a wrong character, because later characters may belong to the reply to the
        other request.
        """
        for one in self._open:
            if one.wrong_at != NO_TIME and (one.ends == NO_TIME or one.ends > tick):
                one.ends = tick

    def character(self, begin: int, end: int, value: int, good: bool) -> None:
        """Handle a character on the line, which lasted from `begin` to `end`. good: False if it has an error."""
        expected = self._expected
        occasion = next((one for one in self._open if not self._over(one)), None)
        if occasion is None or begin < occasion.window:
            return
        came = occasion.came
        if not came and occasion.first == NO_TIME:
            occasion.first = begin
        came.append(value if good else BAD + value)
        right = tuple(came) == expected.characters[: len(came)]
        if not expected.anywhere and (occasion.shut or (not right and NO_TIME < occasion.ends < begin)):
            occasion.shut = True
            came.pop()
            return
        self.last = begin
        if expected.anywhere:
            right = True
            del came[: -max(len(expected.characters), 1)]
        if not right and occasion.wrong_at == NO_TIME:
            occasion.wrong_at = end
        occasion.ended = end
        self._settle()

    # Judging --------------------------------------------------------------------

    def _complete(self, occasion: _Occasion) -> bool:
        return tuple(occasion.came) == self._expected.characters

    def _over(self, occasion: _Occasion) -> bool:
        """Return True if later characters do not belong to this reply, because it has all its characters.

        If other characters may come before the reply (`Expected.anywhere`), the last characters must be those of the
        right reply. Otherwise, a wrong reply, too, is over after as many characters as the right one has.
        """
        enough = len(occasion.came) >= len(self._expected.characters)
        return self._complete(occasion) or (enough and not self._expected.anywhere)

    def _settle(self) -> None:
        """Judge the replies that are over (see `_over`), in the order of their requests."""
        while self._open and self._open[0].since != NO_TIME and self._over(self._open[0]):
            occasion = self._open.popleft()
            if self._complete(occasion):
                self._judge(occasion)
                self.take(max(0, occasion.ended - occasion.since), occasion.since)
            else:
                self._refute(occasion)

    def _judge(self, occasion: _Occasion) -> None:
        self.occasion(occasion.since)
        self._judged += occasion.since >= self.not_before

    def _refute(self, occasion: _Occasion) -> None:
        """Mark the budget as broken, because the right reply did not come.

        Do nothing if the request for this reply ended before `not_before`, from which tick on the budget is judged.

        The fault that the verdict shows begins at the end of the request. If a character was wrong, the fault ends with
        the last character that came. Otherwise it ends at the time limit of the reply, or at the next send if that is
        earlier.
        """
        if occasion.since < self.not_before:
            return
        self._judge(occasion)
        until = occasion.ended
        if occasion.wrong_at == NO_TIME:
            until = self._limit(occasion)
            if occasion.next_send != NO_TIME:
                until = min(until, occasion.next_send)
        self.refute(self._said(occasion), occasion.since, until)

    def _limit(self, occasion: _Occasion) -> int:
        return occasion.since + self._expected.within

    def _instant(self, tick: int) -> str:
        return f"{(tick - self._began) / self._per_second:.6f} s"

    def _said(self, occasion: _Occasion) -> str:
        expected = self._expected
        came = expected.show(tuple(occasion.came))
        wanted = f"{expected.show(expected.characters)} was expected from {expected.source}"
        by = f"by {self._instant(self._limit(occasion))}"
        if not occasion.came or (not expected.anywhere and occasion.first > self._limit(occasion) >= expected.within):
            return f"{wanted}, but nothing came {by}"
        if occasion.wrong_at != NO_TIME:
            return f"{wanted}, but {came} came, {WRONG} {self._instant(occasion.wrong_at)}"
        return f"{wanted}, but {came} came last" if expected.anywhere else f"{wanted}, but only {came} came {by}"

    def _give_up(self, now: int) -> None:
        """Judge the replies that are overdue or wrong, because another reply is requested."""
        while self._open:
            first = self._open[0]
            late = first.since != NO_TIME and now - first.since > self._expected.within
            if not late and first.wrong_at == NO_TIME:
                return
            self._refute(self._open.popleft())

    def finish(self, now: int) -> None:
        self._settle()
        for occasion in self._open:
            if occasion.since == NO_TIME or (
                now - occasion.since <= self._expected.within and occasion.wrong_at == NO_TIME
            ):
                self._cut = True
            else:
                self._refute(occasion)
        self._open.clear()

    def why_silent(self) -> str:
        if self._cut:
            return f"the run ended before the reply from {self._expected.source} had to be there; let it last longer"
        return self._why_never()


class Unsolicited(Measure):
    """Number of characters that belong to no expected reply, in a silence (`silence:NAME`) or in the whole run.

    A silence is a time in which no character may come.

    name: the send with which a silence begins. The silence ends when the time `within` has passed since the end of the
        send, or earlier, when other data is sent or another reply is requested. "" for the measure `unsolicited
        replies`, which counts in the whole run.
    source: the SCI that sent the first counted character; "" if there is none.
    """

    STATE = State("source _is_open _answer _over", ticks="_since _until _ended")
    unit = "characters"
    series = False
    needs = "serial"

    def __init__(self, name: str) -> None:
        super().__init__()
        self.name = name
        self.source = ""
        self._is_open = False  # True from the start of the send until `others_turn` is called
        self._since = NO_TIME  # the start of the last silence
        self._until = NO_TIME  # the end of the last silence; NO_TIME before the end of the send
        self._judged = 0  # number of silences that are over, so that they are judged
        self._cut = False
        self._answer: list[int] = []  # the unsolicited characters up to the first pause between them
        self._ended = NO_TIME  # the end of the last character in `_answer`
        self._over = False  # True if `_answer` is complete, because a character came after a pause or from another SCI

    @property
    def silent(self) -> bool:
        return bool(self.name) and not self._judged and not self.worst

    @property
    def measured(self) -> int:
        return self._judged if self.name else self.worst

    @property
    def counted(self) -> int:
        return self.measured

    def listen(self, scene: MeasuredScene) -> None:
        self._began, self._per_second = scene.began, scene.ticks_per_second
        self._show, self._why_never = scene.on_unsolicited(self)

    # Events from the scene ----------------------------------------------------

    def window(self, tick: int) -> None:
        """Begin a silence at `tick`, at which the send begins. From then on, no unsolicited character may begin."""
        self.others_turn(tick)
        if self._until < tick:  # otherwise, the previous silence continues
            self._since = tick
        self._is_open, self._until = True, NO_TIME

    def due(self, tick: int) -> None:
        """Set the end of the silence in progress to `tick`, which may be in the future."""
        if self._is_open:
            self._until = tick

    def others_turn(self, tick: int) -> None:
        """End the silence: other data or the next send of the same name begins, or another reply is requested."""
        if self._is_open:
            self._judged += 1
            self._is_open = False
            self._until = tick if self._until == NO_TIME else min(self._until, tick)

    def forbids(self, begin: int) -> bool:
        """Return True if an unsolicited character that begins at tick `begin` is one of those that this measure counts.

        In a silence, it counts if it begins in the last silence. In the whole run, every unsolicited character counts.
        """
        in_time = NO_TIME < self._since <= begin and (self._until == NO_TIME or begin < self._until)
        return in_time or not self.name

    def character(self, source: str, begin: int, end: int, value: int) -> None:
        """Handle a character that belongs to no expected reply. value: its value, plus BAD if it has an error."""
        if not self.forbids(begin):
            return
        self.worst += 1
        self.least = self.worst
        if not self._answer:
            self.source, self.worst_at, self.least_at = source, begin, begin
        elif source != self.source or begin - self._ended > 2 * (end - begin):
            self._over = True
        if not self._over:
            self._answer.append(value)
            self._ended = self.worst_until = end

    # Judging --------------------------------------------------------------------

    def finish(self, now: int) -> None:
        self._cut = self._is_open and (self._until == NO_TIME or now < self._until)
        if not self._cut:
            self.others_turn(now)

    def close(self, now: int) -> str:
        """Return a sentence that quotes the first unsolicited characters; "" if there are none."""
        if not self._answer:
            return ""
        came, ended = self._show(tuple(self._answer)), (self._ended - self._began) / self._per_second
        after = f" after send {self.name!r}" if self.name else ""
        return f"nothing was expected from {self.source}{after}, but {came} came, which ended at {ended:.6f} s"

    def why_silent(self) -> str:
        if self._cut:
            return f"the run ended before the silence after send {self.name!r} was over; let it last longer"
        return self._why_never()


class WatchedWire(Measure):
    """Deviation of an edge, or of a period, on a watched wire. A missing or unexpected edge breaks the budget."""

    _watcher: WireWatcher

    def __init__(self, name: str) -> None:
        super().__init__()
        self.name = name

    def listen(self, scene: MeasuredScene) -> None:
        self._watcher = scene.watcher(self)

    def finish(self, now: int) -> None:
        self._watcher.finish(now)

    def why_silent(self) -> str:
        return self._watcher.missing()
