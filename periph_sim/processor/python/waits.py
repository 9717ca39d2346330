"""Waits of Python firmware, `while (!condition()) ;`, which end at the cycle at which polling would end.

    condition --first pass--> its reads --Lease--> sleep --wake--> reads alone --a bit differs--> condition

Passes are skipped as follows. A pass whose reads have no side effect is executed once. Further passes have the same
result until a register that the pass has read changes, or an interrupt is due. Then the pass in progress is replayed
from its start, and its reads in the past return the earlier values. If only the reads of a pass and their tests take
time, the condition is called only after a read has returned another value, or an interrupt may be taken. So a wait ends
at the cycle at which polling pass by pass would have ended, but needs only one event.

A condition is a function, or a `Condition` on one register, whose passes execute no Python code. A function that does
the same as a `Condition` is replaced by a `Condition` at its second wait:

    lambda: i2c.I2CSTR.XRDY == 1   --second wait--> its code: i2c, I2CSTR, XRDY, ==, 1 --> Condition

Only comparisons of a field of a module's register with a number are replaced, since firmware cannot give them another
meaning. In records, the statement of the read is the line of the function.
"""

# core: compiled

from __future__ import annotations

import sys
from collections.abc import Callable
from dis import get_instructions
from functools import lru_cache
from types import CodeType, FunctionType
from typing import final

from ...core.chip import NEVER
from ...core.options import IntOption
from ...core.records import TIMED_OUT, Topic
from ...f28335.cpu import code_costs as cpu_costs
from ..cpu_time import CpuTime
from ..operand import Operand
from ..polling import Lease, Poll, Spin
from ..source_location import SourceLocation
from .cpu import Cpu
from .program import PythonProgram
from .register_view import ABOVE, BELOW, EQUAL, UNEQUAL, Condition, ModulePort, Port

TESTS = {"==": EQUAL, "!=": UNEQUAL, "<": BELOW, ">": ABOVE}
NOTHING = frozenset(("RESUME", "COPY_FREE_VARS", "NOP", "CACHE", "PRECALL"))  # opcodes without effect on the result
FORM = ("LOAD_DEREF", "LOAD_ATTR", "LOAD_ATTR", "LOAD_CONST", "COMPARE_OP", "RETURN_VALUE")


# A comparison in a function: (index of the module among its free variables, register, field, test, number, line).
FieldComparison = tuple[int, str, str, int, int, int]


@lru_cache(maxsize=256)  # the result depends on the code alone, so the firmware of all scenes shares it
def comparison_of(code: CodeType) -> FieldComparison | None:
    """Return the comparison that a code object makes; None if the code has another form."""
    if code.co_argcount or code.co_kwonlyargcount or code.co_flags & 0x0C:
        return None
    steps = [step for step in get_instructions(code) if step.opname not in NOTHING]
    names = ["LOAD_CONST" if step.opname == "LOAD_SMALL_INT" else step.opname for step in steps]
    if tuple(names) != FORM:
        return None
    module, register, field, number, test, _ = [step.argval for step in steps]
    if test not in TESTS or type(number) is not int or module not in code.co_freevars:
        return None
    at = steps[2].positions
    line = at.lineno if at is not None and at.lineno is not None else code.co_firstlineno
    return code.co_freevars.index(module), register, field, TESTS[test], number, line


@final
class ConditionQuery:
    """The result of the analysis of a code object: the comparison of a field with a number, if it makes one.

    code: the code object. The reference keeps its id unique.
    known: True if the code was analysed.
    found: the comparison; None if the code has another form.
    place: the index of the module among the free variables; -1 if there is no comparison.
    where: the location of the comparison in the firmware.
    module, condition: the module of the last wait, and the equivalent condition on its register; None if there is none.
    """

    def __init__(self, code: CodeType) -> None:
        self.code = code
        self.known = False
        self.found: FieldComparison | None = None
        self.place = -1
        self.where: SourceLocation | None = None
        self.module: ModulePort | None = None
        self.condition: Condition | None = None

    def condition_on(self, module: object) -> Condition | None:
        """Return the equivalent condition on the register of this module; None if there is none."""
        self.module = self.condition = None
        if isinstance(module, ModulePort) and self.found is not None:
            _, register, field, test, number, _ = self.found
            port = vars(module).get(register)
            if isinstance(port, Port):
                self.module = module
                self.condition = port.comparison(field, number, test, self.where)
        return self.condition


