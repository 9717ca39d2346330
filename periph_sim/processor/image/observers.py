"""Observers of a running image: of executed instructions, function calls, and writes to variables.

    ImageProgram --executed--> InstructionWatch: Coverage, StackDepth; CountingLoop of `counting_loop`
    ImageProgram --jumped, push--> CallStack --called, returned--> CallListener: FunctionSpans, Profile, PresetMemory
    ImageMemory --written--> VariableRecords, which is a CallListener, too

Observers of this module do not change the state of the program, except `PresetMemory`, which writes variables when main
begins.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable

from msgspec import Struct

from ...core.records import Kind, Recorder
from ...core.state import State
from ...core.time import Clock
from ...f28335.memory.ram import MEMORY, Ram
from ..c28x.decoder import CALLS, INTERRUPTS, RETURNS
from ..c28x.execution.cpu import Cpu, Operation
from ..image_files.debug_info import FunctionMap
from ..image_files.model import Section
from ..image_files.variables import Variable

# Instructions ----------------------------------------------------------------------


class InstructionWatch:
    """Base of the observers of executed instructions."""

    STATE = State()

    def executed(self, f: Operation, cpu: Cpu, cycle: int) -> None:
        """Receive an executed instruction, or one pass of a repeated instruction.

        cycle: the cycle at which the next instruction or pass begins.
        """
        raise NotImplementedError


class Coverage(InstructionWatch):
    """Counts the executions and the taken jumps of each instruction. Skipped passes of waits are not counted.

    executed_at: for the address of each executed instruction, the number of executions.
    jumped_at: for the address of each instruction that has jumped, the number of executions that ended in a jump.
    """

    def __init__(self) -> None:
        self.executed_at: Counter[int] = Counter()
        self.jumped_at: Counter[int] = Counter()

    def executed(self, f: Operation, cpu: Cpu, cycle: int) -> None:
        if not cpu.passes:  # further passes of RPT do not count
            self.executed_at[f.address] += 1
            if cpu.pc != f.next:
                self.jumped_at[f.address] += 1


SECTION = ".stack"
STACK = "stack"  # written to records where other records have the name of a register
CPU = "CPU"  # written to records where other records have the name of a module


class StackDepth(InstructionWatch):
    """Makes a record of each new maximum of the stack depth, in words.

    Only the stack in the section `.stack` counts. An SP outside of this section, as in a task of an RTOS, is ignored.
    The 14 words that an interrupt saves are included as soon as the first instruction of its service routine has been
    executed.
    """

    STATE = State("_deepest")

    def __init__(
        self, section: Section, recorder: Recorder, clock: Clock, unit: str, place: Callable[[], str | None]
    ) -> None:
        """section: the section `.stack`. unit: the name of the unit. place: returns the present statement."""
        self._place = place
        self._begin, self._end = section.run, section.run + section.size
        self._deepest = section.run
        self._clock = clock
        self._topic = recorder.topic(Kind.FLAG, f"{unit}.{CPU}", STACK)

    def executed(self, f: Operation, cpu: Cpu, cycle: int) -> None:
        if self._deepest < cpu.sp <= self._end:
            self._deepest = cpu.sp
            self._topic.emit(self._clock.tick(cycle), cpu.sp - self._begin, self._place() or "")


# Calls -----------------------------------------------------------------------------

NOWHERE = -1  # the return address of the first function, which does not return


class Frame:
    """An active function.

    first, end: the range of its addresses; `end` is the address after its last word.
    return_to: the address to which the function returns: the address after a call, or one in the interrupted code.
        NOWHERE for the first function.
    since: the tick at which the function began.
    """

    STATE = State("name first end return_to", ticks="since", made=True)

    def __init__(self, name: str, first: int, end: int, return_to: int, since: int) -> None:
        self.name = name
        self.first = first
        self.end = end
        self.return_to = return_to
        self.since = since


class CallListener:
    """A listener to function calls. tick: the tick at which the first instruction after the call or return begins."""

    def called(self, name: str, tick: int) -> None:
        """Receive the start of a function."""

    def returned(self, name: str, tick: int) -> None:
        """Receive the end of the innermost active function."""

    def slept(self, ticks: int) -> None:
        """Receive the duration of a sleep, in which the innermost function has executed no instruction."""


class CallStack:
    """Call stack of an image, derived from its jumps.

    A call pushes a frame with its return address. A jump to that address ends the frame and all frames inside it. A
    jump to another function is a tail call: that function replaces the innermost function. So the innermost frame is
    also right with an RTOS, which builds the frames through which it returns, and with `exit`, which never returns.

    frames: the active functions, the innermost last.
    """

    STATE = State("frames _listeners")

    def __init__(self, functions: FunctionMap, clock: Clock) -> None:
        self.frames: list[Frame] = []
        self._functions = functions
        self._clock = clock
        self._listeners: list[CallListener] = []

    def add_listener(self, listener: CallListener) -> None:
        """Add a listener, and call its `called` for each active function."""
        self._listeners.append(listener)
        for frame in self.frames:
            listener.called(frame.name, frame.since)

    def began(self, pc: int, cycle: int) -> None:
        """End all frames, and add the frame of the function at `pc`, where the program starts."""
        self._drop(0, cycle)
        self.push(pc, NOWHERE, cycle)

    def jumped(self, f: Operation, pc: int, cycle: int) -> None:
        """Update the frames after instruction `f` has jumped to `pc`."""
        mnemonic = f.encoding.mnemonic
        if mnemonic in CALLS or mnemonic in INTERRUPTS:
            self.push(pc, f.next, cycle)
            return
        frame = self.frames[-1]
        if frame.first <= pc < frame.end and mnemonic not in RETURNS:
            return
        self.on_return(pc, cycle)

    def on_return(self, pc: int, cycle: int) -> None:
        """Update the frames after a return, or a jump out of the innermost function, to `pc`.

        If a frame has the return address `pc`, this frame and all frames inside it end. Otherwise the innermost
        function is replaced by the function at `pc`, unless `pc` is inside the innermost function.
        """
        for place in range(len(self.frames) - 1, -1, -1):
            if self.frames[place].return_to == pc:
                self._drop(place, cycle)
                return
        frame = self.frames[-1]
        if not frame.first <= pc < frame.end:
            self._drop(len(self.frames) - 1, cycle)
            self.push(pc, frame.return_to, cycle)

    def slept(self, ticks: int) -> None:
        """Pass the duration of a sleep to the listeners: of IDLE, or of a wait whose passes were skipped."""
        for listener in self._listeners:
            listener.slept(ticks)

    def push(self, pc: int, return_to: int, cycle: int) -> None:
        """Add a frame for the function or service routine that begins at `pc`."""
        inside = self._functions.at(pc)
        name, first = (inside.name, inside.address) if inside else (f"{pc:#08x}", pc)
        tick = self._clock.tick(cycle)
        self.frames.append(Frame(name, first, first + inside.size if inside else pc + 1, return_to, tick))
        for listener in self._listeners:
            listener.called(name, tick)

    def _drop(self, place: int, cycle: int) -> None:
        """End the frames from index `place` on, the innermost first."""
        tick = self._clock.tick(cycle)
        while len(self.frames) > place:
            name = self.frames.pop().name
            for listener in self._listeners:
                listener.returned(name, tick)


class FunctionSpans(CallListener):
    """Makes SPAN records of the starts and ends of functions.

    If a function calls itself, the outermost call and all calls inside it are one span.
    """

    STATE = State("_depth")

    def __init__(self, recorder: Recorder, unit: str, place: Callable[[str], str]) -> None:
        """place: returns, for the name of a function, the place of its first instruction."""
        self._recorder = recorder
        self._unit = unit
        self._place = place
        self._places: dict[str, str] = {}
        self._depth: dict[str, int] = {}

    def called(self, name: str, tick: int) -> None:
        depth = self._depth[name] = self._depth.get(name, 0) + 1
        if depth == 1:
            place = self._places.get(name)
            if place is None:
                place = self._places[name] = self._place(name)
            self._recorder.emit(tick, Kind.SPAN, self._unit, name, 1, place)

    def returned(self, name: str, tick: int) -> None:
        depth = self._depth[name] = self._depth[name] - 1
        if not depth:
            self._recorder.emit(tick, Kind.SPAN, self._unit, name, 0)


Stack = tuple[str, ...]


class FunctionTime(Struct, frozen=True):
    """Time of a function. All times are in ticks.

    calls: the number of calls.
    own: the time in the code of the function itself.
    total: `own`, and the time in functions that it called and in service routines that interrupted it.
    waits: the part of `own` in which the program slept, in IDLE or in a wait whose passes were skipped.
    """

    name: str
    calls: int
    own: int
    total: int
    waits: int


class Profile(CallListener):
    """Profile of an image: the time in each stack of active functions, (outermost, ..., innermost).

    stacks: for each stack, its time in ticks.
    waits: for each stack, the part of its time in which the program slept, in ticks.
    calls: for the name of each function, the number of its calls.
    """

    def __init__(self) -> None:
        self.stacks: Counter[Stack] = Counter()
        self.waits: Counter[Stack] = Counter()
        self.calls: Counter[str] = Counter()
        self._stack: Stack = ()
        self._since = 0

    def called(self, name: str, tick: int) -> None:
        self.count_to(tick)
        self._stack = (*self._stack, name)
        self.calls[name] += 1

    def returned(self, name: str, tick: int) -> None:
        self.count_to(tick)
        self._stack = self._stack[:-1]

    def slept(self, ticks: int) -> None:
        """Add the duration of a sleep to `waits`."""
        self.waits[self._stack] += ticks

    def count_to(self, tick: int) -> None:
        """Add the time since the last call of this method, up to `tick`, to the time of the present stack."""
        if tick > self._since:
            self.stacks[self._stack] += tick - self._since
            self._since = tick

    def functions(self) -> list[FunctionTime]:
        """Return the times of all functions that were called, in descending order of their own time."""
        own, total, waits = (Counter[str]() for _ in range(3))
        for stack, ticks in self.stacks.items():
            if stack:
                own[stack[-1]] += ticks
            for name in set(stack):
                total[name] += ticks
        for stack, ticks in self.waits.items():
            if stack:
                waits[stack[-1]] += ticks
        found = [FunctionTime(name, self.calls[name], own[name], total[name], waits[name]) for name in self.calls]
        return sorted(found, key=lambda one: (-one.own, -one.total, one.name))


MAIN = ("main", "_main")


class VariableRecords(CallListener):
    """Makes FLAG records of `UNIT.memory`, one for each change of a variable by the program or by `PresetMemory`.

    Add it as a listener to calls after `PresetMemory`, if the case sets variables.

    addresses: for each address, the variables that contain the word at this address.
    values: for the name of each variable, its last recorded value, or its initial value before the first record.
    """

    STATE = State("values")

    def __init__(
        self,
        variables: Iterable[Variable],
        ram: Ram,
        recorder: Recorder,
        clock: Clock,
        unit: str,
        place: Callable[[], str | None],
    ) -> None:
        """Read the initial values from memory, where the image must be loaded. place: returns the present statement."""
        self._place = place
        self.addresses: dict[int, list[Variable]] = {}
        self._ram, self._recorder, self._clock = ram, recorder, clock
        self._where = f"{unit}.{MEMORY}"
        self.values: dict[str, int] = {}
        for variable in variables:
            self.values[variable.name] = self._value(variable)
            for address in range(variable.address, variable.address + variable.words):
                self.addresses.setdefault(address, []).append(variable)

    def written(self, address: int, cycle: int) -> None:
        """Record each variable that a write of the word at `address` has changed. address: a key of `addresses`."""
        self._record(self.addresses[address], self._clock.tick(cycle))

    def called(self, name: str, tick: int) -> None:
        """Record, as main begins, each variable that `PresetMemory` has changed."""
        if name in MAIN:
            for variables in self.addresses.values():
                self._record(variables, tick)

    def _record(self, variables: Iterable[Variable], tick: int) -> None:
        """Record those of the variables that have changed since their last records."""
        for variable in variables:
            value = self._value(variable)
            if value != self.values[variable.name]:
                self.values[variable.name] = value
                self._recorder.emit(tick, Kind.FLAG, self._where, variable.name, value, self._place() or "")

    def _value(self, variable: Variable) -> int:
        if variable.words == 1:
            return variable.value_of(self._ram.word(variable.address))
        return variable.value_of(self._ram.word32(variable.address & ~1))


class PresetMemory(CallListener):
    """Stores the initial values that a case sets for variables.

    `put` stores them before the program begins, and again when main begins, because start-up code may overwrite them.
    """

    STATE = State()

    def __init__(self, presets: Iterable[tuple[Variable, int]], put: Callable[[int, int], None]) -> None:
        """presets: variables with the bits of their values. put: stores a word at an address."""
        self._presets = tuple(presets)
        self._put = put

    def put(self) -> None:
        """Store all values word by word, the low word of each variable first."""
        for variable, bits in self._presets:
            for word in range(variable.words):
                self._put(variable.address + word, bits >> 16 * word & 0xFFFF)

    def called(self, name: str, tick: int) -> None:
        if name in MAIN:
            self.put()
