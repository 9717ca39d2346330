"""The tables of the parties around the units of a case: controller, host, sensor chips, and outside parties."""

from __future__ import annotations

from collections.abc import Set
from fractions import Fraction
from typing import Annotated, Literal

from msgspec import Meta

from ...core.phrases import counted
from ...core.table import Duration, HexBytes, Table
from .device_tables import BusParty
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

SHORTEST_ROUND = Fraction(1, 1_000_000)  # minimum period of rounds, in seconds: a byte takes longer even at 5 MHz


class RequestTable(Table, frozen=True, kw_only=True):
    """One request of a round. It has either `chip` or `address`.

    chip: gyroscope, accelerometer or magnetometer; implies address, pointer and count
    name: name in messages; the chip or address if omitted
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
    ppm: clock error, parts per million. SCL low and high times are rounded to the nearest tick, rounds do not drift
    low, high: SCL low and high time; half a period of `rate` if omitted
    hold: time from an SCL fall to the SDA change; at most `low`
    filter: pulses on SDA shorter than this are ignored (Fast-mode: 50 ns)
    first: time of the first round
    period: time between rounds
    jitter: largest random delay of a round; at most `period`
    gap: time between transfers of a round; at least the bus-free time
    rounds: number of rounds; if omitted, rounds continue to the end of the run
    pointer_by: what follows the register pointer before the read: `"repeated START"` or `"STOP"`
    order: known chips to read: gyroscope, accelerometer, magnetometer, or a plugin's
    request: further requests, `[[controller.request]]`
    initialise: time before `first` at which the known chips are identified and set up
    check: `"host"`: the bytes read from known chips are compared with the host's frames. If the firmware has sensor
        models, they are compared with the models' results. Then the unit needs a pin that is high while the models
        run: `pins = { MODEL = 34 }`
    on_nack: after a written byte without ACK: `"go on"` with the next phase or `"give up"` with a STOP
    stuck_after: a line low this long is reported with its holder
    clear_after: if a START is due but the bus stays busy with SCL high (SDA low, or no STOP), time until a bus clear
        (UM10204 section 3.1.16): up to nine clocks, then STOP
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
    rounds: number of rounds due; if omitted, rounds are due to the end of the run
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
    ramp: `"angles"` or `"accelerations"` of the ramp that a host without `motion` sends, in LSB
    first: with `ramp`, time from which the numbers of the first frame apply
    period: with `ramp`, time between frames
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
    address: one of the chip's addresses; the first of them if omitted
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
    """Wires that another program drives in a `periph_sim.outside.Session`. A run without a session needs `log`, from
    which it replays the levels of these wires.

    wires: driven wires: `["SDA", "SCL", "RX"]`
    log: log of a session
    """

    wires: Annotated[tuple[str, ...], Meta(min_length=1)]
    log: str | None = None


HOST_SEED = 1  # the seed of the delays of frames is the seed of the case plus this number


class HostTable(Table, frozen=True, kw_only=True):
    """Sends 12-byte frames on RX: six signed 16-bit values, low byte first unless `encoding` changes it.

    baud: bits per second
    error: bit rate error in percent, -50 to 50
    ppm: error of the frame clock, parts per million
    first: time of the first frame
    period: time between frames
    jitter: largest random delay of a frame; at most `period`
    paced_by: `"schedule"`: frame n is due n periods after the first; `"pause"`: one period after the previous frame
        began, so delays add up
    gap: idle bits between bytes
    frames: number of frames; if omitted, frames continue to the end of the run
    lose: omitted bytes as [frame, byte] from 0: `[[3, 5]]`
    silent: spans without frames, [begin, length]: `[["1 s", "200 ms"]]`
    twice: frames sent twice, numbered from 0: `[7]`
    motion: frame contents, `[host.motion]`; a ramp if omitted; see sensors.md
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
        raise ValueError("jitter is longer than period, so starts could be out of order; shorten it")
