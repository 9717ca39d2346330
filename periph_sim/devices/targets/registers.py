"""A device with registers behind a pointer and an optional interrupt pin, described in a case by a register map.

    START, address+W, pointer, data ... --> write, pointer advances      at = 0x02, width = 16, big
    START, address+R, data ...          --> read, pointer advances        pointer 2: bits 15:8, 3: bits 7:0

The value of a register is latched when its first byte is read, and stored when its last byte is written, so all bytes
belong to one value. The pointer keeps its value after STOP and repeated START. With the keys `updates` and `every`, the
device changes its registers by itself. These updates are applied at the next access. A device with an interrupt pin
also schedules an event for each update, so that its pin changes in time.
"""

from __future__ import annotations

import csv
from bisect import bisect_right
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

from ...core.input_files import read_input
from ...core.registers import NamedByte
from ...core.state import State
from ...core.table import duration
from ...core.wire import Pin
from . import BadDevice, PlainReply, Target, TargetContext
from .register_settings import RegisterTable, Settings

__all__ = ["MODELS", "Settings", "build"]

MODELS = ("registers",)
SOURCE = "the case's register map"


class Feed:
    """The updates of one register by the device itself.

        updates = [["5 ms", 0x12], ["7 ms", 0x34]]    or a .csv file of such rows
        every = "1 ms", values = [1, 2, 3]            the last value remains
        every = "1 ms", step = 1                      each update adds `step`

    ticks: the ticks of all updates or, with a period, only of the first one.
    values: the value of each update; empty if updates add `step`.
    period: ticks between updates; 0 without a period.
    """

    STATE = State("_taken")

    def __init__(self, ticks: Sequence[int], values: Sequence[int], period: int) -> None:
        self._ticks, self._values, self._period = ticks, values, period
        self._taken = 0  # number of updates that `advance` has returned so far

    def advance(self, now: int) -> tuple[int, int]:
        """Return the number of updates that have become due since the last call, and the value of the last update.

        The value is 0 if updates add `step`, or if no update has become due yet.
        """
        due = bisect_right(self._ticks, now)
        if self._period and due:
            due = (now - self._ticks[0]) // self._period + 1
            if self._values:
                due = min(due, len(self._values))
        new, self._taken = due - self._taken, due
        return new, self._values[due - 1] if self._values and due else 0

    def next_due(self) -> int | None:
        """Return the tick of the next update; None after the last one."""
        if self._values and self._taken >= len(self._values):
            return None
        return self._ticks[0] + self._taken * self._period if self._period else self._ticks[self._taken]


def feed_of(table: RegisterTable, entry: int, place: TargetContext) -> Feed | None:
    """Return the updates of a register; None if it has none.

    entry: the index of the register in the case, for messages.

    Raise BadDevice if a file is invalid or the times of the updates are not in order.
    """
    if table.every is not None:
        first = table.every if table.first is None else table.first
        period = max(1, place.ticks(table.every))
        return Feed([place.start + place.ticks(first)], table.values, period)
    rows = table.updates
    if isinstance(rows, str):
        try:
            rows = _rows(place.folder / rows, table)
        except ValueError as error:
            raise BadDevice(str(error), "register", entry, "updates") from None
    if not rows:
        return None
    times = [time for time, _ in rows]
    if times != sorted(times):
        raise BadDevice(f"the times of {table.name} do not rise; sort its rows", "register", entry, "updates")
    return Feed([place.start + place.ticks(time) for time in times], [value for _, value in rows], 0)


def _rows(path: Path, table: RegisterTable) -> tuple[tuple[Fraction, int], ...]:
    """Return pairs of a time, in seconds, and a value from a file with lines such as "5 ms,0x12".

    Empty lines, and a first line that begins with "time" or "at", are skipped.

    Raise ValueError, with file and line, if the file is invalid.
    """
    try:
        lines = list(csv.reader(read_input(path).decode("utf-8").splitlines()))
    except (OSError, UnicodeDecodeError) as error:
        why = error.strerror if isinstance(error, OSError) else "it is not UTF-8 text"
        raise ValueError(f"{path} cannot be read ({why}); its path is relative to the folder of the case") from None
    rows = []
    for number, cells in enumerate(lines, 1):
        if not any(cell.strip() for cell in cells) or (number == 1 and cells[0].strip() in ("time", "at")):
            continue
        try:
            time, value = cells
            rows.append((duration(time.strip()), int(value.strip(), 0)))
        except ValueError:
            raise ValueError(
                f"{path}, line {number}: {','.join(cells)!r} is no time and value; write them as 5 ms,0x12"
            ) from None
        if not 0 <= rows[-1][1] <= table.full:
            raise ValueError(
                f"{path}, line {number}: {rows[-1][1]:#x} does not fit the {table.width} bits of {table.name}"
            )
    return tuple(rows)


