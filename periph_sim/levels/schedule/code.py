"""Straight-line code with at most one interrupt in it: accesses go in; when it is where, by the interrupt's cycle, out.

    flag read            access, access ...                       first read of the next wait
    e    |--SB not taken--|--between--|wait states|1|-- ... --------|wait states| e + length
         ^1               ^5          ^..                ^ instruction boundaries: an interrupt is taken at the first
                                                           one at or after its latch, and takes `service` cycles

    write   posted after the wait states, lands `write_lands` later; reads of the protected block wait for it
    field   waits, reads, is posted in the same cycle

The rules are those of `processor.bus` and `processor.python`; that they give the cycles of the run that the accesses
were recorded in is checked (`Code.of`). Sources: there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...f28335.cpu import instruction_costs as cpu_costs
from ...f28335.cpu.compiled_code_costs import CodeCosts
from ...f28335.descriptor import Frame
from ...f28335.system.memory_map import WRITE_TO_READ, WaitStates
from ...f28335.system.options import SystemOptions

FRAMES = {"I2C-A": Frame.PF2, "GPIO": Frame.PF1}  # both in the protected block
FAR = 1 << 60


@dataclass(frozen=True)
class Access:
    """way: "R", "W" or "M", a read-modify-write of a field. register: "I2C-A.I2CMDR". at: cycle of read or landing."""

    way: str
    register: str
    field: str = ""
    at: int = 0


@dataclass(frozen=True)
class CodeTiming:
    """What the code of a unit pays. service: cycles that an interrupt takes, entry and IRET in them."""

    costs: CodeCosts
    options: SystemOptions
    service: int

    @property
    def read_waits(self) -> int:
        """Wait states of a read of the I2C: within them no interrupt is taken."""
        return self.options.pf2_read_ws.unrecorded()


@dataclass(frozen=True)
class Path:
    """Cycles from the begin. marks: of each access, in order: of its read, and of its landing; length: of it all."""

    reads: tuple[int, ...]
    lands: tuple[int, ...]
    length: int


class _Run:
    """One run through the code. latch: the cycle at which an interrupt reaches the IFR."""

    def __init__(self, timing: CodeTiming, latch: int) -> None:
        self._timing, self._latch = timing, latch
        self._waits = WaitStates(timing.options)
        self._free = -FAR
        self._last_pf1 = -FAR
        self.cycle = 0

    def boundary(self) -> None:
        if self._latch <= self.cycle:
            self.cycle, self._latch = self.cycle + self._timing.service, FAR

    def instruction(self, cycles: int) -> None:
        self.cycle += cycles
        self.boundary()

    def access(self, access: Access) -> tuple[int, int]:
        """Its cycle of reading, and of landing; FAR where it does not."""
        for _ in range(self._timing.costs.between_accesses):
            self.instruction(1)
        frame = FRAMES[access.register.partition(".")[0]]
        if access.way == "W":
            pair = frame is Frame.PF1 and self._last_pf1 == self.cycle - 1
            self.cycle += self._waits.write[frame] + (self._waits.pf1_after_pf1 if pair else 0)
        else:
            self.first_read(self._waits.read[frame])
        at = self.cycle
        lands = FAR
        if access.way != "R":
            lands = at + self._timing.options.write_lands.unrecorded()
            self._free = max(at + 1 + WRITE_TO_READ, lands + 1)
            self._last_pf1 = at if frame is Frame.PF1 else self._last_pf1
        self.instruction(1)
        return (FAR if access.way == "W" else at), lands

    def first_read(self, waits: int) -> None:
        self.cycle = max(self.cycle, self._free) + waits


@dataclass(frozen=True)
class Code:
    """behind_wait: it follows a read that ended a wait, at cycle 0; else it begins at a boundary, 0.

    into_wait: it ends with the first read of a wait; else at a boundary.
    """

    accesses: tuple[Access, ...]
    timing: CodeTiming
    behind_wait: bool = True
    into_wait: bool = True

    def path(self, latch: int = FAR) -> Path:
        """latch: of an interrupt, in cycles from the begin."""
        run = _Run(self.timing, latch)
        if self.behind_wait:
            run.instruction(1)
            run.instruction(cpu_costs.SB_NOT_TAKEN)
        marks = [run.access(access) for access in self.accesses]
        if self.into_wait:
            run.first_read(self.timing.read_waits)
        return Path(tuple(at for at, _ in marks), tuple(lands for _, lands in marks), run.cycle)

    def differs(self, begin: int, end: int) -> str:
        """Where the rules give other cycles than the run that the accesses were recorded in; empty if nowhere."""
        path = self.path()
        if path.length != end - begin:
            return f"takes {end - begin} cycles where its accesses make {path.length}"
        for access, at, lands in zip(self.accesses, path.reads, path.lands, strict=True):
            if begin + (at if access.way == "R" else lands) != access.at:
                return f"accesses {access.register} at another cycle than its accesses make"
        return ""


def accesses_in(records: Sequence[tuple[int, str, str]], begin: int, end: int, lands: int) -> tuple[Access, ...]:
    """What is issued between two cycles. records: cycle, "R I2C-A.I2CSTR", field; of a write when it landed.

    A read and a write of one field that was posted in its cycle are one instruction.
    """
    found: list[tuple[int, Access]] = []
    for at, what, field in records:
        way, _, register = what.partition(" ")
        issued = at - lands if way == "W" else at
        if not begin <= issued < end or (way == "R" and issued == begin):  # there the wait before ended
            continue
        if way == "W":
            read = Access("R", register, field, issued)
            if field and (issued, read) in found:
                found.remove((issued, read))
                found.append((issued, Access("M", register, field, at)))
                continue
        found.append((issued, Access(way, register, field, at)))
    return tuple(access for _, access in sorted(found, key=lambda one: one[0]))


class CodeTable:
    """A code's path for each cycle in which an interrupt may be latched, as arrays to be indexed.

    length: without one. first, last: the latches, in cycles from the begin, that meet this code; a later one finds no
    boundary any more, as where the first read of the next wait waits for a write. lengths: of the path
    by latch less `first`. marks: of what the reader names: without an interrupt, and by latch.
    """

    def __init__(self, code: Code, marks: Sequence[tuple[str, int]] = ()) -> None:
        """marks: ("read" or "lands", number of the access)."""
        waits = code.timing.read_waits
        calm = code.path()
        self.length = calm.length
        self.first = 1 - waits if code.behind_wait else 1
        boundaries = range(self.length - waits if code.into_wait else self.length, self.first - 1, -1)
        self.last = next(latch for latch in boundaries if code.path(latch).length != self.length)
        paths = [code.path(latch) for latch in range(self.first, self.last + 1)]
        self.lengths = np.array([path.length for path in paths], np.int64)
        self.marks: list[tuple[int, NDArray[np.int64]]] = [
            (_mark(calm, which, place), np.array([_mark(path, which, place) for path in paths], np.int64))
            for which, place in marks
        ]


def _mark(path: Path, which: str, place: int) -> int:
    return (path.reads if which == "read" else path.lands)[place]
