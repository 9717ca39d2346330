"""An image in the memory of its CPU: source lines, texts about errors and waits, and observers.

The text about a wait names the registers that the loop reads, and the bits that the loop tests. The tested bits are
those of the first TBIT or AND with a mask in the loop; if it has no such instruction, they are all bits. A loop that
reads no register and has an exit (`_is_exit`) waits for memory. The text then names each memory word that the loop
reads by the last symbol at or before the address of the word.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Annotated, NamedTuple

from ...core.chip import Note
from ...core.records import Kind, Recorder
from ...core.registers import Register
from ...core.state import State
from ...core.time import Clock
from ...f28335.memory.address_space import Content, area_at, full_name
from ..c28x.decoder import Instruction, sweep
from ..image_files.constants import accesses
from ..image_files.debug_info import FunctionMap
from ..image_files.model import NO_STACK, Image
from ..operand import Operand
from ..processor import Awaited, Processor, Program
from ..source_location import SourceLocation, instruction_location
from .cpu import ImageCpu
from .observers import CallListener, CallStack, InstructionWatch

LAST_JUMPS = 8  # number of jumps that an error message lists; a power of two
LONGEST = 64  # maximum length, in words, of a loop whose code is examined for the text about its wait
ALL = 0xFFFF
MEMORY = "memory"  # what a loop waits for if the words that it reads are unknown
LCR_WORDS = 2
IDLE = "IDLE"
ENDLESS = "endless loop"  # what a loop waits for if it reads nothing


class UnmodelledWait(NamedTuple):
    """A wait for unmodelled registers. It is still in progress while a service routine interrupts it.

    since: the cycle at which the wait began.
    loop: the addresses of the first and the last instruction of its loop. The last one is the branch back.
    sp: the stack pointer in the loop.
    routines: the number of service routines that are active in the loop.
    addresses: the addresses of the unmodelled words that the loop reads.
    """

    since: int
    loop: tuple[int, int]
    sp: int
    routines: int
    addresses: list[int]

    def goes_on(self, cpu: ImageCpu) -> bool:
        """Return True if the program is in the loop, in a function that it calls, or in a routine that interrupts it.

        Call this method also at each entry of a service routine, and discard the wait if the result is False.
        """
        routines = cpu.polls.routines
        if routines != self.routines:
            return routines > self.routines
        first, branch = self.loop
        if first <= cpu.pc <= branch:
            return cpu.sp == self.sp
        return cpu.sp > self.sp and first < cpu.rpc <= branch + LCR_WORDS


class LoadedImage(Program):
    """A program whose image is in the memory of its CPU. cpu: the CPU with its registers and memory."""

    STATE = State("cpu _jumps _jumped _calls _waits_for _watches _unwritten _at", results="_jumps _jumped")

    def __init__(self, processor: Processor, clock: Clock, image: Image, entry: int, cpu: ImageCpu) -> None:
        """entry: the address at which execution begins."""
        super().__init__()
        self.cpu = cpu
        self.image = image
        self._processor = processor
        self._clock = clock
        self._jumps: Annotated[list[int], LAST_JUMPS] = [0] * LAST_JUMPS  # ring buffer: addresses of the last jumps
        self._jumped = 0  # number of jumps so far
        self._places: dict[int, SourceLocation] = {}  # results of `place`
        self._functions: FunctionMap | None = None
        self._calls: CallStack | None = None  # None if no listener observes calls
        self._recorder: Recorder | None = None  # None if waits are not recorded
        self._waits_for = ""  # what the last recorded wait waits for
        self._watches: list[InstructionWatch] = []  # observers of instructions
        self._entry = entry
        self._at = entry  # address of the instruction in progress, or of the last executed instruction
        self._unwritten: set[str] = set()  # names of the functions that have read unwritten memory
        self.cpu.reads_unwritten = self.read_unwritten

    def load(self) -> None:
        """Store the contents of the image in memory."""
        loaded = [(section.address, section.words) for section in self.image.loaded]
        for address, words in (*loaded, *self.image.initial):
            for offset, word in enumerate(words):
                self.cpu.fill(address + offset, word)

    # Places -------------------------------------------------------------------------

    @property
    def functions(self) -> FunctionMap:
        """Functions and source lines by address."""
        if self._functions is None:
            self._functions = FunctionMap(self.image)
        return self._functions

    def place(self) -> SourceLocation | None:
        """Return the function, file and line of the present instruction, or of the last one that was executed."""
        known = self._places.get(self._at)
        if known is None:
            known = self._places[self._at] = self.place_at(self._at)
        return known

    def place_of(self, function: str) -> SourceLocation | str:
        """Return the place of a function's first instruction, or the given name if the image has no such function."""
        found = self.functions.named(function)
        return self.place_at(found.address) if found else function

    def place_at(self, address: int) -> SourceLocation:
        """Return the place of an instruction."""
        functions = self.functions
        source, inside = functions.debug.line_at(address), functions.at(address)
        name, begins = (inside.name, inside.address) if inside else ("", address)
        path, line = source or ("", 0)
        return instruction_location(name, begins, path, line, address)

    def forget_stack(self) -> range:
        """Clear the free words of the section .stack, from SP to its end, and mark them as not written.

        Return their addresses; an empty range if the image has no section .stack.
        """
        first, end = self.image.stack
        if (first, end) == NO_STACK:
            return range(0)
        free = range(max(first, self.cpu.sp), end)
        self.cpu.forget(free)
        return free

    def read_unwritten(self, address: int) -> None:
        """Make a note of a read of unwritten memory; only one note for each function."""
        name = self.functions.name_at(self._at)
        if name not in self._unwritten:
            self._unwritten.add(name)
            text = f"{name} reads {address:#06x}, which has not been written; its value after power-up is undefined"
            self._processor.notes.note(
                self._processor.time.cycle, Note("unknown", text, "SPRU513, uninitialized sections")
            )

    def error_text(self, why: str) -> str:
        """Return an error message with the reason `why`, the place, the registers and the last jumps."""
        cpu = self.cpu
        last = [self._jumps[n & LAST_JUMPS - 1] for n in range(max(0, self._jumped - LAST_JUMPS), self._jumped)]
        jumps = ", ".join(f"{self.functions.name_at(address)} {address:#08x}" for address in last)
        registers = {"ACC": cpu.acc, "P": cpu.p, "XT": cpu.xt, **{f"XAR{n}": cpu.xar[n] for n in range(8)}}
        short = {"SP": cpu.sp, "DP": cpu.dp, "ST0": cpu.st0(), "ST1": cpu.whole_st1(), "IER": cpu.whole_ier()}
        shown = [f"{name}={value:#010x}" for name, value in registers.items() if value or name == "ACC"]
        shown += [f"RPC={cpu.rpc:#08x}", *(f"{name}={value:#06x}" for name, value in short.items())]
        return (
            f"{self._processor.name}: {why}; at {self.place_at(self._at)}, {' '.join(shown)} and 0 in other registers; "
            f"last jumps: {jumps or 'none'}"
        )

    # Waits -----------------------------------------------------------------------------

    def _awaited(self, loop: tuple[int, int], operands: Sequence[Operand], elsewhere: Sequence[int]) -> Awaited:
        """Return a description of the wait in a loop.

        loop: the addresses of the first instruction of the loop, and of the branch that closes it.
        operands: the registers of modules that the loop reads.
        elsewhere: the addresses of the unmodelled words that the loop reads.
        """
        cpu, (first, branch) = self.cpu, loop
        words: tuple[int, ...] = ()
        if branch - first < LONGEST:
            words = tuple([cpu.word_at(address) for address in range(first, branch + 2)])
        if operands or elsewhere:
            mask = mask_of(first, words)
            texts = [f"{operand.name}.{fields_of(operand.register, mask)}" for operand in operands]
            texts += [f"{full_name(address)} & {mask:#06x}" for address in elsewhere]
            return Awaited(" and ".join(dict.fromkeys(texts)), self._unanswered(elsewhere) if elsewhere else "")
        steps = _instructions(first, words)
        if not any(_is_exit(one, first, branch) for one in steps):
            return Awaited("")
        found = accesses(steps, frozenset(), cpu)
        read = dict.fromkeys(one.address for one in found if "r" in one.how)
        areas = [(address, area_at(address)) for address in read]
        names = [self._word_name(at) for at, area in areas if area is not None and area.content is Content.RAM]
        return Awaited(" and ".join(names or [MEMORY]), "", True)

    def _unanswered(self, addresses: Sequence[int]) -> str:
        """Return why these unmodelled words do not change, and what to add to the case.

        Return "" if the case adds or changes a stub of one of them later in the run.
        """
        memory, table = self.cpu.elsewhere, f"[[unit.{self._processor.name}.stub]]"
        if any(address in memory.to_come for address in addresses):
            return ""
        answers = [memory.stubs[address] for address in addresses if address in memory.stubs]
        if answers:
            return (
                f"its {table} answers {answers[0]:#06x}; give a value that ends the wait, "
                "or a later one by a further stub with after"
            )
        return f'it is not modelled; answer it by {table} with register = "{full_name(addresses[0])}" and a value'

    def _word_name(self, address: int) -> str:
        """Return the name of a memory word, "symbol+offset".

        Return its address if its section has no symbol at or before the word.
        """
        section = next((one for one in self.image.sections if one.runs_at(address)), None)
        before = [at for at in self.image.symbol_at if section is not None and section.run <= at <= address]
        if not before:
            return f"{address:#06x}"
        offset = address - max(before)
        return self.image.symbol_at[max(before)] + (f"+{offset}" if offset else "")

    # Observers -------------------------------------------------------------------------

    def add_call_listener(self, listener: CallListener) -> None:
        """Add a listener to function calls. Call this method before the first instruction is executed."""
        if self._calls is None:
            self._calls = CallStack(self.functions, self._clock)
            self._calls.began(self.cpu.pc, self._processor.time.cycle)
        self._calls.add_listener(listener)

    def record_waits(self, recorder: Recorder) -> None:
        """Record the start and the end of each wait, in the same form as for waits of Python firmware."""
        self._recorder = recorder

    def _record_wait(self, cycle: int, begins: int) -> None:
        """Record the start (begins = 1) or the end (0) of a wait, if waits are recorded."""
        if self._recorder is not None:
            place = ""
            if begins:
                self._waits_for = IDLE if self.cpu.idling else self.awaited().what or ENDLESS
                place = self.place() or ""
            tick = self._clock.tick(cycle)
            self._recorder.emit(tick, Kind.WAIT, self._processor.name, self._waits_for, begins, place)

    def watch_instructions(self, watch: InstructionWatch) -> None:
        """Add an observer of each executed instruction."""
        self._watches = [watch, *self._watches]

    def unwatch_instructions(self, watch: InstructionWatch) -> None:
        """Remove an observer, if present. An observer may remove itself while it receives an instruction."""
        self._watches = [one for one in self._watches if one is not watch]


