"""A firmware image as a program. It runs until it must wait, sleeps or ends.

    Processor --run--> ImageProgram: begin (operand found) --reach (cycle of the access)--> finish --> next instruction
                          ^--- stops if something else may act before that cycle; the instruction is kept in `_ready`

The cycles of an instruction are those of the manual's table, those that `instruction_timing` adds, the wait states of
registers, and the waits for earlier writes on the bus.

Source: SPRU430F chapters 3 and 4.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ...core.chip import NEVER
from ...core.state import State
from ...core.time import Clock
from ...f28335.cpu import code_costs as cpu_costs
from ...f28335.system_options import SystemOptions
from ...form.c_types import Text
from ..c28x.encodings import SP_FIELD
from ..c28x.execution.cpu import WRITES, Operation
from ..c28x.execution.registers import IllegalOperation
from ..image_files.model import Image
from ..polling import Spin
from ..processor import Awaited, Processor
from ..user_code import FirmwareLost, InterruptFault
from .counting_loop import CountingLoop
from .cpu import ImageCpu
from .loaded_image import LAST_JUMPS, LoadedImage, UnmodelledWait
from .polls import FEWEST


class ImageProgram(LoadedImage):
    """A program that executes an image.

    instructions: the number of executed instructions, including those of skipped passes. After RPT, each pass counts.
    skipped: the number of instructions of skipped passes.
    """

    STATE = State(
        "instructions skipped _ready _executed _idle_began _loop_due _counted _pass _unmodelled _counting _back _sp",
        ticks="_asleep_at",
        results="instructions skipped spin _counted _pass _asleep_at",
    )

    _stack_begin: int
    _stack_end: int

    def __init__(
        self,
        processor: Processor,
        clock: Clock,
        image: Image,
        entry: int,
        options: SystemOptions,
        skip_polls: bool,
        keeps_decoded: bool = True,
    ) -> None:
        """entry: the address at which execution begins.

        skip_polls: True to skip passes of a wait that would repeat the previous pass.
        keeps_decoded: True if each instruction is decoded once, False if it is decoded at each execution.
        """
        super().__init__(processor, clock, image, entry, ImageCpu(processor, options, skip_polls, keeps_decoded))
        self.instructions = self.skipped = 0
        self._ready: Operation | None = None  # the pending instruction, whose operand address is known
        self._executed = False  # True if an instruction was executed since the last start, interrupt or IRET
        self._idle_began = False
        self._asleep_at = 0  # the tick at which the last sleep began
        self._loop_due = False  # True at the start of a pass of a loop that should be examined
        self._back = -1  # the address of the branch that closed the last executed pass of a wait; -1 for none
        # _counted: the value of `instructions` at the last call of `_sleeps`, which is at the start of a pass.
        # _pass: the number of instructions in each pass of the present wait.
        self._counted = self._pass = 0
        self._unmodelled: UnmodelledWait | None = None  # the last wait that read only unmodelled words
        self._counting: CountingLoop | None = None  # set while a pass is traced, or passes that count are skipped
        self._stack_begin, self._stack_end = image.stack
        self._sp = 0  # SP after the last instruction

    def begin(self) -> None:
        """Start the program: set PC to the entry, and the other registers as the boot ROM's program leaves them.

        Memory keeps its contents.
        """
        self.cpu.reset()
        self.cpu.pc = self._entry
        self._sp = self.cpu.sp
        self.returned_at = None
        self._ready = None
        self._executed = self._idle_began = self._loop_due = False
        self.spin = self._counting = self._unmodelled = None
        self._at = self._entry
        if self._calls is not None:
            self._calls.began(self._entry, self._processor.time.cycle)

    def kill(self) -> None:
        """End the program, and its sleep if it sleeps, so that a later reset of registers does not wake it."""
        LoadedImage.kill(self)
        time = self._processor.time
        now = self._clock.cycle_at(time.instant()[1])
        polls, loop = self.cpu.polls, self._counting
        if polls.asleep:
            self._woken(min(now, time.wakes))
            if loop is not None and polls.skips:
                loop.cut_off(now - time.cycle)
        elif self._idle_began:
            self._record_wait(now, 0)
        polls.forget()

    # Execution ----------------------------------------------------------------------

    def run(self) -> None:
        """Execute instructions until the program must stop."""
        try:
            self._run()
        except (IllegalOperation, InterruptFault) as error:
            self._processor.time.meet()  # sets the kernel's time to the instant at which the run ends
            raise FirmwareLost(self.error_text(str(error).removeprefix(f"{self._processor.name}: "))) from None

    def _run(self) -> None:
        cpu, time, processor = self.cpu, self._processor.time, self._processor
        core, timing, polls = processor.core, cpu.timing, cpu.polls
        pipeline = timing.pipeline
        if polls.asleep and polls.skips:
            self._woken(time.cycle)
        if cpu.ended:
            self._end()
            return
        f: Operation | None = None  # the last instruction that was begun in this call
        while True:
            if self._ready is not None:
                f, self._ready = self._ready, None
            else:
                if time.watching:
                    self._follow_wait()
                if self._loop_due:
                    self._loop_due = False
                    if self._sleeps() and polls.skips:
                        return
                if cpu.idling:
                    if not self._slept():
                        return
                    if core.ready > time.cycle and not processor.reach(core.ready):
                        return
                    continue
                if not cpu.left and (core.ifr or core.next_wake <= time.cycle or core.owes_instruction):
                    if self._executed and core.owes_instruction:
                        core.owes_instruction = False
                    number = core.next_taken(time.cycle)
                    if number:
                        cpu.hand_over()
                        if not processor.take_interrupt(number):
                            return
                        continue
                self._at = cpu.pc
                f = cpu.fetch() if f is None else cpu.after(f)
                at = time.cycle
                if f.waited or pipeline.pending:
                    at += timing.stall(f, cpu, at)
                cpu.begin(f)
                if f.accesses or f.absolute:
                    at = cpu.access_at(f, at)
                if at != time.cycle:
                    if at >= time.lease and not processor.reach(at):
                        self._ready = f
                        return
                    time.cycle = at
            cycles = cpu.finish(f)
            pipeline.issued(f, cycles)
            cycle = time.cycle + cycles
            if timing.conflicts and f.block <= cpu.ea < f.block_end:
                timing.conflict()
            if timing.late:
                cycle += timing.late
                timing.late = 0
            self.instructions += 1
            self._executed = True
            if cpu.pc != f.next:
                if f.jumps:
                    if cpu.pc & 1:
                        cycle += timing.landing(cpu.after(f))
                    if f.loops and cpu.pc <= f.address:
                        if time.watching:
                            self._back = f.address
                        else:
                            self._loop_due = polls.again(f.address, cycle)
                self._jumps[self._jumped & LAST_JUMPS - 1] = f.address
                self._jumped += 1
                if self._calls is not None:
                    if not f.loops:
                        polls.soil()
                    self._calls.jumped(f, cpu.pc, cycle)
            if (cpu.sp > self._stack_end or cpu.sp < self._stack_begin) and self._left_stack(f):
                how = "grew beyond" if cpu.sp > self._stack_end else "was popped below"
                section = f"{self._stack_begin:#06x} to {self._stack_end - 1:#06x}"
                raise IllegalOperation(f"the stack {how} its section .stack, {section}")
            self._sp = cpu.sp
            if cpu.marks is not None:
                cpu.marks.executed(f)
            for watch in self._watches:
                watch.executed(f, cpu, cycle)
            if cpu.returning:
                cpu.returning = False
                cpu.hand_over()
                self._executed = False
                if not processor.iret():
                    return
                continue
            if cpu.ended:
                self._end()
                return
            if cycle >= time.lease and not processor.reach(cycle):
                return
            time.cycle = cycle

    # Waits --------------------------------------------------------------------------

    def _sleeps(self) -> bool:
        """Put the program to sleep at the start of a pass that must repeat the previous ones.

        Return True if it sleeps, False if it stays awake. If `polls.skips` is False, the sleep is only noted, and the
        program executes the passes.
        """
        polls, passed = self.cpu.polls, self.instructions - self._counted
        self._counted = self.instructions
        if polls.counting:
            spin = self._sleeps_counting()
        else:
            is_repeatable, as_before = polls.is_repeatable(), self.cpu.is_as_before()
            if not (is_repeatable and polls.repeats(as_before)):
                if polls.may_count():
                    program: Any = self  # Any, because compiled code would pass an unbound method of a typed object
                    over = program.unwatch_instructions
                    self._counting = CountingLoop(self.cpu, self._processor.time, self._processor.bus.ram, over)
                    self.watch_instructions(self._counting)
                return False
            self._counting = None
            if polls.restarts:
                self._keep_unmodelled(polls.since)
                polls.examine_later()
                return False
            spin = polls.sleep()
        if spin is None:
            return False
        self._pass = passed
        if self._counting is not None and not polls.reads:
            return True  # the loop only counts, and reads nothing that others change, so it is not recorded as a wait
        self.spin = spin
        self._unmodelled = None
        if self._counting is None:
            self._keep_unmodelled(spin.since)
        self._asleep_at = self._clock.tick(polls.began)
        self._record_wait(self._processor.time.cycle, 1)
        return True

    def _keep_unmodelled(self, since: int) -> None:
        """Store the present loop in `_unmodelled` if it reads unmodelled words, but no registers of modules.

        since: the cycle at which the wait began.
        """
        polls, cpu = self.cpu.polls, self.cpu
        if polls.elsewhere and not polls.reads_modules:
            loop = (cpu.pc, self._at)
            self._unmodelled = UnmodelledWait(since, loop, cpu.sp, polls.routines, list(polls.elsewhere))

    def _sleeps_counting(self) -> Spin | None:
        """Put the program to sleep, at the end of a traced pass, for the passes that change only counters.

        Return the wait that begins. Return None, without a sleep, if there are too few such passes, or if
        `PollSkipper.sleep` returns None.
        """
        polls, loop = self.cpu.polls, self._counting
        assert loop is not None
        self.unwatch_instructions(loop)
        passes = loop.passes(polls.changed) if polls.counted() else 0
        if passes >= FEWEST:
            spin = polls.sleep(passes)
            if spin is not None:
                return spin
        if not polls.clean or loop.does_more:
            polls.count_failure()
        self._counting = None
        return None

    def _follow_wait(self) -> None:
        """End a wait whose passes are executed, not skipped, if a sleeping program would have been woken already."""
        time, back = self._processor.time, self._back
        self._back = -1
        if time.wakes <= time.cycle:
            woken = time.wakes
            self._woken(woken)
            if back >= 0 and woken < time.cycle:  # the wake-up was in the pass that has just ended
                self._loop_due = self.cpu.polls.again(back, time.cycle)

    def _woken(self, cycle: int) -> None:
        """End a wait at a cycle from which on a pass may have another result; see `PollSkipper.woken`."""
        polls, counting = self.cpu.polls, self._counting
        passes = polls.woken(cycle)
        self.spin = self._counting = None
        if polls.skips:
            self.polls_skipped += passes
            self.instructions += passes * self._pass
            self.skipped += passes * self._pass
            if counting is not None:
                counting.move(passes)
        if counting is not None and not polls.reads:
            return
        self._record_wait(cycle, 0)
        if self._calls is not None:
            self._calls.slept(self._clock.tick(polls.begins_at(passes)) - self._asleep_at)

    @property
    def asleep_since(self) -> int | None:
        """The tick at which the present wait or IDLE began; None if there is none, as in a loop that only counts."""
        return self._asleep_at if self.spin is not None or self._idle_began else None

    def awaited(self) -> Awaited:
        """Return a description of the wait in progress."""
        operands, loop = [] if self.spin is None else self.spin.polls, (self.cpu.pc, self._at)
        return self._awaited(loop, operands, self.cpu.polls.elsewhere)

    def unanswered_wait(self) -> Awaited | None:
        """Return a description of a wait that reads unmodelled registers only; None if there is none."""
        wait = self._unmodelled
        if wait is None or not wait.goes_on(self.cpu):
            return None
        found = self._awaited(wait.loop, [], wait.addresses)
        return found._replace(since=wait.since, place=self.place_at(wait.loop[1]))

    def _slept(self) -> bool:
        """Wait in IDLE. Return True if an enabled or nonmaskable interrupt ended it, False if the program must stop."""
        processor, core = self._processor, self._processor.core
        time = processor.time
        if not self._idle_began:
            self._idle_began = True
            self._asleep_at = self._clock.tick(time.cycle)
            core.idle(time.cycle - cpu_costs.IDLE)
            self._record_wait(time.cycle - cpu_costs.IDLE, 1)
        while not core.idle_ends(time.cycle):
            if not processor.rest(max(time.cycle, core.next_wake)):
                return False
        self._idle_began = self.cpu.idling = False
        self._record_wait(time.cycle, 0)
        if self._calls is not None:
            self._calls.slept(self._clock.tick(time.cycle) - self._asleep_at)
        return True

    def _end(self) -> None:
        """Let the posted writes before ESTOP0 take effect, as far as time can pass in this call."""
        time = self._processor.time
        if self.returned_at is None:
            self.returned_at = time.cycle
        while time.lands < NEVER:
            if not self._processor.reach(time.lands + 1):
                return

    def ending(self, at: Text) -> str:
        """Return the text of the note about the end of the program. at: the time of the end as text."""
        return f"ESTOP0 ended the program at {at}, in {self.place()}"

    # Interrupts ---------------------------------------------------------------------

    def context(self) -> Sequence[int]:
        return self.cpu.context()

    def enter(self, vector: int) -> Text:
        if not vector:
            taken = self._processor.taken
            raise FirmwareLost(self.error_text(f"interrupt {taken} was taken, but its vector is 0"))
        interrupted = self.cpu.pc
        if self._unmodelled is not None and not self._unmodelled.goes_on(self.cpu):
            self._unmodelled = None
        self.cpu.begin_routine(vector)
        self._at = vector
        if self._calls is not None:
            self._calls.push(self.cpu.pc, interrupted, self._processor.time.cycle)
        self._executed = False
        return self.place() or ""

    def restore(self, words: Sequence[int]) -> None:
        self.cpu.restore(list(words))
        if self._calls is not None:
            self._calls.on_return(self.cpu.pc, self._processor.time.cycle + cpu_costs.IRET)

    def _left_stack(self, f: Operation) -> bool:
        """Return True if SP, which is now outside of the section .stack, has left it by instruction `f`.

        Return False if `f` writes its operand @SP, because firmware may select another stack in this way.
        """
        return self._stack_begin <= self._sp <= self._stack_end and not (f.l == SP_FIELD and f.accesses & WRITES)
