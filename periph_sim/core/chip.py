"""Interface of chip models. Inputs are time, pins and register accesses; outputs are levels, requests and a wake-up.

    pins, read, write, wake  -->  chip  -->  out, requests, held, next_wake, notes

A chip does not depend on the kernel, the wires or files. Its time is the count of its own SYSCLKOUT cycles. Its owner
(`core.socket`, or a test) calls `wake` at `next_wake` and reads the outputs after every input.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from typing import NamedTuple, Protocol

from .registers import RegisterMap
from .state import State

NEVER = 2**62  # a cycle that no run reaches; the sum of NEVER and any cycle of a run still fits 64 bits

# What an input may have changed, for each of these values in turn: nothing that the owner can see; only `next_wake`;
# `next_wake` and `out`; any attribute or register.
NO_CHANGE, WAKE_CHANGED, PINS_CHANGED, ANY_CHANGED = range(4)


class Note(NamedTuple):
    """An observation for the user that is not an error of the simulation.

    code: "duty" if firmware does what the manual forbids, "lost" if data or a request was lost, "unknown" if the
        behaviour of silicon is not known, "overflow" if a result of fixed-point arithmetic does not fit.
    source: the document and section on which the note is based.
    joint: the text of a joint note, or "". All notes with the same code, source and `joint` are reported as one note:
        the text `joint` with a list of their members.
    member: the item that this note adds to the list.
    """

    code: str
    text: str
    source: str
    joint: str = ""
    member: str = ""


def joined(notes: Iterable[tuple[int, Note]]) -> list[tuple[int, Note]]:
    """Return the notes to report, as pairs of a time and a note.

    Equal notes, and notes with the same code, source and `joint` text, become one note at the time of the first.
    """
    found: dict[Note, int] = {}
    members: dict[Note, list[str]] = {}
    for at, note in notes:
        one = Note(note.code, note.joint, note.source) if note.joint else note
        found.setdefault(one, at)
        members.setdefault(one, []).append(note.member)
    texts = {note: f"{note.text}: {', '.join(names)}" if names[0] else note.text for note, names in members.items()}
    return [(at, note._replace(text=texts[note])) for note, at in found.items()]


class WriteOrigins(Protocol):
    """Numbers of records of writes. With them, an edge at an output is traced to the write of the data that is sent.

    mark: the number of the record of the next write. The caller sets it before the write.
    out_mark: the number of the record of the write whose data the outputs carry now; 0 if there is none.
    """

    mark: int
    out_mark: int


class Chip:
    """Base of chips. Times are cycles of the chip's own clock and never decrease from call to call.

    INPUTS: the names of the bits of the input levels, the lowest bit first.
    OUTPUTS: the names of the bits of `out`, the lowest bit first.
    Bit i of `requests` and of `held` represents interrupt number i of the module.
    """

    STATE = State("out held requests loaded writes filter_width", cycles="next_wake", results="writes")
    MAP: RegisterMap
    INPUTS: tuple[str, ...] = ()
    OUTPUTS: tuple[str, ...] = ()
    mid_byte: tuple[int, ...] = ()  # offsets, below 62, of registers whose writes may affect a byte in progress
    steady: tuple[int, ...] = ()  # offsets of register words whose values change only when `writes` increases

    def __init__(self) -> None:
        self.next_wake = NEVER  # no output or readable value changes by itself before this cycle
        self.out = 0  # bit i: level at OUTPUTS[i]; for an open-drain pin 1 means released. A chip has up to 62 outputs
        self.requests = 0  # bit i: 1 if interrupt i was requested after the owner had last cleared this bit
        self.held = 0  # bit i: 1 while the line of interrupt i stays asserted, so that serving it causes a new request
        self.filter_width = 0  # cycles from an input's change to its first effect
        self.notes: list[Note] = []  # the notes since the owner last cleared the list
        self.loaded = 0  # bit i: 1 if the data register at offset i took a value after the owner last cleared this bit
        self.touched: set[str] = set()  # names of the options (open questions) on which the run has depended so far
        # Number of inputs that can change the `steady` words: writes, resets, changes of the clock gate. A chip may
        # leave out writes that have no effect on these words.
        self.writes = 0

    def note(self, code: str, text: str, source: str) -> None:
        """Add a note for the user."""
        self.notes.append(Note(code, text, source))

    def pins(self, now: int, levels: int) -> int:
        """Sample the inputs in cycle `now`; bit i of `levels` is INPUTS[i].

        Return what the owner must update: NO_CHANGE, WAKE_CHANGED, PINS_CHANGED or ANY_CHANGED. If `filter_width` is
        above 0, a second call for the same cycle replaces the levels of the first call.
        """
        raise ValueError(f"{self.MAP.name} has no input pins")

    def wake(self, now: int) -> int:
        """Advance to the cycle `next_wake`. Return what the owner must update, as `pins` does.

        It is not called for a chip without timers, whose `next_wake` is always NEVER.
        """
        return NO_CHANGE

    def next_output(self) -> int:
        """Return a cycle before which `out` changes only if there is an input (pins, access, reset).

        Registers may change earlier. The default is the cycle of the next wake-up.
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
        """Return the value that a CPU read would return, without any side effect; by default the value of `peek`."""
        return self.peek(now, offset)

    def reset(self, now: int) -> None:
        """Set every register to its reset value, as XRS does."""
        raise NotImplementedError

    @property
    def marks(self) -> WriteOrigins | None:
        """The WriteOrigins of a chip that sends written data at its outputs, such as an SCI; None for other chips."""
        return None

    def gate(self, now: int, on: bool) -> None:
        """Switch the module's clock on or off at cycle `now`. Nothing happens in a module without a clock gate."""

    def set_sysclk(self, now: int, hz: Fraction) -> bool:
        """Set SYSCLKOUT to `hz` at cycle `now`. Return True if the behaviour of the chip depends on SYSCLKOUT."""
        return False

    def set_lspclk(self, now: int, divider: int, phase: int) -> None:
        """Set LSPCLK from cycle `now` on. LSPCLK rises in each cycle n with n % divider == phase.

        Nothing happens in a chip that does not run on LSPCLK.
        """