@final
class Recogniser:
    """Finds the conditions that are equivalent to functions in the firmware of one CPU."""

    def __init__(self, program: PythonProgram) -> None:
        self._program = program
        self._queries: dict[int, ConditionQuery] = {}
        self._latest: ConditionQuery | None = None  # the query that was used last
        self._earlier: ConditionQuery | None = None  # the query used before `_latest`; two functions often alternate

    def condition(self, function: object) -> Condition | None:
        """Return the condition equivalent to a function; None if there is none, and at the function's first wait.

        Return None also if a trace function was set at its second wait.
        """
        if type(function) is not FunctionType:
            return None
        code = function.__code__
        query: ConditionQuery | None = self._latest
        if query is None or query.code is not code:
            query, self._earlier = self._earlier, query
            if query is None or query.code is not code:
                query = self._queries.get(id(code))
                if query is None:
                    query = self._queries[id(code)] = ConditionQuery(code)
                    self._latest = query
                    return None
            self._latest = query
        if not query.known:
            query.known = True
            query.found = found = None if sys.gettrace() is not None else comparison_of(code)
            if found is not None:
                program = self._program
                query.place = found[0]
                query.where = None if program.placed is not None else program.places.of_line(code, found[-1])
        if query.place < 0:
            return None
        try:
            module = function.__closure__[query.place].cell_contents  # type: ignore[index]
        except ValueError:  # no value is assigned to the variable yet
            return None
        return query.condition if module is query.module else query.condition_on(module)


NEITHER, READY, OVER = range(3)  # the condition that ended a wait


