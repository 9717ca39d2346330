"""Connection of a chip model to the simulation: passes inputs to it on the chip's clock and publishes the results.

    wire edge, CPU access, wake-up --> chip --> wires, interrupt requests, records

After an input that may have changed the chip's outputs, the socket calls `publish`. After an input that can have
changed only the time of the next wake-up, it calls `_plan`. So no output, request or wake-up is missed.
"""

# core: compiled without checks for None

from __future__ import annotations

from collections.abc import Callable
from typing import final

from .agent import Agent, Event
from .chip import ANY_CHANGED, NEVER, PINS_CHANGED, WAKE_CHANGED, Chip, Note, WriteOrigins
from .flag_recorder import FlagRecorder, WaitingInputs, watched_registers
from .kernel import CHIP, Kernel
from .records import Kind, Recorder
from .sampler import Sampler
from .state import State
from .time import Clock
from .wire import BITS, MAX_PARTIES, Pin

# Tags of the socket's events. An event with the tag WAKE wakes the chip, and one with LOOK samples the chip's inputs.
# An event with any other tag changes an output. The RECORD lowest bits of such a tag are 2 * (output + 1) + level.
# The higher bits are the number of the record that caused the change.
WAKE, LOOK = 0, 1
RECORD = 16
MOVE = (1 << RECORD) - 1
NO_PINS: list[Pin] = []


class PinReleaseGate:
    """Decides whether the pin of a chip's first output is released at once when the chip sets this output to 1."""

    __slots__ = ()

    def holds_back(self) -> bool:
        """Return True if the pin, which is about to be released, stays low for now."""
        raise NotImplementedError


class ChipObserver:
    """An observer that is called after each input that may have changed readable values of a chip."""

    __slots__ = ()

    def look(self, cycle: int) -> None:
        """Handle an input at `cycle` that may have changed readable values of the chip."""
        raise NotImplementedError


