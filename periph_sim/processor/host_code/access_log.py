"""Log of the accesses of C sources, with which a restored scene executes the sources again up to the snapshot.

    run that keeps a log:  C code --access--> LoggedRun --> CPU --value--> C code, and an item of the log
    re-execution:          C code --access--> runtime.c or LoggedRun: equal to the item? --its value--> C code

A snapshot is possible only while main computes, which means that the CPU sleeps, and no service routine is active. The
log ends at the instant of the snapshot, from which the restored scene continues. An item is appended at the end of an
access, after the items of the service routines that interrupt the access. The bits of an item:

    kind: 3 bits | bytes of a READ, modulo 8: 3 bits | place: 18 bits | value: 40 bits, signed
"""

from __future__ import annotations

from array import array
from collections.abc import Callable, Sequence
from enum import IntEnum
from functools import partial
from pathlib import Path
from typing import NamedTuple

from ...core.restore import NotRestorable
from ...f28335.memory.address_space import full_name
from ..dsp import Dsp
from ..user_code import FirmwareError
from .firmware import HostFirmware, Run
from .register_layout import BYTES_A_WORD, VECTORS, Place, RegisterLayout

ITEM = "Q"  # type code of array.array
KIND, SIZE, PLACE = 61, 58, 40  # lowest bits of the parts of an item
VALUE = (1 << PLACE) - 1


class Access(IntEnum):
    """Kinds of the items of a log. For each kind, a comment explains the parts place and value of an item.

    runtime.c uses the numbers of COMPUTE and READ, too.
    """

    COMPUTE = 1  # the value is the number of cycles
    READ = 2  # the place is the offset in register memory, the value contains the bytes that were read
    WRITE = 3  # the place is the address on the chip, the value is the written value
    EXECUTE = 4  # the place is the index of the instruction in `Run.assembly`
    ENTER = 5  # the value is the address of a service routine in the library


def item_of(kind: Access, place: int = 0, value: int = 0, size: int = 0) -> int:
    return kind << KIND | (size & 7) << SIZE | place << PLACE | value & VALUE


class AccessLog(NamedTuple):
    """The accesses of a run up to an instant.

    items: all items of the run; the run may append further items after the instant.
    length: the number of items up to the instant.
    computing: all cycles of the computation in progress at the instant, also those after it.
    """

    items: array[int]
    length: int
    computing: int