@final
class Waits:
    """The waits of the Python firmware of one CPU."""

    def __init__(self, cpu: Cpu, pf2_read_ws: IntOption, poll_pass: int, skip_polls: bool) -> None:
        """poll_pass: the cycles of a pass with one read in peripheral frame 2.

        pf2_read_ws: the option for the wait states of such a read.
        skip_polls: False if each pass is executed; tests compare runs with and without skipping.
        """
        # The cycles of the branch back to the start of a pass.
        self._branch: int = max(0, poll_pass - cpu_costs.SIMPLE - pf2_read_ws.unrecorded())
        self._branch_listed = False  # True once the dependence of the run on `pf2_read_ws` is stored
        self._pf2_read_ws = pf2_read_ws
        self._cpu = cpu
        self._time: CpuTime = cpu.time
        self._skip_polls = skip_polls
        self._lease = Lease(cpu.time)
        self._recogniser = Recogniser(cpu.program)
        self._spare: Spin | None = None  # the object of an earlier wait, which the next wait uses again

    def spin(self, condition: Callable[[], object], pass_cycles: int | None = None, timeout: int | None = None) -> bool:
        """Wait as compiled `while (!condition()) ;` does, in passes of reads, their tests and the branch back.

        Return True as soon as the condition holds. Return False at the end of the first pass at which `timeout` cycles,
        including the cycles of interrupts, have passed since the start of the wait.

        pass_cycles: the cycles of a pass; if its reads take longer, a pass ends after the reads. None to compute the
        cycles of a pass from its reads.
        """
        return self._wait(condition, None, pass_cycles, timeout) == READY

    def spin_either(
        self, ready: Callable[[], object], over: Callable[[], object], pass_cycles: int | None = None
    ) -> bool:
        """Wait as `while (!ready()) if (over()) break;` does. Return True if `over` has ended the wait."""
        return self._wait(ready, over, pass_cycles, None) == OVER

    def _wait(
        self,
        ready: Callable[[], object],
        over: Callable[[], object] | None,
        pass_cycles: int | None,
        timeout: int | None,
    ) -> int:
        """Wait, and return the condition that ended the wait: READY, OVER or, after a timeout, NEITHER."""
        time, cpu = self._time, self._cpu
        program = cpu.program
        spin = self._new_wait(pass_cycles, NEVER if timeout is None else time.cycle + timeout)
        outer, program.spin = program.spin, spin
        recogniser = self._recogniser
        ready_condition: Condition | None
        over_condition: Condition | None
        ready_condition = ready if isinstance(ready, Condition) else recogniser.condition(ready)
        over_condition = over if over is None or isinstance(over, Condition) else recogniser.condition(over)
        waited: Topic | None = None
        came, again = NEITHER, False
        while True:
            if not again or not self._repeats(spin):
                spin.begin_pass(time.cycle)
                if ready_condition.holds() if ready_condition is not None else ready():
                    came = READY
                elif over is not None and (over_condition.holds() if over_condition is not None else over()):
                    came = OVER
                if came:
                    break
                spin.take_length(time.cycle)
                if cpu.records_waits and waited is None:
                    waited = cpu.waited_for(spin)
                    cpu.record(waited, spin.since, 1)
            if pass_cycles is None and not self._branch_listed:
                self._branch_listed = True
                self._pf2_read_ws.assume(cpu.core.touched)
            cpu.instruction(spin.rest(time.cycle, self._branch))
            again = spin.pure and time.cycle < spin.ends and self._skip(spin)
            if time.cycle >= spin.ends:
                break
        if waited is not None:
            cpu.record(waited, time.cycle, 0, "" if came else TIMED_OUT)
        cpu.instruction(cpu_costs.SB_NOT_TAKEN)
        program.spin = outer
        self._spare = None if cpu.keeps_waits else spin
        return came

    def _new_wait(self, pass_cycles: int | None, ends: int) -> Spin:
        """Return a wait that begins now. The object of an earlier wait is used again if there is one."""
        spin, self._spare = self._spare, None
        if spin is None:
            return Spin(self._time.cycle, pass_cycles, ends)
        spin.since = self._time.cycle
        spin.pass_cycles = pass_cycles
        spin.ends = ends
        spin.bare = False
        spin.live_from = 0
        if spin.last:
            spin.last = []
        return spin

    def _skip(self, spin: Spin) -> bool:
        """Sleep as long as further passes would have the same result as the pass that has just ended.

        Afterwards, time is at the start of the pass during which the CPU was woken. That pass is then replayed: its
        reads before the wake-up return the values of the pass before the sleep.

        Do not sleep if the pass has made no read, if a read value has changed already, or if a posted write or an
        interrupt is pending. If passes must not be skipped, do not sleep either, but store the reads in `Spin.last`.

        Return True after a sleep if the result of the next pass depends on the values of its reads alone, so that
        `_repeats` can execute it. Otherwise return False.
        """
        time, core = self._time, self._cpu.core
        if not spin.made or time.lands < NEVER or core.earliest() < NEVER:
            return False
        if not self._skip_polls:
            spin.last = [(read.operand, read.value) for read in spin.reads[: spin.made]]
            return False
        lease = self._lease
        if not lease.begin(spin):
            return False
        first = time.cycle
        period = first - spin.start
        if spin.ends < NEVER:
            time.wake_at(first - (first - spin.ends) // period * period)  # the end of the pass that times out
        time.sleep(NEVER)
        try:
            self._cpu.program.yield_turn()
        finally:  # if a reset ends the firmware during the sleep, the lease must end, too
            lease.end()
        woken = time.cycle
        skipped = (woken - first) // period
        self._cpu.program.polls_skipped += skipped
        time.cycle = first + skipped * period
        spin.answer_before(woken)
        if core.ifr or core.next_wake <= time.cycle:  # the end of the branch back is an instruction boundary
            self._cpu.serve()
        return spin.bare and spin.pure

    def _repeats(self, spin: Spin) -> bool:
        """Execute the reads of the next pass while they return the values of the last pass.

        Return True if all reads do. Return False at the first other value, at a boundary at which an interrupt may be
        taken, and before a read that must wait for a write or needs more than `Chip.see`. The caller must then call the
        condition from the start of the pass; the reads that are complete return the same values again.
        """
        time, cpu = self._time, self._cpu
        cycle: int
        start = cycle = time.cycle
        place: int
        for place in range(spin.made):
            read: Poll = spin.reads[place]
            operand: Operand = read.operand
            if place:
                cycle += cpu_costs.SB_NOT_TAKEN  # the cycles of the branch that tests the previous value
                if not self._passes(cycle):
                    break
            if not operand.looks or (operand.placed and read.where is None) or cycle < self._cpu.bus.free(operand):
                break
            cycle += operand.read_waits
            if cycle >= spin.live_from:
                if cycle >= time.lease:
                    cpu.go_to(cycle)
                value: int = operand.chip.see(cycle, operand.offset)
                if (value ^ read.value) & operand.mask:
                    break
                if operand.recorded:
                    self._cpu.bus.record_poll(cycle, operand, value, read.where)
            cycle += 1
            if not self._passes(cycle):
                break
        else:
            spin.start = start
            return True
        time.cycle = start
        spin.answer_before(cycle)
        return False

    def _passes(self, cycle: int) -> bool:
        """Let time pass to `cycle`, an instruction boundary. Return False if an interrupt may be taken there."""
        time, core = self._time, self._cpu.core
        if cycle < time.lease:
            time.cycle = cycle
        else:
            self._cpu.go_to(cycle)
        return core.next_wake > cycle and not core.owes_instruction and not (core.ifr and core.earliest() < NEVER)