@final
class Socket(Agent):
    """Connects one chip to its clock, its wires and its interrupt lines.

    name: the name of the module, for example "I2C-A".
    on_request: callback for interrupt requests, called with the cycle and the mask of interrupts (`Chip.requests`).
    phase: the phase of the kernel in which the chip is woken.
    inputs: the sampler of the levels at the chip's INPUTS.
    """

    STATE = State(
        "chip inputs pins watchers waiting _out _held _flags _note_count _wake",
        cycles="_wake_cycle",
    )

    __slots__ = (
        "_clock",
        "_flags",
        "_held",
        "_kernel",
        "_mid_byte",
        "_note_count",
        "_on_request",
        "_out",
        "_recorder",
        "_wake",
        "_wake_cycle",
        "after",
        "before",
        "chip",
        "inputs",
        "marks",
        "name",
        "notes",
        "on_held",
        "on_note",
        "on_peek",
        "on_watch",
        "out_delay",
        "pins",
        "release",
        "traces",
        "waiting",
        "watchers",
    )

    traces: bool
    _mid_byte: int

    def __init__(
        self,
        kernel: Kernel,
        clock: Clock,
        recorder: Recorder,
        name: str,
        chip: Chip,
        on_request: Callable[[int, int], None],
        phase: int = CHIP,
    ) -> None:
        self.name = name
        self.chip = chip
        self.pins: dict[int, list[Pin]] = {}  # the pins of each output that `connect` has connected
        self.inputs = Sampler(kernel, recorder, self, sum(BITS[: len(chip.INPUTS)]))
        self.marks: WriteOrigins | None = chip.marks
        self.out_delay = 0  # cycles from an output of the chip to its pin
        self.before: Callable[[int], None] | None = None  # called before each CPU access with its cycle
        self.on_peek: Callable[[int, int], int] | None = None  # called with (cycle, offset) in place of `chip.peek`
        self.after: Callable[[int], None] | None = None  # called with the cycle when readable values may have changed
        self.on_held: Callable[[int, int], None] | None = None  # called with (cycle, mask) when `Chip.held` changes
        self._held = 0
        self.release: PinReleaseGate | None = None  # may delay the release of the pins of output 0
        self.watchers: list[ChipObserver] = []
        self.on_watch: Callable[[], None] | None = None  # called when `watchers` has changed
        self.notes: list[tuple[int, Note]] = []
        self.on_note: Callable[[int, Note], None] | None = None  # called with (cycle, note) for each note
        self._note_count: dict[Note, int] = {}
        self._mid_byte = sum(BITS[offset] for offset in chip.mid_byte)
        self._kernel = kernel
        self._clock = clock
        self._recorder = recorder
        self._on_request = on_request
        self._out = chip.out
        self._wake_cycle = NEVER
        self._wake: Event = kernel.event(self, phase)  # the event that wakes the chip in `_wake_cycle`
        self.waiting = WaitingInputs()
        self.traces = recorder.wants(Kind.EDGE) and (recorder.wants(Kind.FLAG) or recorder.wants(Kind.ACCESS))
        registers = watched_registers(chip, recorder, name)
        self._flags: FlagRecorder | None = FlagRecorder(chip, clock, recorder, registers) if registers else None
        if self._flags is not None:
            self._flags.look(clock.cycle_at(kernel.now))

    # Inputs ------------------------------------------------------------------

    def act(self, tag: int) -> None:
        if tag == WAKE:
            self._woken()
        elif tag == LOOK:
            self.inputs.request_sample()
        else:
            recorder = self._recorder
            outer, recorder.cause = recorder.cause, tag >> RECORD
            self._set_pins(((tag & MOVE) >> 1) - 1, tag & 1)
            recorder.cause = outer

    def sampled(self, now: int, levels: int) -> None:
        """Pass the settled levels to the chip, which samples them in the first cycle that begins at or after `now`."""
        cycle = self._clock.cycle_at(now)
        if not self.chip.filter_width:
            begin = self._clock.tick(cycle)
            if begin > now:  # look again when the cycle begins, because the levels may change until then
                self._kernel.schedule(begin, self, LOOK)
                return
        if self.traces:
            self.given(cycle + self.chip.filter_width)
        changed = self.chip.pins(cycle, levels)
        if changed == WAKE_CHANGED:
            if self.chip.next_wake < self._wake_cycle:
                self._plan(cycle)
        elif changed:
            self.publish(cycle, changed)

    def read(self, cycle: int, offset: int) -> int:
        if self.before is not None:
            self.before(cycle)
        if self.traces:
            self.given(cycle)
        value = self.chip.read(cycle, offset)
        self.publish(cycle)
        return value

    def peek(self, cycle: int, offset: int) -> int:
        """Return the value that a debugger reads.

        If a wake-up of the chip is due by `cycle`, the value is that before the wake-up. The wake-up is not run here,
        because the outputs, requests and flags that it changes would be published late or never.
        """
        if self._kernel.shortcut is not None:
            self._kernel.materialize()
        wake = self.chip.next_wake
        seen = cycle if cycle < wake else wake - 1
        return self.chip.peek(seen, offset) if self.on_peek is None else self.on_peek(seen, offset)

    def see(self, cycle: int, offset: int) -> int:
        """Return the value that a CPU read of a register returns, without changing the chip.

        Call it only for registers whose read has no side effect.
        """
        if self.before is not None:
            self.before(cycle)
        return self.chip.see(cycle, offset)

    def write(self, cycle: int, offset: int, value: int) -> None:
        if self._kernel.shortcut is not None and offset < MAX_PARTIES and self._mid_byte >> offset & 1:
            self._kernel.materialize()
        if self.before is not None:
            self.before(cycle)
        if self.traces:
            self.given(cycle)
            if self.marks is not None:
                self.marks.mark = self._recorder.cause
        self.chip.write(cycle, offset, value)
        self.publish(cycle)

    def given(self, cycle: int) -> None:
        """Store `Recorder.cause`, unless it is 0, as the cause of the chip's actions from `cycle` to the next input."""
        self.waiting.add(cycle, self._recorder.cause)

    def _woken(self) -> None:
        cycle, chip = self._wake_cycle, self.chip
        self._wake_cycle = NEVER
        changed = chip.wake(cycle) if chip.next_wake <= cycle else PINS_CHANGED
        if self._flags is None and not self.traces:
            self.publish(cycle, changed)
        else:
            outer, self._recorder.cause = self._recorder.cause, self.waiting.cause_at(cycle)
            self.publish(cycle, changed)
            self._recorder.cause = outer

    # Outputs -----------------------------------------------------------------

    def publish(self, cycle: int, changed: int = ANY_CHANGED) -> None:
        """Update wires, requests, wake-up and records to the state of the chip after an input at `cycle`.

        changed: what can have changed, as `Chip.pins` returns it. Observers are called only for ANY_CHANGED.
        """
        chip = self.chip
        if chip.out != self._out:
            self._drive(cycle)
        if chip.requests or chip.held != self._held:
            self._request(cycle)
        if chip.next_wake < self._wake_cycle:
            self._plan(cycle)
        if changed == ANY_CHANGED:
            self._show(cycle)

    def _request(self, cycle: int) -> None:
        """Pass on the chip's new interrupt requests, and a change of the interrupt lines that it holds asserted."""
        chip = self.chip
        if chip.requests:
            requests, chip.requests = chip.requests, 0
            self._on_request(cycle, requests)
        if chip.held != self._held and self.on_held is not None:
            self._held = chip.held
            self.on_held(cycle, chip.held)

    def _show(self, cycle: int) -> None:
        """Notify observers and record flags and notes, because readable values may have changed."""
        chip = self.chip
        if self.after is not None:
            self.after(cycle)
        watcher: ChipObserver
        for watcher in self.watchers:
            watcher.look(cycle)
        if self._flags is not None:
            self._flags.record(cycle, self.waiting)
        if chip.notes:
            self._take_notes(cycle)

    def _plan(self, cycle: int) -> None:
        if self._wake.queued:
            self._kernel.cancel(self._wake)
        wake = self.chip.next_wake
        if wake < cycle:
            wake = cycle
        self._wake_cycle = wake
        if wake < NEVER:
            tick, now = self._clock.tick(wake), self._kernel.now
            if tick < now:
                tick = now
            self._kernel.reschedule(self._wake, tick, WAKE)

    def _drive(self, cycle: int) -> None:
        recorder = self._recorder
        outer = recorder.cause
        if self.marks is not None:
            recorder.cause = self.marks.out_mark or outer
        moved, out, index = self._out ^ self.chip.out, self.chip.out, 0
        self._out = out
        while moved:
            if moved & 1:
                self._move(cycle, index, out & 1)
            moved >>= 1
            out >>= 1
            index += 1
        recorder.cause = outer

    def _move(self, cycle: int, index: int, level: int) -> None:
        """Set an output to this level from `cycle` on; its pins follow after the delay."""
        tick = self._clock.tick(cycle + self.out_delay)
        if tick <= self._kernel.now:
            self._set_pins(index, level)
        else:  # the pins change later, because the output has a delay or because `cycle` has not begun yet
            self._kernel.schedule(tick, self, self._recorder.cause << RECORD | (index + 1) << 1 | level)

    def _set_pins(self, index: int, level: int) -> None:
        if not index and level and self.release is not None and self.release.holds_back():
            return
        pins: list[Pin] = self.pins.get(index, NO_PINS)
        pin: Pin
        for pin in pins:
            pin.wire.pull(pin.mask, level)

    def shows_output(self) -> bool:
        """Return True if the chip's present outputs were passed on to the pins, which take them after `out_delay`."""
        return self._out == self.chip.out

    def accept_output(self) -> None:
        """Treat the chip's present outputs as passed on to the pins. The caller sets the levels of the wires."""
        self._out = self.chip.out

    def present_cause(self) -> int:
        """Return the number of the record whose effects the simulation runs now."""
        return self._recorder.cause

    def repeat_release(self, cause: int) -> None:
        """Release the pins of output 0, which a PinReleaseGate has kept low, as an effect of the record `cause`."""
        self.act(cause << RECORD | 0b11)

    def watch(self, watcher: ChipObserver) -> None:
        """Call `watcher.look` after each input that may have changed readable values, as a polling CPU needs."""
        self._have_watch([*self.watchers, watcher] if self.watchers else [watcher])

    def unwatch(self, watcher: ChipObserver) -> None:
        self._have_watch([one for one in self.watchers if one is not watcher])

    def _have_watch(self, watchers: list[ChipObserver]) -> None:
        self.watchers = watchers  # a new list, because a watcher that is being called may use `watch` or `unwatch`
        if self.on_watch is not None:
            self.on_watch()

    def reclock(self) -> None:
        """Move the wake-up to the new tick of its cycle, after the clock was retuned."""
        if self._wake_cycle != NEVER:
            self._wake_cycle = NEVER
            self._plan(self._clock.cycle_at(self._kernel.now))

    def connect(self, index: int, pins: list[Pin]) -> None:
        """Make output `index` drive exactly `pins`. Other pins that this output drove before are released."""
        for pin in self.pins.get(index, NO_PINS):
            if pin not in pins:
                pin.drive(1)
        self.pins[index] = pins
        for pin in pins:
            pin.drive(self._out >> index & 1)

    def _take_notes(self, cycle: int) -> None:
        notes = tuple(self.chip.notes)
        self.chip.notes.clear()
        tick = self._clock.tick(cycle)
        for note in notes:
            seen = self._note_count.get(note, 0)
            self._note_count[note] = seen + 1
            if not seen:
                self.notes.append((tick, note))
            if self._recorder.wants(Kind.NOTE):
                self._recorder.emit(tick, Kind.NOTE, self.name, note.code, seen + 1, f"{note.text} [{note.source}]")
            if self.on_note is not None:
                self.on_note(cycle, note)
