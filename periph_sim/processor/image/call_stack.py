"""Which functions of an image are under way: jumps go in; calls and returns come out, to whoever wants to know.

    ImageProgram --jumped, routine--> CallStack --called, returned--> CallListener: spans, a profile
                                          '-- frames: the innermost last

A call pushes a frame with the address that it comes back to; whatever arrives at that address ends it, and what it had
called. A jump to another function is a tail call: that function takes the frame over. So an RTOS, which returns through
frames that it made, and `exit` which never returns, leave a stack that is right for what runs.
"""

from __future__ import annotations

from ...c28x.execution.registers import Operation
from ...c28x.flow import CALLS, INTERRUPTS, RETURNS
from ...core.state import State
from ...core.time import Clock
from .function_map import FunctionMap

NOWHERE = -1  # instead of an address: it does not come back


class Frame:
    """A function under way. return_to: the address behind its call. first, end: the addresses that are its own.

    since: the tick at which it began.
    """

    STATE = State("name first end return_to", ticks="since", made=True)

    __slots__ = ("end", "first", "name", "return_to", "since")

    def __init__(self, name: str, first: int, end: int, return_to: int, since: int) -> None:
        self.name = name
        self.first = first
        self.end = end
        self.return_to = return_to
        self.since = since


class CallListener:
    """Who wants to know of calls. tick: as the first instruction begins of what goes on then."""

    __slots__ = ()

    def called(self, name: str, tick: int) -> None:
        """A function begins."""
        raise NotImplementedError

    def returned(self, name: str, tick: int) -> None:
        """The function that began last, of those that are under way, is over."""
        raise NotImplementedError

    def slept(self, ticks: int) -> None:
        """So much time of the innermost function has passed without an instruction."""


class CallStack:
    """frames: what is under way, the innermost last."""

    STATE = State("frames _listeners")

    def __init__(self, functions: FunctionMap, clock: Clock) -> None:
        self.frames: list[Frame] = []
        self._functions = functions
        self._clock = clock
        self._listeners: list[CallListener] = []

    def tell(self, listener: CallListener) -> None:
        """`listener` is told of calls from now on, and of those under way."""
        self._listeners.append(listener)
        for frame in self.frames:
            listener.called(frame.name, frame.since)

    def began(self, pc: int, cycle: int) -> None:
        """The program begins there."""
        self._drop(0, cycle)
        self._push(pc, NOWHERE, cycle)

    def jumped(self, f: Operation, pc: int, cycle: int) -> None:
        """An instruction did not go on to the next one, but to `pc`."""
        mnemonic = f.encoding.mnemonic
        if mnemonic in CALLS or mnemonic in INTERRUPTS:
            self._push(pc, f.next, cycle)
            return
        frame = self.frames[-1]
        if frame.first <= pc < frame.end and mnemonic not in RETURNS:
            return
        self.came_back(pc, cycle)

    def came_back(self, pc: int, cycle: int) -> None:
        """A function is over, and `pc` is where it was called from; if nobody called from there, another one runs."""
        for place in range(len(self.frames) - 1, -1, -1):
            if self.frames[place].return_to == pc:
                self._drop(place, cycle)
                return
        self._replace(pc, cycle)

    def slept(self, ticks: int) -> None:
        """Nothing was executed for so long: IDLE, or a wait whose passes were skipped."""
        for listener in self._listeners:
            listener.slept(ticks)

    def routine(self, pc: int, interrupted: int, cycle: int) -> None:
        """A service routine begins at `pc`, in the middle of what goes on at `interrupted`."""
        self._push(pc, interrupted, cycle)

    def _replace(self, pc: int, cycle: int) -> None:
        """The innermost frame becomes that of another function, if it is one."""
        frame = self.frames[-1]
        if frame.first <= pc < frame.end:
            return
        self._drop(len(self.frames) - 1, cycle)
        self._push(pc, frame.return_to, cycle)

    def _push(self, pc: int, return_to: int, cycle: int) -> None:
        inside = self._functions.at(pc)
        name, first = (inside.name, inside.address) if inside else (f"{pc:#08x}", pc)
        tick = self._clock.tick(cycle)
        self.frames.append(Frame(name, first, first + inside.size if inside else pc + 1, return_to, tick))
        for listener in self._listeners:
            listener.called(name, tick)

    def _drop(self, place: int, cycle: int) -> None:
        """Frames from this one on are over."""
        tick = self._clock.tick(cycle)
        while len(self.frames) > place:
            name = self.frames.pop().name
            for listener in self._listeners:
                listener.returned(name, tick)
