"""HMC5883L magnetometer: registers, measurements of a field in gauss, RDY and LOCK.

    Source (gauss) --single or at the output rate--> average, bias, gain, overflow --> DXRA to DYRB (x, z, y), Status

The instants of the samples that are averaged are not documented. Here they are evenly spaced over the output period, or
over the 6 ms of a single measurement, with the last sample at the end. The 3.4 MHz mode is not modelled, nor is the pin
DRDY, which signals new data with a pulse of 250 us.

Source: Honeywell HMC5883L data sheet, sections named at the methods.
"""

from __future__ import annotations

from fractions import Fraction

from ...core.options import Answers, BoolOption, IntOption, TextOption, choice
from ...core.registers import Register, RegisterMap
from ...core.state import State
from ...core.time import Clock, Timebase
from .register_chip import RegisterChip, Source, byte_register, nearest

SHEET = "HMC5883L data sheet"
MAP_SECTION = f"{SHEET}, register list"
# The data registers in the order of their addresses: x, z, y, each with the high byte first.
DATA = ("DXRA", "DXRB", "DZRA", "DZRB", "DYRA", "DYRB")

MAP = RegisterMap(
    "HMC5883L",
    SHEET,
    (
        byte_register(0x00, "CRA", "R/W", 0x10, MAP_SECTION, (("MA", "6:5"), ("DO", "4:2"), ("MS", "1:0"))),
        byte_register(0x01, "CRB", "R/W", 0x20, MAP_SECTION, (("GN", "7:5"), ("ZERO", "4:0"))),
        byte_register(0x02, "Mode", "R/W", 0x01, MAP_SECTION, (("HS", "7"), ("MD", "1:0"))),
        *(byte_register(0x03 + i, name, "R", 0x00, MAP_SECTION) for i, name in enumerate(DATA)),
        byte_register(0x09, "Status", "R", 0x00, MAP_SECTION, (("LOCK", "1"), ("RDY", "0"))),
        byte_register(0x0A, "IRA", "R", ord("H"), MAP_SECTION),
        byte_register(0x0B, "IRB", "R", ord("4"), MAP_SECTION),
        byte_register(0x0C, "IRC", "R", ord("3"), MAP_SECTION),
    ),
)


ADDRESSES = (0x1E,)
LSB_PER_GAUSS = (1370, 1090, 820, 660, 440, 390, 330, 230)  # for each value of CRB.GN, the number of LSB in one gauss
# For each value of CRA.DO, the output rate in Hz. The value 7 is reserved.
RATES = tuple(Fraction(rate) for rate in ("0.75", "1.5", "3", "7.5", "15", "30", "75", "75"))
LEAST, MOST, OVERFLOW = -2048, 2047, -4096
BIAS = (Fraction("1.16"), Fraction("1.16"), Fraction("1.08"))  # bias of the self-test in gauss on x, y, z
BUS_READY = Fraction(200, 10**6)
ANALOG_READY = Fraction(50, 1000)
SINGLE = Fraction(6, 1000)
WRITING = Fraction(250, 10**6)  # seconds for which RDY is low after new data were placed in the registers
CONTINUOUS, ONE = 0, 1  # values of Mode.MD


class Hmc5883lOptions(Answers):
    idle_code: IntOption = choice(2, 3, question="What Mode.MD reads after a single measurement.")
    power_on_measures: BoolOption = choice(
        False, True, question="Does the chip make the single measurement of its power-on mode by itself?"
    )
    rdy_clears: TextOption = choice("all_six", "any", question="How many data registers must be read to clear RDY.")


