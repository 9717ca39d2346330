"""The data of a case: the parts of the scene, the schedule of each party, and the budgets that must hold.

Each table of a case file is one of the classes below, whose fields are its keys. Unknown keys are rejected.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Set
from fractions import Fraction
from pathlib import Path
from typing import Annotated, Any, Literal

from msgspec import Meta

from ...core.convert import BadTable, Mistake, convert
from ...core.phrases import counted, did_you_mean
from ...core.table import Duration, HexBytes, Table
from ...devices.host_frames import host_frames
from ...timing.budget_schema import REPLY, SILENCE, WATCH, Budget
from .device_tables import BusParty, DeviceTable, WatchTable
from .optimizations import Disabled, Fidelity
from .origin import Place, Source, key_of, line_of, named_files
from .scalars import (
    Address,
    Answer,
    Axes,
    Bits,
    BusRate,
    Byte,
    Exact,
    Length,
    Ppm,
    RateError,
)
from .serial import SerialTable, in_words
from .unit_table import Unit
from .wiring import Cable, TransceiverTable, wiring_of


class BadCase(ValueError):
    """Error: a case cannot be loaded or run. The message is one sentence for the user."""


SHORTEST_ROUND = Fraction(1, 1_000_000)  # minimum period of rounds, in seconds: even a byte at 5 MHz takes longer


class RequestTable(Table, frozen=True, kw_only=True):
    """One request of a round. It has either `chip` or `address`.

    chip: gyroscope, accelerometer or magnetometer; implies address, pointer and count
    name: name in messages; otherwise chip or address
    address: 7 bits, right-aligned; required without `chip`
    pointer: register pointer, written first
    count: bytes to read
    write: bytes to write after the pointer
    expect: expected bytes, `count` of them
    """

    chip: str | None = None
    name: str | None = None
    address: Address | None = None
    pointer: Byte | None = None
    count: Annotated[int, Meta(ge=0, le=65535)] = 6
    write: HexBytes = b""
    expect: HexBytes | None = None

    def check_together(self, given: Set[str]) -> None:
        if (self.chip is None) == (self.address is None):
            raise ValueError("a request needs either chip or address")
        said = sorted({"pointer", "count", "write"} & given)
        if self.chip is not None and said:
            raise ValueError(f"chip says {' and '.join(said)} already; leave that out or give address instead of chip")
        if self.chip is None and self.expect is not None and len(self.expect) != self.count:
            raise ValueError(f"expect has {counted(len(self.expect), 'byte')}, but count is {self.count}")


class Controller(Table, frozen=True, kw_only=True):
    """An external I2C controller that sends its requests in periodic rounds.

    A round that is due while the previous one runs is missed.

    rate: SCL frequency, up to 5 MHz
    ppm: clock error, parts per million; rounds do not drift, SCL phases round to the nearest tick
    low, high: SCL low and high time; otherwise half a period
    hold: SCL fall to SDA change; at most `low`
    filter: shorter pulses on SDA are ignored (Fast-mode: 50 ns)
    first: first round
    period: time between rounds
    jitter: random delay of each round; at most `period`
    gap: time between transfers of a round; at least the bus-free time
    rounds: number of rounds; otherwise until the end
    pointer_by: between pointer and read: `"repeated START"` or `"STOP"`
    order: known chips to read: gyroscope, accelerometer, magnetometer, or a plugin's
    request: further requests, `[[controller.request]]`
    initialise: the known chips are identified and set up this long before the first round
    check: `"host"`: compare known chips with the host's frames or the firmware's sensor models; the latter need
        `pins = { MODEL = 34 }`, high while they run
    on_nack: after a refused data byte: `"go on"` with the next phase or `"give up"` with a STOP
    stuck_after: a line low this long is reported with its holder
    clear_after: time from a START refused with SCL high to a bus clear (UM10204 section 3.1.16): up to nine clocks,
        then STOP
    beside_outside: `true`: stays active if an outside party drives SDA and SCL
    """

    rate: BusRate = Fraction(100_000)
    ppm: Ppm = Fraction(0)
    low: Length | None = None
    high: Length | None = None
    hold: Duration = Fraction(300, 10**9)
    filter: Duration = Fraction(0)
    first: Duration = Fraction(5, 1000)
    period: Length = Fraction(20, 1000)
    jitter: Duration = Fraction(0)
    gap: Duration = Fraction(50, 10**6)
    rounds: Annotated[int, Meta(ge=1)] | None = None
    pointer_by: Literal["repeated START", "STOP"] = "repeated START"
    order: tuple[str, ...] = ()
    request: tuple[RequestTable, ...] = ()
    initialise: Length | None = None
    check: Literal["expect", "host"] = "expect"
    on_nack: Literal["go on", "give up"] = "go on"
    stuck_after: Length = Fraction(25, 1000)
    clear_after: Length | None = None
    beside_outside: bool = False

    def as_rounds(self) -> RoundsTable:
        """Return the requests as a table [rounds], for a case in which an outside party replaces this controller."""
        same = ("order", "request", "period", "rounds", "pointer_by", "check", "stuck_after")
        return RoundsTable(**{name: getattr(self, name) for name in same})

    def check_together(self, given: Set[str]) -> None:
        if self.initialise is not None and self.initialise > self.first:
            raise ValueError("initialise is longer than first, so it would begin before the run; make first later")
        if self.period * self.rate < 1:
            raise ValueError("period is shorter than a bit of SCL, so no round can end in it; make it longer")
        low = Fraction(1, 2) / self.rate if self.low is None else self.low
        if self.hold > low:
            hold_ns, low_ns = float(self.hold) * 1e9, float(low) * 1e9
            longer = f"hold is {hold_ns:g} ns, longer than SCL is low, {low_ns:g} ns"
            raise ValueError(f"{longer}, so SDA would move while SCL is high; shorten hold")
        _begins_in_order(self)


class RoundsTable(Table, frozen=True, kw_only=True):
    """The requests of a unit or an outside party that is the controller. The table generates no traffic.

    Measures such as `round`, `missed rounds` and `wrong bytes` need it. A round is due one period after the
    previous one began, and missed half a period later.

    order, request: as in `[controller]`
    period: time between rounds
    rounds: number of rounds due; otherwise until the end
    pointer_by, check: as in `[controller]`
    ack_polling: `true`: an address-only write is no request, but EEPROM polling
    stuck_after: limit of measure `stuck`
    """

    order: tuple[str, ...] = ()
    request: tuple[RequestTable, ...] = ()
    period: Length
    rounds: Annotated[int, Meta(ge=1)] | None = None
    pointer_by: Literal["repeated START", "STOP"] = "repeated START"
    check: Literal["expect", "host"] = "expect"
    ack_polling: bool = False
    stuck_after: Length = Fraction(25, 1000)

    def check_together(self, given: Set[str]) -> None:
        if self.period < SHORTEST_ROUND:
            raise ValueError("period is shorter than 1 us, and no transfer is; make it longer")


class ValueTable(Table, frozen=True, kw_only=True):
    """Input of a sensor chip: exactly one of `fixed`, `rows` and `ramp`. Times count from the start of the run.

    fixed: constant x, y, z
    rows: time, x, y, z, held until the next row: `[["0 s", 0, 0, -1], ["2 s", 0, 0.5, -0.9]]`
    ramp: `"angles"` or `"accelerations"` of the host's frames, in LSB
    first: time of the first frame's numbers, with `ramp`
    period: time between frames, with `ramp`
    unit: `"physical"` (deg/s, g, gauss) or `"LSB"` of the scale that `registers` sets
    """

    fixed: Axes | None = None
    rows: tuple[tuple[Duration, Exact, Exact, Exact], ...] = ()
    ramp: Literal["angles", "accelerations"] | None = None
    first: Duration = Fraction(10, 1000)
    period: Length = Fraction(20, 1000)
    unit: Literal["physical", "LSB"] = "physical"

    def check_together(self, given: Set[str]) -> None:
        if (self.fixed is not None) + bool(self.rows) + (self.ramp is not None) != 1:
            raise ValueError("values need one of fixed, rows and ramp")
        if self.ramp is None and {"first", "period"} & given:
            raise ValueError("first and period belong to ramp; give ramp, or leave them out")


class ChipTable(BusParty, frozen=True, kw_only=True):
    """A sensor chip on SDA and SCL.

    model: adxl345, hmc5883l or itg3200
    address: one of the chip's addresses; otherwise its first
    values: physical input, `[chip.NAME.values]`
    registers: registers set before the run: `{ POWER_CTL = 0x08 }`
    powered: time since power-up when the run begins
    options: choices for undocumented behaviour
    """

    model: str
    address: Address | None = None  # None: the first address that the chip can have
    values: ValueTable
    registers: dict[str, Byte] = {}
    powered: Duration = Fraction(1)
    options: dict[str, Answer] = {}


class OutsideTable(Table, frozen=True, kw_only=True):
    """Wires that another program drives in a `periph_sim.outside.Session`. A plain run needs `log`.

    wires: driven wires: `["SDA", "SCL", "RX"]`
    log: log of a session
    """

    wires: Annotated[tuple[str, ...], Meta(min_length=1)]
    log: str | None = None


class HostTable(Table, frozen=True, kw_only=True):
    """Sends 12-byte frames on RX: six signed 16-bit values, low byte first unless `encoding` changes it.

    baud: bits per second
    error: bit rate error in percent, -50 to 50
    ppm: error of the frame clock, parts per million
    first: first frame
    period: time between frames
    jitter: random delay of each frame; at most `period`
    paced_by: `"schedule"`: frame n is due n periods after the first; `"pause"`: one period after the previous frame
        began, so delays add up
    gap: idle bits between bytes
    frames: number of frames; otherwise until the end
    lose: omitted bytes as [frame, byte] from 0: `[[3, 5]]`
    silent: spans without frames, [begin, length]: `[["1 s", "200 ms"]]`
    twice: frames sent twice, from 0: `[7]`
    motion: frame contents, `[host.motion]`; otherwise a ramp; see sensors.md
    encoding: scale, byte order and overflow, `[host.encoding]`; see sensors.md
    """

    baud: Annotated[int, Meta(ge=1, le=10_000_000)] = 115_200
    error: RateError = Fraction(0)  # percent
    ppm: Ppm = Fraction(0)
    first: Duration = Fraction(2, 1000)
    period: Length = Fraction(20, 1000)
    jitter: Duration = Fraction(0)
    paced_by: Literal["schedule", "pause"] = "schedule"
    gap: Bits = Fraction(0)  # number of idle bits between bytes
    frames: Annotated[int, Meta(ge=0)] | None = None
    lose: tuple[tuple[int, int], ...] = ()
    silent: tuple[tuple[Duration, Duration], ...] = ()
    twice: tuple[Annotated[int, Meta(ge=0)], ...] = ()
    motion: dict[str, object] = {}
    encoding: dict[str, object] = {}

    def check_together(self, given: Set[str]) -> None:
        if self.period * self.baud < 1:
            raise ValueError("period is shorter than a bit of the line, so no frame can be sent in it; make it longer")
        _begins_in_order(self)


def _begins_in_order(table: Controller | HostTable) -> None:
    if table.jitter > table.period:
        raise ValueError("jitter is longer than period, so one would begin before the last; shorten it")


class Case(Table, frozen=True, kw_only=True):
    """A case: the parts of a scene, how long it runs, and the budgets that must hold.

    name: name in messages and tables
    about: description
    duration: simulated time
    start: clock time at the run's begin
    seed: of random values; equal seeds give equal runs
    disable: names of optimizations to switch off, or `"all"`; they change no result
    fidelity: obsolete; accepted without effect
    strict: the run ends with status 2 and the firmware's line as soon as firmware breaks a rule of the manuals,
        such as the range of the I2C module clock
    stall_limit: CPU time that your Python code may take while simulated time stands still; then the run fails with
        status 1 and the line. Off under a debugger; `"0 s"` is no limit
    unit, cable, transceiver, chip, device, controller, rounds, host, serial, watch, outside, fault: tables of the
        parts
    measures: measures of your own: `"late" = "count of record round missed"`
    measures_from: TOML file of measures
    budget: limits, `[[budget]]`
    breaks: budgets that a known bug breaks; `periph-sim check` requires exactly these to break, `run` ignores the
        key
    """

    name: str
    about: str = ""
    duration: Duration
    start: Duration = Fraction(0)
    seed: int = 0
    disable: Disabled = ()
    fidelity: Fidelity = ""
    strict: bool = False
    stall_limit: Duration = Fraction(10)
    unit: dict[str, Unit] = {}
    cable: tuple[Cable, ...] = ()
    transceiver: tuple[TransceiverTable, ...] = ()
    chip: dict[str, ChipTable] = {}
    device: dict[str, DeviceTable] = {}
    controller: Controller | None = None
    rounds: RoundsTable | None = None
    host: HostTable | None = None
    serial: SerialTable | None = None
    watch: dict[str, WatchTable] = {}
    outside: OutsideTable | None = None
    fault: tuple[dict[str, object], ...] = ()
    measures: dict[str, str] = {}
    measures_from: str = ""
    budget: tuple[Budget, ...] = ()
    breaks: tuple[str, ...] = ()
    _source: Source | None = None
    _all_budgets: tuple[Budget, ...] = ()  # all budgets of the file, if some were removed from `budget`
    _replaced: dict[str, str] = {}  # maps a party to a sentence that says that an outside party replaces it

    @classmethod
    def model_validate(cls, tree: object) -> Case:
        """Return the case in a tree. Raise BadTable if the tree is not valid."""
        return convert(cls, tree).completed()

    def completed(self) -> Case:
        """Return this case with a budget for each reply that it expects and each wire that it watches.

        Raise BadTable if a table contradicts another table.
        """
        known_budgets = {(budget.name, budget.measure) for budget in self.budget}
        made = [budget for _, budget in self._made_budgets() if (budget.name, budget.measure) not in known_budgets]
        case = self.model_copy(update={"budget": self.budget + tuple(made)})
        known = [budget.name for budget in case.budget]
        strange = [
            Mistake(("breaks", number), f"there is no budget {name!r}; {did_you_mean(name, known)}")
            for number, name in enumerate(case.breaks)
            if name not in known
        ]
        if case.host is not None and case.host.lose:
            last = host_frames().FRAME_BYTES - 1
            strange += [
                Mistake(("host", "lose", number, 1), f"expected 0 to {last}, but it is {byte}")
                for number, (_, byte) in enumerate(case.host.lose)
                if not 0 <= byte <= last
            ]
        if case.controller is not None and case.rounds is not None:
            strange.append(Mistake(("rounds",), "[controller] says its rounds already; leave one of them out"))
        if strange:
            raise BadTable(strange)
        return case

    def _made_budgets(self) -> Iterator[tuple[Place, Budget]]:
        """Yield a budget for each expected reply, silence and watched wire, with the place of its table in the case."""
        serial = self.serial or SerialTable()
        for n, send in enumerate(serial.send):
            if send.expect is not None and send.name is not None:
                yield ("serial", "send", n), Budget(name=send.name, measure=SILENCE + send.name, max=0)
        for n, reply in enumerate(serial.expect):
            within = in_words(reply.within)
            place = ("serial", "expect", n)
            yield place, Budget(name=reply.name, measure=REPLY + reply.name, max=within, why=reply.why)
        for name, watch in self.watch.items():
            most = in_words(watch.tolerance)
            yield ("watch", name), Budget(name=name, measure=WATCH + name, max=most, why=watch.why)

    def from_source(self, source: Source) -> Case:
        """Return this case with the file that it was read from."""
        return self.model_copy(update={"_source": source})

    @property
    def folder(self) -> Path:
        """The folder of the case's file, to which its paths are relative; the current folder if there is no file."""
        return Path() if self._source is None else self._source.path.parent

    @property
    def file(self) -> Path | None:
        """The path of the case's file; None if the case was not read from a file."""
        return None if self._source is None else self._source.path

    def files(self) -> Iterator[Path]:
        """Yield the case's file, the files that its texts may name, and the files that these may import or include."""
        if self._source is not None:
            yield self._source.path
            yield from named_files(self.folder, self._source.values)

    @property
    def changes(self) -> tuple[str, ...]:
        """The `key=value` texts that were applied to the case's file."""
        return () if self._source is None else tuple(change for change, _ in self._source.changes)

    @property
    def replaced(self) -> tuple[str, ...]:
        """A sentence for each party of the case that an outside party replaces."""
        return tuple(self._replaced.values())

    @property
    def rx_sender(self) -> str:
        """The name of the sender on RX: the host, or the outside party that replaces it; "" if only a unit can send."""
        return "the host" if self.host is not None else "the outside" if "host" in self._replaced else ""

    @property
    def checks_host(self) -> bool:
        """True if the bytes that are read from known chips are compared with host frames."""
        rounds = self.controller or self.rounds
        return rounds is not None and rounds.check == "host"

    @property
    def recorded_modules(self) -> dict[str, tuple[str, ...]]:
        """A dictionary from a unit to the entries that a recording has for it.

        The entries are the modules of the unit, and its wires other than SDA, SCL, RX and TX.
        """
        usual = ("SDA", "SCL", "RX", "TX")
        wires = {name: dict.fromkeys(pins.values()) for name, pins in wiring_of(self).pins.items()}
        told: set[str] = set()
        found: dict[str, tuple[str, ...]] = {}
        for name, unit in self.unit.items():
            pairs = [one.pair for one in self.transceiver if one.on.startswith(f"{name}.") or len(self.unit) == 1]
            all_wires = dict.fromkeys([*wires[name], *pairs])
            new = [wire for wire in all_wires if wire not in told and wire not in usual]
            found[name] = (*unit.modules, *(f"pin:{wire}" for wire in new))
            told.update(new)
        return found

    def mistake(self, what: str, *place: str | int) -> BadCase:
        """Return an error about a place in this case, with file and line if it was read from a file."""
        place = self._written(place)
        key = key_of(place, self._named())
        where = f"case {self.name}" if self._source is None else self._source.where(place)
        return BadCase(f"{where}: {key}: {what}")

    def unknown(self, kind: str, name: str, known: Iterable[str], *place: str | int) -> BadCase:
        """Return an error about a name that is none of the known ones. kind: a noun for the thing that it names."""
        return self.mistake(f"there is no {kind} {name!r}; {did_you_mean(name, known)}", *place)

    def line(self, *place: str | int) -> int:
        """Return the line of a key, or of its table, in the case's file; 0 if there is no file or no such key."""
        return 0 if self._source is None else line_of(self._source.text, self._written(place))

    def _named(self) -> dict[str, Any]:
        """Return a tree with the structure of a case that has only the names of budgets, sends and replies."""
        serial = self.serial or SerialTable()
        return {
            "budget": [{"name": budget.name} for budget in self._all_budgets or self.budget],
            "serial": {
                "send": [{"name": send.name} for send in serial.send],
                "expect": [{"name": expect.name} for expect in serial.expect],
            },
        }

    def _written(self, place: tuple[str | int, ...]) -> tuple[str | int, ...]:
        """Convert a place in this case to the place in its file, which may have more budgets than the case.

        A budget that was made for an expected reply or a watched wire has the place of that reply or watch.
        """
        if len(place) < 2 or place[0] != "budget":
            return place
        budget = self.budget[int(place[1])]
        for written, made in self._made_budgets():
            if made == budget:
                return written if written[0] == "watch" else (*written, *place[2:])
        return ("budget", self._all_budgets.index(budget), *place[2:]) if self._all_budgets else place