class RegisterDevice(PlainReply):
    """A device whose registers a case describes. `answer` returns this object itself as the reply.

    values: the registers' values by name.
    """

    STATE = State("values _feeds _pointer _byte _taken _powered")

    def __init__(self, settings: Settings, place: TargetContext, address: int, feeds: dict[str, Feed]) -> None:
        self.addresses = (address,)
        self.pointer_bytes = settings.pointer_bytes
        self.values: dict[str, int] = {}
        self._settings = settings
        self._place = place
        self._feeds = feeds
        self._named = {table.name: table for table in settings.registers}
        self._starts = [table.at for table in settings.registers]
        self._cells = {
            table.at + index: (table, index) for table in settings.registers for index in range(_span(settings, table))
        }
        interrupt = settings.interrupt
        self._interrupt = None if interrupt is None else (interrupt, _pin(interrupt.wire, place))
        self._powered = True
        self._reset()
        if self._interrupt is not None:
            self._plan()

    def power_on(self) -> None:
        """Reset every register, and skip the updates that became due while the power was off."""
        self._skip_updates()
        self._powered = True
        self._reset()

    def power_off(self) -> None:
        """Reset every register. The interrupt pin is not active without power."""
        self._powered = False
        self._reset()

    def _reset(self) -> None:
        self.values = {table.name: table.reset for table in self._settings.registers}
        self._pointer = 0
        self._byte = 0  # index of the next byte in the register, if the pointer counts registers
        # The register whose bytes are being transferred: its name, its value, and the index of the next byte. None
        # before the first data byte after the address or the pointer.
        self._taken: tuple[str, int, int] | None = None
        self._show()

    # Transfers ---------------------------------------------------------------------

    def answer(self, address_byte: int) -> RegisterDevice | None:
        if address_byte >> 1 not in self.addresses:
            return None
        self._byte, self._taken = 0, None
        return self

    def named(self, value: int, before: int | None) -> NamedByte:
        table, index = self._cell()
        if table is None:
            return NamedByte(f"{self._pointer:#04x}", "not in the map")
        if not index or before is None:
            return NamedByte(table.name)
        return NamedByte(table.name, f"{int.from_bytes((before, value), self._settings.byte_order):#06x}")

    def send_byte(self, byte: int) -> int:
        self._apply_updates()
        table, index = self._cell()
        if table is None:
            self._place.duty(f"register {self._pointer:#04x} was read, but is not in the map", SOURCE)
            self._move_on(None)
            return self._settings.unmapped
        if self._taken is None or self._taken[0] != table.name or self._taken[2] != index:
            self._taken = (table.name, self.values[table.name], index)
            self.values[table.name] &= ~table.mask(table.read_clears)
            self._show()
        value = self._taken[1]
        self._taken = (table.name, value, index + 1)
        self._move_on(table)
        return value >> self._shift(table, index) & 0xFF

    def receive_byte(self, byte: int, value: int) -> bool:
        if byte < self._settings.pointer_bytes:
            self._pointer = (0 if byte == 0 else self._pointer << 8) | value
            self._byte, self._taken = 0, None
            return True
        self._apply_updates()
        table, index = self._cell()
        if table is None:
            self._place.duty(
                f"{value:#04x} was written to register {self._pointer:#04x}, which is not in the map", SOURCE
            )
            self._move_on(None)
            return True
        if self._taken is None or self._taken[0] != table.name or self._taken[2] != index:
            self._taken = (table.name, self.values[table.name] & ~table.mask(table.write_1_clears), index)
        shift = self._shift(table, index)
        whole = self._taken[1] & ~(0xFF << shift) | value << shift
        self._taken = (table.name, whole, index + 1)
        if index + 1 == table.width // 8:
            self._write(table, whole)
        self._move_on(table)
        return True

    def on_end(self, stop: bool, whole: bool) -> None:
        """Do nothing. An incomplete value is dropped when the device is addressed again."""

    def _write(self, table: RegisterTable, value: int) -> None:
        fixed, clears = table.mask(table.read_only), table.mask(table.write_1_clears)
        if fixed == table.full:
            self._place.duty(f"{value:#04x} was written to {table.name}, which is read-only", SOURCE)
        old = self.values[table.name]
        stays = old & (fixed | clears)
        self.values[table.name] = (stays | value & ~(fixed | clears)) & ~(value & clears) & table.full
        self._show()

    # The pointer -------------------------------------------------------------------

    def _cell(self) -> tuple[RegisterTable | None, int]:
        """Return the register at the pointer, or None if there is none, and the index of the register's next byte."""
        table, index = self._cells.get(self._pointer, (None, 0))
        return table, index + self._byte

    def _shift(self, table: RegisterTable, index: int) -> int:
        last = table.width // 8 - 1
        return 8 * (last - index if self._settings.byte_order == "big" else index)

    def _move_on(self, table: RegisterTable | None) -> None:
        """Advance the pointer after the transfer of a byte.

        table: the register to which the byte belongs; None if the pointer is at no register.
        """
        settings = self._settings
        if settings.pointer_counts == "registers" and table is not None:
            self._byte += 1
            if self._byte < table.width // 8:
                return
            self._byte = 0
        if settings.auto_increment:
            self._pointer += 1
            end = max(self._cells) + 1 if settings.wrap == "map" else 1 << 8 * settings.pointer_bytes
            if self._pointer >= end:
                self._pointer = min(self._starts) if settings.wrap == "map" else 0

    # Updates and the interrupt pin -------------------------------------------------

    def _apply_updates(self) -> None:
        now = self._place.kernel.now
        for name, feed in self._feeds.items():
            times, value = feed.advance(now)
            if times:
                table = self._named[name]
                self.values[name] = (self.values[name] + times * table.step if table.step else value) & table.full
                if table.sets is not None:
                    self.values[table.sets.register_name] |= table.sets.bits

    def _plan(self) -> None:
        """Schedule an event for the next update of any register, if there is one."""
        due = [tick for tick in (feed.next_due() for feed in self._feeds.values()) if tick is not None]
        if due:
            self._place.kernel.call_at(max(min(due), self._place.kernel.now), self._updated)

    def _skip_updates(self) -> None:
        for feed in self._feeds.values():
            feed.advance(self._place.kernel.now)

    def _updated(self) -> None:
        if self._powered:
            self._apply_updates()
            self._show()
        else:
            self._skip_updates()
        self._plan()

    def _show(self) -> None:
        """Drive the interrupt pin, if there is one, to its present level.

        The pin is active if the device has power and one of the register bits in `Interrupt.bits` is set.
        """
        if self._interrupt is not None:
            interrupt, pin = self._interrupt
            pending = self._powered and bool(self.values[interrupt.register_name] & interrupt.bits)
            pin.drive(int(pending == (interrupt.active == "high")))


