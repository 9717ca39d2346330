"""A recorded run, and queries for its records. Each query is a search in sorted arrays.

RecordTable --> Run --> rows of the changes of a field, values of a field, accesses by place and by register,
                        conversions of ticks to cycles and times
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import cached_property
from math import gcd
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..core.exact_number import short_time
from ..core.input_files import open_input, similar_file
from ..core.phrases import counted
from ..core.records import Kind, Record
from ..core.registers import Field, Register
from ..f28335.parts.f28335 import PART
from ..traces.formats.psr import holds_run, read_table, recognises
from ..traces.formats.record_table import RecordTable
from .clock_history import ClockHistory
from .register_maps import register_of

Rows = NDArray[np.int64]

HEAD = 64  # number of bytes at the start of a file by which a recording is recognized
WAY_OUT = "record one with periph-sim run CASE --record RUN.psr"
SYSCLK_HZ = 150_000_000  # SYSCLKOUT of an F28335 at full speed


def among(these: Rows, rows: Rows) -> NDArray[np.bool_]:
    """Return, for each element of `these`, True if it is in `rows`. For few rows, np.isin is five times slower."""
    if not len(rows):
        return np.zeros(len(these), bool)
    rows = np.sort(rows)
    found: NDArray[np.bool_] = rows[np.minimum(np.searchsorted(rows, these), len(rows) - 1)] == these
    return found


class NotInRun(ValueError):
    """Error: a file is no recorded run, or the run does not have what was asked for. The message is one sentence."""


class Group(NamedTuple):
    """All reads (`way` "R"), or all writes ("W"), of one register of one module by one unit."""

    unit: str
    way: str
    module: str
    register: Register
    rows: Rows


class CycleLength(NamedTuple):
    """The length of a SYSCLKOUT cycle.

    ticks: number of ticks in a cycle.
    how: a phrase that says where this number comes from.
    """

    ticks: Fraction
    how: str


class Run:
    """An open recording of a run.

    `read` raises NotInRun if the file cannot be read or is no recorded run, and BadCapture if it cannot be decoded. The
    constructor raises NotInRun if the table does not state the number of ticks per second.

    sysclk: SYSCLKOUT in Hz; None to use the frequency that the recording shows, or 150 MHz if it shows none.
    """

    def __init__(self, table: RecordTable, name: str = "the run", sysclk: Fraction | None = None) -> None:
        self.table = table
        self.name = name
        if table.per_second is None:
            raise NotInRun(f"{name}: it does not say how long a tick is; {WAY_OUT}")
        self.per_second: Fraction = table.per_second
        self._sysclk = sysclk
        self._remembered: dict[str, Rows] = {}
        self._rows: dict[tuple[Kind, str | None, str | None], Rows] = {}

    @classmethod
    def read(cls, path: Path | str, sysclk: Fraction | None = None) -> Run:
        path = Path(path)
        try:
            with open_input(path) as file:
                head = file.read(HEAD)
        except FileNotFoundError:
            raise NotInRun(f"{path}: there is no such file; {similar_file(path) or WAY_OUT}") from None
        except OSError as error:
            raise NotInRun(f"{path}: cannot be read ({error.strerror}); {WAY_OUT}") from None
        if not recognises(path, head):
            what = "a run for other programs to read" if path.suffix == ".jsonl" else "not a recorded run"
            raise NotInRun(f"{path}: {what}; {WAY_OUT}")
        table = read_table(path)
        if not holds_run(path):
            raise NotInRun(f"{path}: a capture of wires, with no accesses or flags; {WAY_OUT}")
        return cls(table, str(path), sysclk)

    # Searches for rows ------------------------------------------------------------------------

    def rows(self, kind: Kind, where: str | None = None, what: str | None = None) -> Rows:
        """Return the rows of the records of a kind, in the order of their ticks.

        where, what: the values of `Record.where`, such as the name of a wire, and `Record.what`, such as the
            register and the field; None for any value.
        """
        key = kind, where, what
        if key not in self._rows:
            found = self.table.rows(kind, where, what)
            ticks = self.table.tick[found]
            if (np.diff(ticks) < 0).any():
                found = found[np.argsort(ticks, kind="stable")]
            self._rows[key] = found
        return self._rows[key]

    def remembered(self, name: str, make: Callable[[], Rows]) -> Rows:
        """Return the result of `make` at the first call with this name. Later calls return the same object."""
        if name not in self._remembered:
            self._remembered[name] = make()
        return self._remembered[name]

    def record(self, row: int) -> Record:
        return next(self.table.records(np.array([row])))

    def row_of(self, number: int) -> int | None:
        """Return the row of the record with this number; None if it was not recorded, or if the number is 0."""
        row = int(np.searchsorted(self.table.number, number))
        return row if number and row < len(self.table) and int(self.table.number[row]) == number else None

    def made_by(self, rows: Rows) -> Rows:
        """Return, for each row, the row of its cause; -1 if it has none, or one at another tick or not recorded."""
        table = self.table
        causes = np.minimum(np.searchsorted(table.number, table.cause[rows]), max(len(table) - 1, 0))
        at_once = (table.number[causes] == table.cause[rows]) & (table.tick[causes] == table.tick[rows])
        return np.where(at_once, causes, -1)

    def last(self, rows: Rows, tick: int, before: int | None = None) -> int | None:
        """Return the last of these rows that is not later than `tick`; None if there is none.

        rows: rows in the order of their ticks.
        before: if it is given, only rows before row `before` are considered.
        """
        place = int(np.searchsorted(self.table.tick[rows], tick, "right"))
        while place and before is not None and rows[place - 1] >= before:
            place -= 1
        return int(rows[place - 1]) if place else None

    def next(self, rows: Rows, after: int) -> int | None:
        """Return the first of these rows after row `after`; None if there is none."""
        place = int(np.searchsorted(rows, after, "right"))
        return int(rows[place]) if place < len(rows) else None

    # Registers and accesses -------------------------------------------------------------------

    @cached_property
    def units(self) -> dict[str, tuple[str, ...]]:
        """A dictionary from each unit to the names of its modules, including the modules that every unit has."""
        return {
            unit: (*(module for module in modules if not module.startswith("pin:")), *PART.in_every_unit)
            for unit, modules in self.table.modules.items()
        }

    def changes(self, unit: str, module: str, register: Register, f: Field) -> Rows:
        """Return the rows at which a field changed."""
        return self.rows(Kind.FLAG, f"{unit}.{module}", f"{register.name}.{f.name}")

    def rises(self, unit: str, module: str, register: Register, f: Field) -> Rows:
        """Return the rows at which a field of one bit became 1."""
        changes = self.changes(unit, module, register, f)
        risen: Rows = changes[self.table.value[changes] == 1]
        return risen

    def changed_before(self, unit: str, module: str, register: Register, f: Field, row: int) -> int | None:
        """Return the row of the last change of a field before row `row`; None if there is none."""
        return self.last(self.changes(unit, module, register, f), int(self.table.tick[row]), row)

    def values(self, unit: str, module: str, register: Register, f: Field, rows: Rows) -> Rows:
        """Return the value of a field just before each of these rows; before its first change, the reset value."""
        changes = self.changes(unit, module, register, f)
        before = np.searchsorted(changes, rows) - 1
        held = np.append(self.table.value[changes], f.reset)  # the last item (index -1) is the value after reset
        return held[before]

    def in_order(self, unit: str) -> tuple[Rows, Rows]:
        """Return two arrays of rows: the unit's accesses, and for each of them the next access of the same routine.

        The accesses are ordered by routine: the main program comes first, then each run of a service routine. The
        accesses of one routine are in order of time. For the last access of a routine, the second array has -1.
        """

        def found() -> Rows:
            rows = self.rows(Kind.ACCESS, unit)
            routine = self.table.cause[rows]
            order = np.argsort(routine, kind="stable")
            rows, routine = rows[order], routine[order]
            following = np.append(rows[1:], -1)
            following[np.append(routine[1:] != routine[:-1], True)] = -1
            return np.stack([rows, following[: len(rows)]])

        rows, following = self.remembered(f"accesses of {unit}", found)
        return rows, following

    def routine(self, unit: str, entry: int) -> Rows:
        """Return the unit's accesses in one run of a service routine.

        entry: the number of the record of the entry of the routine; 0 for the main program.
        """
        rows, _ = self.in_order(unit)
        routines = self.remembered(f"routines of {unit}", lambda: self.table.cause[rows])
        found: Rows = rows[np.searchsorted(routines, entry) : np.searchsorted(routines, entry, "right")]
        return found

    def service(self, unit: str, routine: int, after: int, before: int) -> tuple[Rows, Rows]:
        """Return the service routines that ended between two rows: the rows of their ends, and of their entries.

        routine: the interrupted routine, as the number of the record of its entry; 0 for the main program.
        """
        table = self.table

        def found() -> Rows:
            ends = self.rows(Kind.IRQ, unit)
            ends = ends[table.value[ends] == 0]
            entries = np.minimum(np.searchsorted(table.number, table.cause[ends]), max(len(table) - 1, 0))
            known = table.number[entries] == table.cause[ends]
            return np.stack([ends[known], entries[known]])

        ends, entries = self.remembered(f"service routines of {unit}", found)
        within = (ends > after) & (ends < before) & (table.cause[entries] == routine)
        return ends[within], entries[within]

    @cached_property
    def accesses(self) -> tuple[Group, ...]:
        """All accesses to known registers, in groups of the reads or the writes of one register by one unit."""
        table = self.table
        rows = self.rows(Kind.ACCESS)
        where, what = table.columns["where"][rows].astype(np.int64), table.columns["what"][rows].astype(np.int64)
        keys = where * (len(table.names["what"]) + 1) + what
        order = np.argsort(keys, kind="stable")
        rows, keys = rows[order], keys[order]
        begins = [0, *(np.flatnonzero(np.diff(keys)) + 1).tolist()] if len(rows) else []
        groups = []
        for begin, end in zip(begins, [*begins[1:], len(rows)], strict=False):
            key = int(keys[begin])
            unit = table.names["where"][key // (len(table.names["what"]) + 1)]
            way, _, name = table.names["what"][key % (len(table.names["what"]) + 1)].partition(" ")
            module, _, register_name = name.partition(".")
            register = register_of(module, register_name)
            if register is not None:
                groups.append(Group(unit, way, module, register, rows[begin:end]))
        return tuple(groups)

    def accesses_of(self, unit: str, way: str, module: str, register: str) -> Rows:
        return self.rows(Kind.ACCESS, unit, f"{way} {module}.{register}")

    def looking_at(self, reads: Rows, f: Field) -> Rows:
        """Return the rows of `reads` that read field `f` by its name or read the whole register."""
        about = np.array([name in ("", f.name) for name in self.table.names["field"]], bool)
        found: Rows = reads[about[self.table.columns["field"][reads]]]
        return found

    def by_place(self, rows: Rows) -> Iterator[tuple[str, Rows]]:
        """Yield each place in the firmware, such as "function:line", with the rows at this place."""
        codes = self.table.columns["text"][rows]
        for code in sorted(set(codes.tolist())):
            yield self.table.names["text"][code], rows[codes == code]

    # Instants and durations ------------------------------------------------------------------------

    def clock(self, unit: str = "") -> ClockHistory:
        """Return the history of SYSCLKOUT of a unit, or of the first unit if no unit has this name.

        If `sysclk` was given, or if the recording has no clocks, the history has one clock for the whole run, with the
        length of a cycle that `cycles` returns.
        """
        if self._sysclk is None and self._clocks:
            return self._clocks.get(unit) or next(iter(self._clocks.values()))
        return ClockHistory((0,), (self.cycles.ticks,))

    @property
    def counts_alike(self) -> bool:
        """True if a duration has the same number of cycles for all units.

        This is the case if `sysclk` was given, if all units have equal clocks, or if the recording has no clocks.
        """
        return self._sysclk is not None or len(set(self._clocks.values())) <= 1

    @cached_property
    def cycles(self) -> CycleLength:
        """The length of a SYSCLKOUT cycle.

        If `sysclk` was given, it determines the length. Otherwise, the last clock of the first unit in the recording
        does. If the recording has no clocks, the length is derived from the grid of the accesses, which is the greatest
        common divisor of the times between accesses of the same unit. If the grid is longer than a cycle at 150 MHz and
        not a multiple of this cycle, the grid is the length. In all other cases, the length is a cycle at 150 MHz.
        """
        if self._sysclk is not None:
            return CycleLength(self.per_second / self._sysclk, f"SYSCLKOUT {_mhz(self._sysclk)}, as given")
        if self._clocks:
            texts = {unit: clock.in_words(self.per_second) for unit, clock in self._clocks.items()}
            if self.counts_alike:
                texts = {"SYSCLKOUT": next(iter(texts.values()))}
            how = "; ".join(f"{whose} {words}" for whose, words in texts.items())
            return CycleLength(self.clock().periods[-1], how if self.counts_alike else f"SYSCLKOUT of {how}")
        full = self.per_second / SYSCLK_HZ
        grids = []
        for unit in self.table.modules:
            ticks = self.table.tick[self.rows(Kind.ACCESS, unit)]
            if len(ticks) > 1:
                grids.append(int(np.gcd.reduce(np.diff(ticks))))
        grid = gcd(*grids) if grids else 0
        if grid and Fraction(grid) % full == 0:
            return CycleLength(full, "SYSCLKOUT 150 MHz, which all accesses fall on")
        if grid and grid > full:
            clock = self.per_second / grid
            return CycleLength(Fraction(grid), f"SYSCLKOUT {_mhz(clock)}, the grid that all accesses fall on")
        return CycleLength(
            full, "SYSCLKOUT taken as 150 MHz; the accesses fall on no one grid (an error of the crystal, or several)"
        )

    @cached_property
    def _clocks(self) -> dict[str, ClockHistory]:
        """A dictionary from a unit to its clock history; empty if the recording has no clocks."""
        return {
            unit: ClockHistory(tuple(tick for tick, _ in clock), tuple(self.per_second / hz for _, hz in clock))
            for unit, clock in self.table.clocks.items()
        }

    def seconds(self, ticks: int) -> Fraction:
        return Fraction(ticks) / self.per_second

    def at(self, tick: int) -> str:
        """Return an instant of the run as text, in milliseconds with six decimals."""
        return f"{float(self.seconds(tick) * 1000):.6f} ms"

    def length(self, ticks: int, begin: int | None = None, unit: str = "") -> str:
        """Return a duration as text: its time, and the number of SYSCLKOUT cycles in it.

        begin: the first tick of the duration, which selects the clock; None selects the clock at the end of the run.
        unit: the unit whose cycles are counted, such as "dsp". If `unit` is "", as for a wire, cycles are given only if
            all units have the same clock.
        """
        text = short_time(self.seconds(ticks) * 10**9)
        if unit not in self._clocks and not self.counts_alike:
            return text
        clock = self.clock(unit)
        since = clock.begins[-1] if begin is None else begin
        return f"{text} ({counted(clock.cycles(since, since + ticks), 'cycle')})"


def _mhz(hz: Fraction) -> str:
    return f"{float(hz / 1_000_000):g} MHz"