class LoggedRun(Run):
    """A run that keeps a log.

    If it is given the log of an earlier run, it first executes the sources again up to the end of that log: each access
    is compared with the log, which also has the values of reads. No module is accessed in that time.

    log: the items so far.
    computing: the cycles of the computation in progress; 0 if there is none.
    re_executes: True while accesses are compared with the log of the earlier run.
    """

    def __init__(
        self,
        dsp: Dsp,
        path: Path,
        base: int,
        layout: RegisterLayout,
        log: AccessLog | None = None,
        rest: tuple[int, int] = (0, 0),
    ) -> None:
        """log: the log of the earlier run; None to begin a new log.

        rest: the cycle at which the log ends, and the remaining cycles of the computation that is then in progress.
        """
        super().__init__(dsp, path, base, layout)
        self.log = array(ITEM) if log is None else log.items[: log.length]
        self.computing = 0
        self.re_executes = log is not None
        self._rest = rest
        self._earlier = array(ITEM, self.log)
        if log is not None:
            self._earlier.append(item_of(Access.COMPUTE, value=log.computing))
        self._next = self.library.answer(self._earlier)

    def compute(self, cycles: int) -> None:
        item = item_of(Access.COMPUTE, value=cycles)
        left = cycles
        if self.re_executes:
            self._answer(item)
            if self.re_executes:
                return
            self.dsp.processor.time.cycle, left = self._rest
        self.computing = cycles
        super().compute(left)
        self.computing = 0
        self.log.append(item)

    def load(self, at: int, size: int, places: Sequence[Place]) -> None:
        if len(places) > 1:
            for place in places:
                self.load(place.at, place.size, (place,))
        elif places[0].word not in VECTORS:
            item, memory = item_of(Access.READ, at, size=size), self.library.memory[at : at + size]
            if self.re_executes:
                memory[:] = (self._answer(item) & (1 << 8 * size) - 1).to_bytes(size, "little")
            else:
                super().load(at, size, places)
                self.log.append(item | int.from_bytes(memory, "little") & VALUE)

    def write_register(self, word: int, value: int, width: int) -> None:
        self._make(item_of(Access.WRITE, word, value), partial(super().write_register, word, value, width))

    def execute(self, instruction: str) -> None:
        item = item_of(Access.EXECUTE, list(self.assembly).index(instruction))
        self._make(item, partial(super().execute, instruction))

    def _make(self, item: int, access: Callable[[], None]) -> None:
        if self.re_executes:
            self._answer(item)
        else:
            access()
            self.log.append(item)

    def enter(self, pointer: int) -> None:
        computing = self.computing
        if not self.re_executes:
            self.log.append(item_of(Access.ENTER, value=pointer - self.library.loaded_at))
        super().enter(pointer)
        self.computing = computing

    def _answer(self, item: int) -> int:
        """Return the value of the next item of the earlier log. Raise NotRestorable if the present access differs.

        item: the present access.
        """
        while self._earlier[self._next.value] >> KIND == Access.ENTER:  # a service routine interrupted the access
            offset = self._earlier[self._next.value] & VALUE
            self._next.value += 1
            self.enter(self.library.loaded_at + offset)
        earlier = self._earlier[self._next.value]
        if (earlier ^ item) >> (PLACE if item >> KIND == Access.READ else 0):
            place, number = self.place(), self._next.value
            where = f"access {number + 1}" + ("" if place is None else f" at {place} of {place.path}")
            raise NotRestorable(
                f"{self.dsp.name}, {where}: the C sources {self._described(item)}, but before the snapshot they "
                f"{self._described(earlier)}; what they do depends on more than their accesses, for example "
                "on time(), rand() or a file of the host"
            )
        self._next.value += 1
        self.re_executes = self._next.value < len(self._earlier)
        self.dsp.processor.time.cycle += 1  # time changes, so the firmware does not count as stalled
        value = earlier & VALUE
        return value - (value >> PLACE - 1 << PLACE)

    def _described(self, item: int) -> str:
        value, place = item & VALUE, item >> PLACE & (1 << SIZE - PLACE) - 1
        match Access(item >> KIND):
            case Access.COMPUTE:
                return f"compute for {value} cycles"
            case Access.READ:
                return f"read {full_name(place // BYTES_A_WORD)}"
            case Access.WRITE:
                return f"write {value:#x} to {full_name(place)}"
            case Access.EXECUTE:
                return f"execute {list(self.assembly)[place]}"
        return "enter a service routine"


def log_at_rest(firmware: HostFirmware) -> AccessLog | None:
    """Return the log if it can end now, because main computes, the CPU sleeps and no service routine is active.

    Otherwise, return None.
    """
    run, processor = firmware.run, firmware.dsp.processor
    can_end = processor.time.asleep and not processor.core.nested
    if not isinstance(run, LoggedRun) or not run.computing or not can_end:
        return None
    return AccessLog(run.log, len(run.log), run.computing)


def re_execute(firmware: HostFirmware, log: AccessLog, rest: tuple[int, int]) -> None:
    """Execute a program from its start to the end of a log. Its start must be scheduled, but must not have happened.

    Raise NotRestorable if the accesses of the program differ from those in the log, or if the program fails or ends.
    Only the states of the CPU and the kernel change, not those of modules and wires.

    rest: the cycle at which the log ends, and the remaining cycles of the computation that is then in progress.
    """
    processor = firmware.dsp.processor
    firmware.make_run = partial(LoggedRun, log=log, rest=rest)
    processor.kernel.stop()  # so that `act` returns as soon as the program needs time
    processor.time.stop()  # cancels the scheduled start, since the program begins now
    try:
        processor.act(0)
    except FirmwareError as error:
        raise NotRestorable(str(error)) from None
    firmware.make_run = LoggedRun
    if firmware.run is None:
        raise NotRestorable(f"{firmware.dsp.name}: main ended, which it did not before the snapshot")


def restart(firmware: HostFirmware) -> None:
    """Start a program from its beginning, after `re_execute` has failed."""
    firmware.make_run = LoggedRun
    firmware.dsp.processor.kill()
    firmware.dsp.cpu.start(firmware.main)