def _span(settings: Settings, table: RegisterTable) -> int:
    """Return the number of pointer values that a register takes."""
    return table.width // 8 if settings.pointer_counts == "bytes" else 1


def _pin(wire: str, place: TargetContext) -> Pin:
    try:
        return place.wire(wire).attach(place.who)
    except ValueError as error:
        raise BadDevice(str(error), "interrupt", "wire") from None


def build(model: str, settings: Settings, place: TargetContext) -> Target:
    if place.address is None:
        raise BadDevice("a device of registers has no default address; give one such as address = 0x48", "address")
    _check_places(settings)
    feeds = {}
    for entry, table in enumerate(settings.registers):
        if table.sets is not None:
            _known(settings, table.sets.register_name, "register", entry, "sets", "register")
        feed = feed_of(table, entry, place)
        if feed is not None:
            feeds[table.name] = feed
    if settings.interrupt is not None:
        _known(settings, settings.interrupt.register_name, "interrupt", "register")
    return RegisterDevice(settings, place, place.address, feeds)


def _known(settings: Settings, name: str, *place: str | int) -> None:
    names = [table.name for table in settings.registers]
    if name not in names:
        raise BadDevice(f"there is no register {name!r}; the map has {', '.join(names)}", *place)


def _check_places(settings: Settings) -> None:
    """Raise BadDevice for overlapping registers, registers beyond the pointer's range, and duplicate names."""
    taken: dict[int, str] = {}
    names: set[str] = set()
    reach = 1 << 8 * settings.pointer_bytes
    for entry, table in enumerate(settings.registers):
        if table.name in names:
            raise BadDevice(f"there are two registers {table.name!r}; rename one of them", "register", entry, "name")
        names.add(table.name)
        for pointer in range(table.at, table.at + _span(settings, table)):
            if pointer in taken:
                raise BadDevice(
                    f"{table.name} and {taken[pointer]} overlap at {pointer:#04x}; move one of them",
                    "register",
                    entry,
                    "at",
                )
            if pointer >= reach:
                raise BadDevice(
                    f"{table.name} reaches {pointer:#x}, beyond {reach - 1:#x}, the last that a pointer of "
                    f"{settings.pointer_bytes} byte{'s' if settings.pointer_bytes > 1 else ''} names",
                    "register",
                    entry,
                    "at",
                )
            taken[pointer] = table.name