class Hmc5883l(RegisterChip):
    """The chip. `RegisterPointer` connects it to a bus. Addresses without a register read 0."""

    STATE = State("_clock _taken _to_read _gains _unread _mode_unwritten _idle_by_itself", ticks="_placed _analog")
    MAP = MAP
    SECTION = f"{SHEET}, register access"
    ADDRESSES = ADDRESSES
    OPTIONS = Hmc5883lOptions
    DATA = DATA
    UNIT = "gauss"

    def __init__(
        self,
        timebase: Timebase,
        source: Source,
        address: int = ADDRESSES[0],
        options: Hmc5883lOptions | None = None,
        powered: int = 0,
    ) -> None:
        super().__init__(timebase, source, address, powered, BUS_READY)
        self.options = options or Hmc5883lOptions()
        self._analog = self.after(powered, ANALOG_READY)
        self._clock: Clock | None = None  # its cycle n begins at the end of measurement n; None in idle mode
        self._taken = 0
        self._placed = powered  # tick at which data were last placed in the registers
        self._unread = False
        # The data registers that must still be read before LOCK is cleared; all six if none was read yet.
        self._to_read: set[str] = set(DATA)
        # CRB.GN for the next measurement. A second entry, if there is one, is GN for all later measurements.
        self._gains = [self.get("CRB", "GN")]
        self._mode_unwritten = True
        self._idle_by_itself = False
        if self.options.power_on_measures.unrecorded():
            self._start(powered)

    @property
    def rate(self) -> Fraction:
        return RATES[self.get("CRA", "DO")]

    @property
    def lsb_per_unit(self) -> Fraction:
        """Number of LSB in one gauss with the present GN."""
        return Fraction(LSB_PER_GAUSS[self.get("CRB", "GN")])

    def quantity(self, word: int) -> str:
        return "overflow" if word == OVERFLOW else super().quantity(word)

    def following(self, number: int) -> int:
        """Return the register after `number`: 0x03 after 0x08, 0x00 after 0x0C and 0xFF, otherwise `number` + 1."""
        return {0x08: 0x03, 0x0C: 0x00}.get(number, super().following(number))

    # Measurements -------------------------------------------------------------------

    def _start(self, now: int) -> None:
        """Start or stop measuring, according to Mode.MD. A measurement in progress is lost (data sheet, Modes).

        The chip calls this method after a write of Mode, after a change of the output rate in continuous mode and, by
        option, at power-on.
        """
        self._clock, self._taken = None, 0
        begin = max(now, self._analog)
        mode = self.get("Mode", "MD")
        if mode == CONTINUOUS:
            self._clock = self.beats(self.after(begin, 2 / self.rate), self.rate)
        elif mode == ONE:
            self._clock = self.beats(self.after(begin, SINGLE), self.rate)

    def advance_to(self, now: int) -> None:
        if self._clock is None:
            return
        due = self._clock.cycle_after(now)
        if self.get("Mode", "MD") == ONE:
            if due:
                end, self._clock = self._clock.tick(0), None
                self._idle_by_itself = True
                self.put("Mode", "MD", self.options.idle_code.unrecorded())
                self._measured(end, 1, SINGLE)
            return
        if due > self._taken:
            number, self._taken = due - self._taken, due
            self._measured(self._clock.tick(due - 1), number, 1 / self.rate)

    def _measured(self, end: int, number: int, over: Fraction) -> None:
        """Store the data of the last of `number` measurements that ended since the previous call.

        While Status.LOCK is set, the data registers keep their values.

        end: the tick at which the last measurement ended.
        over: the time in seconds over which the last measurement took its samples.
        """
        del self._gains[: min(number, len(self._gains)) - 1]
        gain = LSB_PER_GAUSS[self._gains[0]]
        if len(self._gains) > 1:
            del self._gains[0]
        if self.get("Status", "LOCK"):
            return
        for axis, value in zip("XYZ", self._average(end, over), strict=True):
            counts = nearest(value * gain)
            word = counts & 0xFFFF if LEAST <= counts <= MOST else OVERFLOW & 0xFFFF
            self.stored[self.MAP[f"D{axis}RA"].offset] = word >> 8
            self.stored[self.MAP[f"D{axis}RB"].offset] = word & 0xFF
        self._placed, self._unread, self._to_read = end, True, set(DATA)

    def _average(self, end: int, over: Fraction) -> list[float | Fraction]:
        """Return the mean of 1, 2, 4 or 8 samples (CRA.MA), plus the self-test bias (CRA.MS), in gauss.

        end, over: as for `_measured`.
        """
        number = 1 << self.get("CRA", "MA")
        step = self.timebase.ticks(over, "down") // number
        samples = [self.source(end - step * back) for back in range(number)]
        sign = {1: 1, 2: -1}.get(self.get("CRA", "MS"), 0)
        return [sum(axis[1:], axis[0]) / number + sign * BIAS[n] for n, axis in enumerate(zip(*samples, strict=True))]

    # Accesses -----------------------------------------------------------------------

    def read(self, now: int, number: int) -> int:
        if self.MAP.at(number) is None:
            return 0
        return super().read(now, number)

    def on_register_read(self, now: int, register: Register) -> int:
        name, value = register.name, super().on_register_read(now, register)
        if self._mode_unwritten and name in (*DATA, "Mode", "Status"):
            self.options.power_on_measures.assume(self.touched)
        if name in DATA:
            self._to_read.discard(name)
            self.put("Status", "LOCK", bool(self._to_read))
            if not self._to_read:
                self._to_read = set(DATA)
            if self.options.rdy_clears.unrecorded() == "any" or not self.get("Status", "LOCK"):
                self._unread = False
        elif name == "Mode":
            self.put("Status", "LOCK", 1)
            if self._idle_by_itself:
                self.options.idle_code.assume(self.touched)
        elif name == "Status":
            if 0 < len(self._to_read) < len(DATA):
                self.options.rdy_clears.assume(self.touched)
            written = now >= self.after(self._placed, WRITING)
            return register["RDY"].put(value, self._unread and written)
        return value

    def on_register_write(self, now: int, register: Register, old: int) -> None:
        name, value = register.name, self.stored[register.offset]
        if name in ("CRA", "Mode"):
            self.put("Status", "LOCK", 0)
            self._to_read = set(DATA)
        if name == "CRB":
            if self.get("CRB", "ZERO"):
                self.note("duty", f"CRB = {value:#04x}: bits 4 to 0 must be 0", f"{SHEET} CRB")
            self._gains = [self._gains[0], self.get("CRB", "GN")]
        elif name == "Mode":
            if self.get("Mode", "HS"):
                self.note("unknown", "HS is set; this model has no 3.4 MHz mode", f"{SHEET} Mode")
            self._mode_unwritten = self._idle_by_itself = False
            self._start(now)
        elif name == "CRA":
            self._cra_written(now, old)

    def _cra_written(self, now: int, old: int) -> None:
        if self.get("CRA", "DO") == 7:
            self.note("duty", "DO = 7 is reserved; 75 Hz is used here", f"{SHEET} CRA")
        if self.get("CRA", "MS") == 3:
            self.note("duty", "MS = 3 is reserved; no bias is used here", f"{SHEET} CRA")
        if self.get("CRA", "DO") != self.MAP["CRA"]["DO"].extract(old) and self.get("Mode", "MD") == CONTINUOUS:
            self._start(now)


CHIP = Hmc5883l
