"""What a pure chip looks like from outside: time, pins and register accesses in; levels, requests and a wake-up out.

    pins, read, write, wake  -->  chip  -->  out, requests, held, next_wake, notes

A chip knows no kernel, no wire, no file and no fidelity. Its time is the count of its
own SYSCLKOUT cycles. Whoever owns it (`core.socket`, or a test) calls `wake` when
`next_wake` has come, and looks at the outputs after every input.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

from .registers import RegisterMap
from .state import State

if TYPE_CHECKING:
    from .chip_input import WriteOrigins

NEVER = 2**62  # a wake-up that no run reaches; compares and adds like any other

# What an input may have changed: nothing that shows; `next_wake` alone; it and `out`; any of the chip's attributes
# and registers.
NO_CHANGE, WAKE_CHANGED, PINS_CHANGED, ANY_CHANGED = range(4)


class Note(NamedTuple):
    """Something worth telling that is no fault of the simulation.

    code: "duty" where firmware does what the manual forbids, "lost" where data or a
    request went missing, "unknown" where the model cannot know what silicon does,
    "overflow" where a result of fixed-point arithmetic does not fit.
    joint, member: notes that share the first are one for people, with a list of the second.
    """

    code: str
    text: str
    source: str
    joint: str = ""
    member: str = ""


def joined(notes: Iterable[tuple[int, Note]]) -> list[tuple[int, Note]]:
    """Notes for people, each with its time: of those that have a `joint` in common one, which lists their members."""
    found: dict[Note, int] = {}
    members: dict[Note, list[str]] = {}
    for at, note in notes:
        one = Note(note.code, note.joint, note.source) if note.joint else note
        found.setdefault(one, at)
        members.setdefault(one, []).append(note.member)
    told = {note: f"{note.text}: {', '.join(of)}" if of[0] else note.text for note, of in members.items()}
    return [(at, note._replace(text=told[note])) for note, at in found.items()]


class Chip:
    """Times are cycles of the chip's own clock, never falling from call to call.

    INPUTS, OUTPUTS, LINES name the bits of pin indices, `out`, and `requests`/`held`.
    """

    STATE = State("out held requests loaded writes filter_width", cycles="next_wake")
    MAP: RegisterMap
    INPUTS: tuple[str, ...]
    OUTPUTS: tuple[str, ...]
    LINES: tuple[str, ...]

    next_wake: int  # at the latest when an output or a readable value may change by itself
    out: int  # bit i: level at OUTPUTS[i], of up to 62; for an open-drain pin 1 means released
    requests: int  # bit i: LINES[i] asked for an interrupt since the owner last set this to 0
    held: int  # bit i: LINES[i] is held asserted (asks again as soon as it was served)
    filter_width: int  # cycles from an input's change to its first effect
    notes: list[Note]  # since the owner last cleared it
    loaded: int  # of one with data registers: bit i: that at offset i took a value since the owner last set this to 0
    touched: set[str]  # open questions on whose option the run depended
    mid_byte: tuple[int, ...] = ()  # registers, below 62, a write to which may change a byte in the middle
    steady: tuple[int, ...] = ()  # words of registers that stay as they are seen while `writes` is the same
    writes: int  # counts what may change those: writes, resets, the clock gate

    def pins(self, now: int, levels: int) -> int:
        """The inputs as sampled in cycle `now`; bit i is INPUTS[i]. Returns what the owner must look at:
        NO_CHANGE, WAKE_CHANGED, PINS_CHANGED or ANY_CHANGED. Where `filter_width` is above 0 a later call for the
        same cycle takes the place of the first.
        """
        raise NotImplementedError

    def wake(self, now: int) -> int:
        """`next_wake` has come. Returns what the owner must look at."""
        raise NotImplementedError

    def next_output(self) -> int:
        """Before this cycle `out` does not move without an input (pins, access, reset); other than `next_wake` it tells
        nothing of registers. Where a chip does not say: with any wake-up.
        """
        return self.next_wake

    def read(self, now: int, offset: int) -> int:
        """What the CPU reads, with all that a read sets off."""
        raise NotImplementedError

    def write(self, now: int, offset: int, value: int) -> None:
        """The CPU writes a whole word."""
        raise NotImplementedError

    def peek(self, now: int, offset: int) -> int:
        """What a debugger reads: the register's value without any side effect."""
        raise NotImplementedError

    def see(self, now: int, offset: int) -> int:
        """What the CPU reads of a register whose read has no side effect: `peek`, where the chip answers the CPU."""
        return self.peek(now, offset)

    def reset(self, now: int) -> None:
        """XRS: every register takes its reset value."""
        raise NotImplementedError

    @property
    def marks(self) -> WriteOrigins | None:
        """Marks of what was written, of a chip whose outputs show later what was written to it."""
        return None

    def gate(self, now: int, on: bool) -> None:
        """The module's clock is on or off from cycle `now` on, if it has a gate."""

    def set_sysclk(self, now: int, hz: Fraction) -> bool:
        """SYSCLKOUT is `hz` from cycle `now` on. Return True if the chip depends on it."""
        return False

    def set_lspclk(self, now: int, divider: int, phase: int) -> None:
        """LSPCLK rises in each cycle that is `phase` modulo `divider`, of a chip that runs on it."""
