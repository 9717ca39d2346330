"""Interface of chip models. Inputs are time, pins and register accesses; outputs are levels, requests and a wake-up.

    pins, read, write, wake  -->  chip  -->  out, requests, held, next_wake, notes

A chip does not depend on the kernel, wires, files or the fidelity of the scene. Its time is the count of its own
SYSCLKOUT cycles. Its owner (`core.socket`, or a test) calls `wake` at `next_wake` and reads the outputs after every
input.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from typing import NamedTuple, Protocol

from .registers import RegisterMap
from .state import State

NEVER = 2**62  # a cycle that no run reaches; sums and comparisons with it are valid

# Possible effects of an input: nothing visible; only `next_wake`; `next_wake` and `out`; any attribute or register.
NO_CHANGE, WAKE_CHANGED, PINS_CHANGED, ANY_CHANGED = range(4)


class Note(NamedTuple):
    """An observation for the user that is not an error of the simulation.

    code: "duty" if firmware does what the manual forbids, "lost" if data or a request was lost, "unknown" if the
        behaviour of silicon is not known, "overflow" if a result of fixed-point arithmetic does not fit.
    joint, member: notes with the same `joint` text are reported as one, with a list of their members.
    """

    code: str
    text: str
    source: str
    joint: str = ""
    member: str = ""


def joined(notes: Iterable[tuple[int, Note]]) -> list[tuple[int, Note]]:
    """Return the notes to report, each with its time. Notes with the same `joint` text become one."""
    found: dict[Note, int] = {}
    members: dict[Note, list[str]] = {}
    for at, note in notes:
        one = Note(note.code, note.joint, note.source) if note.joint else note
        found.setdefault(one, at)
        members.setdefault(one, []).append(note.member)
    texts = {note: f"{note.text}: {', '.join(names)}" if names[0] else note.text for note, names in members.items()}
    return [(at, note._replace(text=texts[note])) for note, at in found.items()]


class WriteOrigins(Protocol):
    """Origins of writes to a chip, as numbers of records.

    mark: the record of the next write.
    out_mark: the record of the write that the outputs show now; 0 for none.
    """

    mark: int
    out_mark: int


class Chip:
    """Base of chips. Times are cycles of the chip's own clock and never decrease from call to call.

    INPUTS and OUTPUTS name the bits of the input levels and of `out`. The bits of `requests` and `held` are the
    interrupts in the module's descriptor, in order.
    """

    STATE = State("out held requests loaded writes filter_width", cycles="next_wake")
    MAP: RegisterMap
    INPUTS: tuple[str, ...] = ()
    OUTPUTS: tuple[str, ...] = ()
    mid_byte: tuple[int, ...] = ()  # offsets, below 62, of registers whose writes may affect a byte in progress
    steady: tuple[int, ...] = ()  # offsets of register words whose values change only when `writes` is increased

    def __init__(self) -> None:
        self.next_wake = NEVER  # no output or readable value changes by itself before this cycle
        self.out = 0  # bit i: level at OUTPUTS[i], of up to 62; for an open-drain pin 1 means released
        self.requests = 0  # bit i: interrupt i was requested since the owner last cleared it
        self.held = 0  # bit i: the line of interrupt i is held asserted, so it requests again when it was served
        self.filter_width = 0  # cycles from an input's change to its first effect
        self.notes: list[Note] = []  # the notes since the owner last cleared the list
        self.loaded = 0  # bit i: the data register at offset i took a value since the owner last cleared it
        self.touched: set[str] = set()  # names of the open questions on which the run depended
        self.writes = 0  # number of writes, resets and changes of the clock gate; only they change words in `steady`

    def note(self, code: str, text: str, source: str) -> None:
        """Add a note for the user."""
        self.notes.append(Note(code, text, source))

    def pins(self, now: int, levels: int) -> int:
        """Sample the inputs in cycle `now`; bit i of `levels` is INPUTS[i].

        Return the effects that the owner must handle: NO_CHANGE, WAKE_CHANGED, PINS_CHANGED or ANY_CHANGED. If
        `filter_width` is above 0, a later call for the same cycle replaces the first.
        """
        raise ValueError(f"{self.MAP.name} has no input pins")

    def wake(self, now: int) -> int:
        """Advance to `next_wake`, which is NEVER in a chip without timers. Return the effects, as `pins` does."""
        return NO_CHANGE

    def next_output(self) -> int:
        """Return a cycle before which `out` does not change without an input (pins, access, reset).

        Registers may change earlier. By default it is the next wake-up.
        """
        return self.next_wake

    def read(self, now: int, offset: int) -> int:
        """Return the value that the CPU reads, and apply the side effects of the read; by default there are none."""
        return self.peek(now, offset)

    def write(self, now: int, offset: int, value: int) -> None:
        """Write a whole word, as the CPU does."""
        raise NotImplementedError

    def peek(self, now: int, offset: int) -> int:
        """Return the value of a register without any side effect, as a debugger reads it."""
        raise NotImplementedError

    def see(self, now: int, offset: int) -> int:
        """Return the value that a CPU read would return, without its side effects; by default that of `peek`."""
        return self.peek(now, offset)

    def reset(self, now: int) -> None:
        """Set every register to its reset value, as XRS does."""
        raise NotImplementedError

    @property
    def marks(self) -> WriteOrigins | None:
        """The origins of writes, in chips whose outputs show written data later; None in others."""
        return None

    def gate(self, now: int, on: bool) -> None:
        """Switch the module's clock on or off from cycle `now` on, if it has a gate."""

    def set_sysclk(self, now: int, hz: Fraction) -> bool:
        """Set SYSCLKOUT to `hz` from cycle `now` on. Return True if the chip depends on it."""
        return False

    def set_lspclk(self, now: int, divider: int, phase: int) -> None:
        """Set the LSPCLK of a chip that runs on it. LSPCLK rises in each cycle n with n % divider == phase."""
