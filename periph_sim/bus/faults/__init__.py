"""Faults on the wires: agents of several kinds that disturb a wire.

Each file in this folder with a function `attach` is one kind of fault, and is found automatically. It defines

    Settings                  a subclass of `When` that adds the keys of this kind to those of every [[fault]]
    attach(settings, place)   attaches the agent, returns the `Repeated` that triggers it; ValueError for bad settings

    at ---- every ---- every ---- ...     `When`: times is the maximum number of faults
    |~spread~|   maximum random delay of each fault, drawn from the case's seed

On a wire, the agent of a fault is a party like any other: it can pull the wire low. No other module depends on a kind
of fault.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, partial
from random import Random
from typing import Annotated, Protocol, cast

from msgspec import Meta

from ...core.agent import Agent
from ...core.convert import Before
from ...core.discover import modules_with
from ...core.kernel import Kernel
from ...core.sampler import watch
from ...core.state import State
from ...core.table import DURATION_TEXT, Duration, duration
from ...core.time import NO_TIME
from ...core.wire import Wire


def _above_zero(value: object) -> Fraction:
    length = duration(value)
    if not length:
        raise ValueError("it must be longer than 0")
    return length


Length = Annotated[Fraction, Before(_above_zero, DURATION_TEXT)]
Count = Annotated[int, Meta(ge=1)]


@dataclass(frozen=True, kw_only=True)
class When:
    """A fault that disturbs a wire or resets a unit at certain times. The key `kind` names the kind of fault.

    at: time of the first fault, from the start of the run
    every: time from one fault to the next; without it there is only one fault
    spread: maximum random delay of each fault
    times: maximum number of faults, with `every`
    """

    at: Duration
    every: Length | None = None
    spread: Duration = Fraction(0)
    times: Count | None = None

    def __post_init__(self) -> None:
        if self.every is None and self.times is not None:
            raise ValueError("'times' needs 'every'; give 'every', or remove 'times'")
        if self.every is not None and self.spread > self.every:
            raise ValueError("'spread' is longer than 'every', so faults would be out of order; shorten 'spread'")


LONG_HIGH = 10  # a high phase of SCL that is longer than this multiple of the low phase before it is not a clock


class SdaPuller(Agent):
    """Base of the faults that pull SDA low during one clock of SCL. `arm` requests the next disturbance.

    Subclasses define `clocked`, which is called with the new level of SCL after each change of SCL.
    """

    STATE = State("_armed _pulls _low _falls", ticks="_fell")

    def __init__(self, place: FaultContext) -> None:
        self._kernel = place.kernel
        self._fell = place.kernel.now  # the tick of the last fall of SCL
        self._low = 0  # duration of the last low phase of SCL, in ticks
        self._falls = 0
        self._scl, self._sda = place.wire("SCL"), place.wire("SDA")
        self._pin = self._sda.attach(place.who)
        self._armed = False
        self._pulls = False
        watch([self._scl], self)

    def arm(self) -> None:
        self._armed = True

    def sampled(self, now: int, levels: int) -> None:
        if levels:
            self._low = now - self._fell
        else:
            self._fell = now
            self._falls += 1
        self.clocked(now, levels)

    def clocked(self, now: int, level: int) -> None:
        raise NotImplementedError

    def _pull(self, pulls: bool) -> None:
        """Pull SDA low if `pulls`, else release it."""
        self._pulls = pulls
        self._pin.drive(not pulls)

    def _expect_fall(self) -> None:
        """Release SDA later if SCL stays high until then, because the controller waits for the rise of SDA."""
        self._kernel.call_at(self._kernel.now + LONG_HIGH * self._low, partial(self._not_clocked, self._falls))

    def _not_clocked(self, falls: int) -> None:
        if falls == self._falls and self._pulls:
            self._pull(False)


class HeldLine:
    """A party that can hold one line low.

    ticks: the time for which the line is held, if `clocks` is 0. A pull while the line is held extends this time.
    clocks: the number of falls of SCL after which the line is released; 0 to release it after `ticks`.
    who: the name of the party on the wire.
    """

    STATE = State("_left", ticks="_until")

    def __init__(self, kernel: Kernel, wire: Wire, scl: Wire | None, who: str, ticks: int, clocks: int) -> None:
        """scl: the wire SCL; it can be None if `clocks` is 0."""
        self._kernel = kernel
        self._pin = wire.attach(who)
        self._ticks, self._clocks = ticks, clocks
        self._left = 0  # number of falls of SCL until the line is released; 0 if `clocks` is 0 or the line is not held
        self._until = kernel.now  # the tick at which the line is released, if `clocks` is 0
        if clocks:
            assert scl is not None
            watch([scl], self._scl_changed)

    def pull(self) -> None:
        self._pin.drive(0)
        self._left = self._clocks
        if not self._clocks:
            self._until = self._kernel.now + self._ticks
            self._kernel.call_at(self._until, self._let_go)

    def _scl_changed(self, now: int, level: int) -> None:
        if self._left and not level:
            self._left -= 1
            if not self._left:
                self._let_go()

    def _let_go(self) -> None:
        if self._kernel.now >= self._until:
            self._pin.drive(1)


@dataclass(frozen=True)
class FaultContext:
    """The environment of a new fault.

    who: the name of the fault's agent on the wires.
    wire: a function that returns the wire with a name, and raises ValueError if the scene has no such wire.
    ticks: a function that converts seconds to ticks.
    start: the tick at which the run begins.
    random: the random generator of this fault alone.
    """

    STATE = State("random")

    kernel: Kernel
    who: str
    wire: Callable[[str], Wire]
    ticks: Callable[[Fraction], int]
    start: int
    random: Random


class FaultKind(Protocol):
    """Interface of a module that defines a kind of fault."""

    Settings: type[When]

    def attach(self, settings: When, place: FaultContext) -> Repeated: ...


@cache
def kinds() -> dict[str, FaultKind]:
    """Return the modules that define the kinds of faults, by the names of their files."""
    return {name: cast(FaultKind, module) for name, module in modules_with("attach", __name__, __path__).items()}


class Repeated:
    """Calls `strike` at each time of `when`.

    next_at: the tick of the next call; after the last call, the tick of the last call. Only one call is scheduled at a
        time.
    """

    STATE = State("_place _strike _number", ticks="next_at")

    def __init__(self, when: When, place: FaultContext, strike: Callable[[], None]) -> None:
        self._when = when
        self._place = place
        self._strike = strike
        self._number = 0
        self.next_at = NO_TIME
        self._plan()

    def _plan(self) -> None:
        when, place, number = self._when, self._place, self._number
        if number and (when.every is None or number == when.times):
            return
        due = place.start + place.ticks(when.at + number * (when.every or 0))
        late = place.random.randrange(place.ticks(when.spread) + 1)
        self.next_at = due + late
        place.kernel.call_at(self.next_at, self._struck)

    @property
    def who(self) -> str:
        """The name of the fault, such as "fault 0 (spike)"."""
        return self._place.who

    @property
    def has_occurred(self) -> bool:
        return self._number > 0

    def _struck(self) -> None:
        self._strike()
        self._number += 1
        self._plan()


def pulse(when: When, place: FaultContext, wire: str, length: Fraction) -> Repeated:
    """Return a `Repeated` that pulls a wire low for `length` at each time of `when`."""
    line = HeldLine(place.kernel, place.wire(wire), None, place.who, place.ticks(length), 0)
    return Repeated(when, place, line.pull)
