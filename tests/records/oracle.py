"""A second, independent search for causes, used to check `periph_sim.records`, with which it shares no code.

It follows the meaning of each kind of record. It is slow and simple: each question is a loop over the list of records.

records, one of them --> chain: [(number, beside)], the causes and, with beside = True, the records shown aside
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from periph_sim.core.records import Kind, Record
from periph_sim.core.registers import Register
from periph_sim.f28335.parts.f28335 import PART

MAPS = {one.name: one.registers for one in PART.modules}
CLEARED_BY_ONE = {"I2CSTR": ("SDIR", "NACKSNT", "SCD", "RRDY", "ARDY", "NACK", "AL"), "TCR": ("TIF",)}
I2C_SOURCES = [
    f"{register}.{f}" for register in ("I2CSTR", "I2CIER") for f in ["AAS", "SCD", "XRDY", "RRDY", "ARDY", "NACK", "AL"]
]
ASKS = {  # vector -> its flag in the PIE, module, fields that request the interrupt when they are set
    "I2CINT1A": ("PIEIFR8.INTx1", "I2C-A", I2C_SOURCES),
    "SCIRXINTA": (
        "PIEIFR9.INTx1",
        "SCI-A",
        ["SCIFFRX.RXFFINT", "SCIFFRX.RXFFOVF", "SCIFFRX.RXFFIENA", "SCIRXST.RXRDY"],
    ),
    "TINT0": ("PIEIFR1.INTx7", "TIMER0", ["TCR.TIF", "TCR.TIE"]),
}
GATE, MODIFY, LANDS_BEHIND = 16, 4, 3


class Oracle:
    """Search for causes in a list of records.

    records: numbered in the order in which they were made, so that causes come first
    cycle: length of a cycle in ticks
    """

    def __init__(self, records: list[Record], cycle: Fraction) -> None:
        self.records = records
        self.cycle = cycle
        self.by_number = {record.number: record for record in records}
        self.places = {record.number: place for place, record in enumerate(records)}
        self.accesses: dict[tuple[str, int], list[Record]] = {}
        for record in records:
            if record.kind is Kind.ACCESS:
                self.accesses.setdefault((record.where, record.cause), []).append(record)
        self.read_of = dict(self._read_modify_writes())

    def chain(self, start: Record, depth: int = 8) -> list[tuple[int, bool]]:
        """The record, then at most `depth` causes, and records shown aside (True), which the chain does not follow."""
        chain = [(start.number, False)]
        now, flag = start, None
        for _ in range(depth):
            flag = now if now.kind is Kind.FLAG else flag
            beside, cause = self._cause(now, flag)
            chain += [(record.number, True) for record in beside]
            if cause is None:
                break
            chain.append((cause.number, False))
            now = cause
        return chain

    def _cause(self, of: Record, flag: Record | None) -> tuple[list[Record], Record | None]:
        if of.kind is Kind.ACCESS:
            return self._of_write(of, flag) if of.what[0] == "W" else self._of_read(of)
        named = self.by_number.get(of.cause)
        if of.kind is Kind.IRQ:
            if not of.value or of.what not in ASKS:
                return [], named
            asked = self._last(of, Kind.FLAG, f"{of.where}.PIE", ASKS[of.what][0], rising=True)
            return ([], named) if asked is None else (self._served(of, asked, of), asked)
        if of.kind is Kind.FLAG and of.where.endswith(".PIE") and of.value:
            for place, module, fields in ASKS.values():
                if place == of.what:
                    unit = of.where.partition(".")[0]
                    rises = [self._last(of, Kind.FLAG, f"{unit}.{module}", field, rising=True) for field in fields]
                    last = max((rise for rise in rises if rise), key=lambda rise: rise.number, default=None)
                    if last is not None and self._cycles(last, of) <= GATE:
                        return [], last
        if named is not None or of.kind is not Kind.EDGE:
            return [], named
        return [], self._party(of)

    # Firmware ----------------------------------------------------------------------

    def _of_read(self, read: Record) -> tuple[list[Record], Record | None]:
        """The last change of what was read; aside, the service routines since then and the entry of its own routine."""
        entry, change = self.by_number.get(read.cause), self._seen(read)
        if change is None:
            return [], entry
        own = [entry] if entry is not None and entry.number > change.number else []
        return [*self._served(read, change, read), *own], change

    def _of_write(self, write: Record, flag: Record | None) -> tuple[list[Record], Record | None]:
        beside: list[Record] = []
        own = self.read_of.get(write.number)
        handed = None
        if own is not None:
            beside.append(own)
            handed = self._handed_back(write, own, flag)
            beside += [handed] if handed is not None else []
        looks = self._looks(write)
        entry = self.by_number.get(write.cause)
        if not looks and entry is None and handed is not None:
            return beside[:-1], handed
        if not looks:
            return beside, entry
        newest = max(looks, key=lambda look: (self._number(self._seen(look)), look.number))
        for look in looks:
            if look.number > newest.number:
                change = self._seen(look)
                beside.append(look)
                beside += [] if change is None else [*self._served(look, change, look), change]
        return [*beside, *self._served(write, newest, write)], newest

    def _looks(self, write: Record) -> list[Record]:
        """The last read of each place and field before a write, newest first, at most eight."""
        found: dict[tuple[str, str, str], Record] = {}
        made_for_writes = {read.number for read in self.read_of.values()}
        for access in reversed(self.accesses[write.where, write.cause]):
            if access.number >= write.number:
                continue
            if len(found) == 8:
                break
            if access.what[0] == "R" and access.number not in made_for_writes:
                found.setdefault((access.what, access.text, access.field), access)
        return [*found.values()]

    def _seen(self, read: Record) -> Record | None:
        """The last change before a read: of the field that it names, or of any field of the register."""
        module, _, register = read.what[2:].partition(".")
        for record in self._before(read):
            if record.kind is Kind.FLAG and record.where == f"{read.where}.{module}":
                name, _, field = record.what.partition(".")
                if name == register and read.field in ("", field):
                    return record
        return None

    def _read_modify_writes(self) -> Iterator[tuple[int, Record]]:
        for of_routine in self.accesses.values():
            waiting: list[tuple[int, Record]] = []
            for place, access in enumerate(of_routine):
                if access.what[0] == "R":
                    waiting.append((place, access))
                    continue
                for at, read in reversed(waiting):
                    alike = (read.what[2:], read.text, read.field) == (access.what[2:], access.text, access.field)
                    if alike and place - at <= LANDS_BEHIND and self._cycles(read, access) <= MODIFY:
                        waiting.remove((at, read))
                        yield access.number, read
                        break

    def _handed_back(self, write: Record, read: Record, flag: Record | None) -> Record | None:
        """The change, as the read saw it, of the field that the walk comes from, if the write wrote the value back."""
        module, _, name = write.what[2:].partition(".")
        if flag is None or flag.where != f"{write.where}.{module}" or flag.what.partition(".")[0] != name:
            return None
        register: Register = MAPS[module][name]
        f = register[flag.what.partition(".")[2]]
        kept = (read.value ^ write.value) & f.mask == 0
        one = f.name in CLEARED_BY_ONE.get(name, ()) and read.value & f.mask
        stored = f.access == "R/W" and f.name != write.field
        if not kept or not (one or stored):
            return None
        return self._last(read, Kind.FLAG, flag.where, flag.what)

    def _served(self, at: Record, after: Record, before: Record) -> list[Record]:
        """Ends of the three longest service routines that interrupted the same routine, the last one first."""
        longest = sorted(self._routines(at, after, before), key=lambda one: -one[1])[:3]
        return sorted((end for end, _ in longest), key=lambda end: -end.number)

    def _routines(self, at: Record, after: Record, before: Record) -> list[tuple[Record, int]]:
        found = []
        for end in self.records[self._place(after) + 1 : self._place(before)]:
            if end.kind is Kind.IRQ and not end.value and end.where == at.where:
                entry = self.by_number[end.cause]
                if entry.cause == at.cause:
                    found.append((end, end.tick - entry.tick))
        return found

    # Wires ---------------------------------------------------------------------------

    def _party(self, edge: Record) -> Record | None:
        """The last BUS or FRAME record of the party that made an edge."""
        party = edge.text
        if edge.value:
            for record in self._before(edge):
                if record.kind in (Kind.EDGE, Kind.HOLD) and record.where == edge.where:
                    party = record.text
                    break
        party = party.split(", ")[-1]
        for record in self._before(edge):
            if record.kind in (Kind.BUS, Kind.FRAME) and record.where == party:
                return record
        return None

    # Lists of records ---------------------------------------------------------------------------

    def _last(self, of: Record, kind: Kind, where: str, what: str, rising: bool = False) -> Record | None:
        for record in self._before(of):
            if (record.kind, record.where, record.what) == (kind, where, what) and (record.value or not rising):
                return record
        return None

    def _before(self, of: Record) -> Iterator[Record]:
        for place in range(self._place(of) - 1, -1, -1):
            yield self.records[place]

    def _place(self, of: Record) -> int:
        return self.places[of.number]

    def register(self, module: str, name: str) -> Register:
        return MAPS[module][name]

    def _cycles(self, first: Record, second: Record) -> int:
        return round(Fraction(second.tick - first.tick) / self.cycle)

    def _number(self, record: Record | None) -> int:
        return 0 if record is None else record.number
