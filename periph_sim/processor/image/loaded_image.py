"""An image in the memory of its CPU: source lines of its instructions, texts of its errors, and observers."""

# core: compiled

from __future__ import annotations

from typing import Annotated

from ...core.chip import Note
from ...core.state import State
from ...core.time import Clock
from ..image_files.debug_info import FunctionMap
from ..image_files.model import Image
from ..processor import Processor, Program
from ..source_location import SourceLocation, instruction_location
from .cpu import ImageCpu
from .observers import CallListener, CallStack, InstructionWatch
from .waits import WaitRecords

LAST_JUMPS = 8  # named in an error; a power of two


class LoadedImage(Program):
    """A program whose image is in the memory of its CPU. cpu: the registers and memory of the CPU."""

    STATE = State("cpu _jumps _jumped _calls _waits _watches _unwritten _at")

    def __init__(self, processor: Processor, clock: Clock, image: Image, entry: int, cpu: ImageCpu) -> None:
        """entry: the address at which execution begins."""
        super().__init__()
        self.cpu = cpu
        self.image = image
        self._processor = processor
        self._clock = clock
        self._jumps: Annotated[list[int], LAST_JUMPS] = [0] * LAST_JUMPS  # a ring
        self._jumped = 0
        self._places: dict[int, SourceLocation] = {}
        self._functions: FunctionMap | None = None
        self._calls: CallStack | None = None  # if calls are observed
        self._waits: WaitRecords | None = None  # if waits are recorded
        self._watches: list[InstructionWatch] = []  # observers of instructions
        self._entry = entry
        self._at = entry  # the present instruction, or the last one
        self._unwritten: set[str] = set()  # functions that have read unwritten memory
        self.cpu.reads_unwritten = self.read_unwritten

    def load(self) -> None:
        """Put the image into memory."""
        cpu = self.cpu
        for section in self.image.loaded:
            for offset, word in enumerate(section.words):
                cpu.fill(section.address + offset, word)
        for address, words in self.image.initial:
            for offset, word in enumerate(words):
                cpu.fill(address + offset, word)

    # Places -------------------------------------------------------------------------

    @property
    def functions(self) -> FunctionMap:
        """Functions and source lines by address."""
        if self._functions is None:
            self._functions = FunctionMap(self.image)
        return self._functions

    def place(self) -> SourceLocation | None:
        """Return the present instruction, or the last one, as function, file and line."""
        known = self._places.get(self._at)
        if known is None:
            known = self._places[self._at] = self.place_at(self._at)
        return known

    def place_of(self, function: str) -> SourceLocation | str:
        """Return the place of a function's first instruction, or the name of an unknown function."""
        found = self.functions.named(function)
        return self.place_at(found.address) if found else function

    def place_at(self, address: int) -> SourceLocation:
        """Return the place of an instruction."""
        functions = self.functions
        source, inside = functions.debug.line_at(address), functions.at(address)
        name, begins = (inside.name, inside.address) if inside else ("", address)
        path, line = source or ("", 0)
        return instruction_location(name, begins, path, line, address)

    def read_unwritten(self, address: int) -> None:
        """Note a read of unwritten memory, once for each function."""
        name = self.functions.name_at(self._at)
        if name not in self._unwritten:
            self._unwritten.add(name)
            text = f"{name} reads {address:#06x}, which has not been written; its value after power-up is undefined"
            self._processor.notes.note(
                self._processor.time.cycle, Note("unknown", text, "SPRU513, uninitialized sections")
            )

    def error_text(self, why: str) -> str:
        """Return an error message with pc, function, last jumps and registers."""
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

    # Observers -------------------------------------------------------------------------

    def add_call_listener(self, listener: CallListener) -> None:
        """Add a listener to calls of functions. Call this method before the first instruction."""
        if self._calls is None:
            self._calls = CallStack(self.functions, self._clock)
            self._calls.began(self.cpu.pc, self._processor.time.cycle)
        self._calls.add_listener(listener)

    def record_waits(self, waits: WaitRecords) -> None:
        """Record the begin and the end of each wait."""
        self._waits = waits

    def watch_instructions(self, watch: InstructionWatch) -> None:
        """Add an observer of each executed instruction."""
        self._watches = [watch, *self._watches]

    def unwatch_instructions(self, watch: InstructionWatch) -> None:
        """Remove an observer, if it is there; it may be the one that is receiving an instruction."""
        self._watches = [one for one in self._watches if one is not watch]
