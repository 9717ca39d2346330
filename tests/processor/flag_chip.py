"""A chip with one status register, whose flags change at given cycles and may request interrupts, and a counter."""

from __future__ import annotations

from periph_sim.core.chip import ANY_CHANGED, NEVER, Chip, Note
from periph_sim.core.registers import Register, RegisterMap, field

STATUS = Register("STATUS", 0, "test", (field("A", "0", "R"), field("B", "1", "R"), field("C", "2", "R/W1C")))
COUNT = Register("COUNT", 1, "test", (field("N", "15:0", "RC"),))
FLAGS = RegisterMap("FLAGS", "test", (STATUS, COUNT))


class FlagChip(Chip):
    """A chip that changes its flags by itself.

    changes: (cycle, new STATUS value, interrupt line to pulse or -1).
    """

    MAP = FLAGS
    INPUTS: tuple[str, ...] = ()
    OUTPUTS: tuple[str, ...] = ()
    filter_width = 0

    def __init__(self, changes: list[tuple[int, int, int]]) -> None:
        self.changes = sorted(changes)
        self.status = 0
        self.count = 0
        self.out = self.requests = self.held = 0
        self.notes: list[Note] = []
        self.touched: set[str] = set()
        self.next_wake = self.changes[0][0] if self.changes else NEVER

    def pins(self, now: int, levels: int) -> int:
        raise AssertionError("no pins")

    def wake(self, now: int) -> int:
        while self.changes and self.changes[0][0] <= now:
            _, self.status, line = self.changes.pop(0)
            self.count += 1
            if line >= 0:
                self.requests |= 1 << line
        self.next_wake = self.changes[0][0] if self.changes else NEVER
        return ANY_CHANGED

    def read(self, now: int, offset: int) -> int:
        self.wake(now)
        if offset == 0:
            return self.status
        count, self.count = self.count, 0
        return count

    def peek(self, now: int, offset: int) -> int:
        return (self.status, self.count)[offset]

    def write(self, now: int, offset: int, value: int) -> None:
        self.wake(now)
        if offset == 0:
            self.status, _ = STATUS.write(self.status, value)

    def reset(self, now: int) -> None:
        self.status = self.count = 0
