"""One C28x as it executes: memory and registers before go in; after one pass of one instruction they come out.

    fetch --decode, kept by address--> Operation --begin: operand found--> ea --finish: executed--> registers, memory
                                                       ^--- whoever has a bus waits here for its cycle

RPT makes the next instruction several passes with no boundary between them; RPTB takes the program back at a block's
end. What is written over code is decoded anew. Source: SPRU430F chapters 4 and 6 (RPT), SPRUEO2A (RPTB).
"""

# core: compiled

from __future__ import annotations

from typing import Annotated

from ...form.c_types import UInt8
from ..decoder import decode_at, other_unit
from .control import RA, RC, RE, RSIZE
from .operations import operation
from .registers import CODE, Cpu, IllegalOperation, Operation

PAGE = 8  # bits of an address within a page of decoded instructions
GONE = -1  # no place
PAGES, PAGE_SIZE, IN_PAGE = CODE + 1 >> PAGE, 1 << PAGE, (1 << PAGE) - 1


class Engine(Cpu):
    """Executes instructions.

    left: passes that RPT still wants of the instruction at `pc`; 0 between instructions.
    keeps_decoded: an instruction is decoded once, and again after its words were written; else each time.
    """

    _code: Annotated[list[UInt8], PAGES]

    def __init__(self) -> None:
        super().__init__()
        self.left = 0
        self.keeps_decoded = True
        self._decoded: list[list[Operation | None] | None] = [None] * PAGES
        self._code = [0] * PAGES  # 1 where something of the page has been decoded

    def step(self) -> int:
        """Execute one instruction, or one pass of a repeated one. Its cycles by the manual's table."""
        f = self.fetch()
        self.begin(f)
        return self.finish(f)

    def fetch(self) -> Operation:
        """Return the instruction that `pc` points at. IllegalOperation where there is none."""
        page = self._decoded[self.pc >> PAGE]
        if page is not None and self.keeps_decoded:
            found = page[self.pc & IN_PAGE]
            if found is not None:
                return found
        return self._decode()

    def after(self, f: Operation) -> Operation:
        """Return the instruction that `pc` points at, now that f is executed."""
        if not self.keeps_decoded:
            return self.fetch()
        found = f.following
        if found is not None and found.place == self.pc:
            return found
        found = f.goal
        if found is not None and found.place == self.pc:
            return found
        found = self.fetch()
        if self.pc == f.next:
            f.following = found
        else:
            f.goal = found
        return found

    def begin(self, f: Operation) -> None:
        """Find its operand, with what the operand's mode does to address registers."""
        if f.l >= 0:
            self.locate(f)

    def finish(self, f: Operation) -> int:
        """Execute it, now that its operand is found; then `pc` is the next instruction's, or still its own."""
        repeated = self.left
        self.pc, self.cycles = f.next, f.cycles
        self.written_in = 1 if f.at_once or self.passes else f.cycles
        f.execute(self, f)
        if repeated:
            return self._pass_done(f)
        if self.repeat >= 0:
            self._repeat()
        elif self.rb & RA and self.pc == f.next:
            self._at_end_of_block(f)
        return self.cycles

    def _pass_done(self, f: Operation) -> int:
        """A pass costs a cycle; the first one of a repeatable instruction what N + 1 passes cost beside N, too."""
        cycles = 1 if self.passes else f.repeated or self.cycles
        self.left -= 1
        if self.left:
            self.passes += 1
            self.pc = f.address
        else:
            self.passes = 0
            if self.rb & RA:
                self._at_end_of_block(f)
        return cycles

    def _repeat(self) -> None:
        """RPT: the next instruction has so many passes; one that cannot be repeated has one."""
        count, self.repeat = self.repeat, -1
        self.left = count + 1 if self.fetch().repeated else 1

    def _at_end_of_block(self, f: Operation) -> None:
        """Behind the last instruction of a block that RPTB repeats: back to its first one."""
        if f.next - 1 & 0x7F != self.rb >> RE & 0x7F:
            return
        self.pc = f.next - (self.rb >> RSIZE & 0x7F) & CODE
        self.rb -= 1
        if not self.rb & RC:
            self.rb &= ~RA

    def _decode(self) -> Operation:
        first, second = self.program16(self.pc), self.program16(self.pc + 1)
        found = decode_at(self.pc, first, second)
        if found is None:
            other = other_unit(first)
            raise IllegalOperation(
                f"{first:#06x} {second:#06x} is no instruction of the F28335{f', but of {other}' if other else ''}"
            )
        page = self._decoded[self.pc >> PAGE]
        if page is None:
            page = self._decoded[self.pc >> PAGE] = [None] * PAGE_SIZE
        self._code[self.pc >> PAGE] = self._code[(self.pc + 1 & CODE) >> PAGE] = 1
        made = page[self.pc & IN_PAGE] = operation(found)
        return made

    def written(self, address: int) -> None:
        """A word of memory has changed: what was decoded of it is forgotten."""
        if 0 <= address <= CODE and self._code[address >> PAGE]:
            self._forget(address)
            if address:
                self._forget(address - 1)

    def _forget(self, address: int) -> None:
        page = self._decoded[address >> PAGE]
        if page is not None:
            found: Operation | None = page[address & IN_PAGE]
            if found is not None:
                found.place = GONE
                page[address & IN_PAGE] = None
