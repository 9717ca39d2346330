"""Execute C28x instructions, one pass of one instruction at a time.

    fetch --> Operation --begin: operand found--> ea --finish: executed--> registers, memory
                                                  ^--- a chip with a bus waits here for the cycle of the access

A decoded instruction is kept until its words are overwritten, unless `keeps_decoded` is False. RPT makes the CPU
execute the next instruction several times; one execution is a pass, and no interrupt is taken between passes. RPTB
makes the CPU jump back at the end of a block. Source: SPRU430F chapters 4 and 6 (RPT), SPRUEO2A (RPTB).
"""

# core: compiled

from __future__ import annotations

from typing import Annotated

from ....core.state import State
from ....form.c_types import UInt8
from ..decoder import decode_at, other_unit
from .control import RA, RC, RE, RSIZE
from .cpu import Cpu, Operation
from .operations import operation
from .registers import CODE, IllegalOperation

PAGE = 8  # a page of decoded instructions covers 2 ** PAGE addresses
GONE = -1  # value of `Operation.place` after the words were overwritten
PAGES, PAGE_SIZE, IN_PAGE = CODE + 1 >> PAGE, 1 << PAGE, (1 << PAGE) - 1


class Engine(Cpu):
    """A CPU that executes instructions.

    left: the number of passes that remain for the instruction at `pc` after RPT; 0 if no repetition is in progress.
    keeps_decoded: True if a decoded instruction is kept until its words are overwritten; False if each execution
        decodes the words again.
    """

    STATE = State("left")

    _code: Annotated[list[UInt8], PAGES]

    def __init__(self) -> None:
        super().__init__()
        self.left = 0
        self.keeps_decoded = True
        self._decoded: list[list[Operation | None] | None] = [None] * PAGES
        self._code = [0] * PAGES  # for each page: 1 if it has decoded instructions

    def step(self) -> int:
        """Execute one instruction, or one pass of a repeated instruction. Return the cycles of the manual's table."""
        f = self.fetch()
        self.begin(f)
        return self.finish(f)

    def fetch(self) -> Operation:
        """Return the instruction at `pc`. Raise IllegalOperation if there is none."""
        page = self._decoded[self.pc >> PAGE]
        if page is not None and self.keeps_decoded:
            found = page[self.pc & IN_PAGE]
            if found is not None:
                return found
        return self._decode()

    def after(self, f: Operation) -> Operation:
        """Return the instruction at `pc` after f was executed.

        The results for the next address, and for the last jump, are kept in f, so that later calls are fast.
        """
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
        """Find the address of the operand, and apply its addressing mode to registers, for example increment XARn."""
        if f.l >= 0:
            self.locate(f)

    def finish(self, f: Operation) -> int:
        """Execute the instruction, for which `begin` was called, and return its cycles.

        Afterwards, `pc` is the address of the next instruction. While passes of RPT remain, `pc` does not change.
        """
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
        """Complete a pass after RPT, and return its cycles.

        The first of N + 1 passes takes the cycles of all passes minus N, and each further pass takes 1 cycle.
        """
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
        """Set the number of passes of the instruction after RPT; 1 if that instruction cannot be repeated."""
        count, self.repeat = self.repeat, -1
        self.left = count + 1 if self.fetch().repeated else 1

    def _at_end_of_block(self, f: Operation) -> None:
        """Jump to the first instruction of an RPTB block if f is the last one of the block."""
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
                f"{first:#06x} {second:#06x} is not an instruction of the F28335{f', but of {other}' if other else ''}"
            )
        page = self._decoded[self.pc >> PAGE]
        if page is None:
            page = self._decoded[self.pc >> PAGE] = [None] * PAGE_SIZE
        self._code[self.pc >> PAGE] = self._code[(self.pc + 1 & CODE) >> PAGE] = 1
        made = page[self.pc & IN_PAGE] = operation(found)
        return made

    def written(self, address: int) -> None:
        """Discard the decoded instructions that contain the memory word at this address, which has changed."""
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