def fields_of(register: Register, mask: int) -> str:
    """Return the names of the fields of a register that have bits in a mask, joined by "+".

    If the mask has all 16 bits, or has no bit of any field, return "all".
    """
    if mask == ALL:
        return "all"
    return "+".join(field.name for field in register.fields if field.mask & mask) or "all"


@lru_cache(maxsize=256)
def mask_of(first: int, words: tuple[int, ...]) -> int:
    """Return the mask of the bits that a loop tests; ALL if no instruction with a mask is found.

    first: the address of the loop. words: its code.
    """
    for one in _instructions(first, words):
        mnemonic, values = one.encoding.mnemonic, one.values
        if mnemonic == "TBIT" and "b" in values:
            return 1 << values["b"]
        if mnemonic in ("AND", "ANDB") and "c" in values:
            return values["c"]
    return ALL


@lru_cache(maxsize=256)
def _instructions(first: int, words: tuple[int, ...]) -> tuple[Instruction, ...]:
    """Return the instructions in these words, up to the first word that is none.

    The last word is used only as the second word of an instruction.
    """
    steps = []
    for found in sweep(first, words):
        if isinstance(found, int) or found.address >= first + len(words) - 1:
            break
        steps.append(found)
    return tuple(steps)


def _is_exit(one: Instruction, first: int, branch: int) -> bool:
    """Return True for a conditional jump out of a loop, and for the branch that closes it if it is conditional.

    Other ways out of a loop, such as an unconditional jump or a return, are not found.

    first, branch: the addresses of the first instruction and of the branch that closes the loop.
    """
    goal = one.target
    if goal is None or one.is_call or not one.goes_on:
        return False
    return one.address == branch or not first <= goal <= branch
