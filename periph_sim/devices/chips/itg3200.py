"""ITG-3200 gyroscope: registers, samples of rates in degrees per second, temperature and flags.

    Source (deg/s) --sampled at F_int / (SMPLRT_DIV + 1)--> 14.375 LSB per deg/s, saturation --> GYRO_XOUT_H ...

F_int is the internal sample rate, 1 or 8 kHz.

Not modelled:
- the INT pin and external clocks
- the low-pass filter and its delay: a sample is the value of the source at the instant of the sample
- the tolerances of scale and zero-rate output; the source can include them

Source: InvenSense ITG-3200 Product Specification rev 1.4, sections named at the methods.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from ...core.options import Answers, BoolOption, TextOption, choice
from ...core.registers import Register, RegisterMap
from ...core.state import State
from ...core.time import Clock, Timebase
from .register_chip import Bits, RegisterChip, Source, byte_register, clipped, nearest

SHEET = "ITG-3200 rev 1.4"
MAP_SECTION = f"{SHEET} register map"
DATA = ("GYRO_XOUT_H", "GYRO_XOUT_L", "GYRO_YOUT_H", "GYRO_YOUT_L", "GYRO_ZOUT_H", "GYRO_ZOUT_L")
INT_CFG: Bits = (
    ("ACTL", "7"),
    ("OPEN", "6"),
    ("LATCH_INT_EN", "5"),
    ("INT_ANYRD_2CLEAR", "4"),
    ("ITG_RDY_EN", "2"),
    ("RAW_RDY_EN", "0"),
)
PWR_MGM: Bits = (
    ("H_RESET", "7"),
    ("SLEEP", "6"),
    ("STBY_XG", "5"),
    ("STBY_YG", "4"),
    ("STBY_ZG", "3"),
    ("CLK_SEL", "2:0"),
)

MAP = RegisterMap(
    "ITG-3200",
    SHEET,
    (
        byte_register(0x00, "WHO_AM_I", "R/W", 0x68, MAP_SECTION, (("ID", "6:1"), ("BIT0", "0"))),
        byte_register(0x15, "SMPLRT_DIV", "R/W", 0x00, MAP_SECTION),
        byte_register(0x16, "DLPF_FS", "R/W", 0x00, MAP_SECTION, (("FS_SEL", "4:3"), ("DLPF_CFG", "2:0"))),
        byte_register(0x17, "INT_CFG", "R/W", 0x00, MAP_SECTION, INT_CFG),
        byte_register(0x1A, "INT_STATUS", "R", 0x00, MAP_SECTION, (("ITG_RDY", "2"), ("RAW_DATA_RDY", "0"))),
        byte_register(0x1B, "TEMP_OUT_H", "R", 0x00, MAP_SECTION),
        byte_register(0x1C, "TEMP_OUT_L", "R", 0x00, MAP_SECTION),
        *(byte_register(0x1D + i, name, "R", 0x00, MAP_SECTION) for i, name in enumerate(DATA)),
        byte_register(0x3E, "PWR_MGM", "R/W", 0x00, MAP_SECTION, PWR_MGM),
    ),
)


ADDRESSES = (0x68, 0x69)  # I2C addresses with the pin AD0 low and high
LSB_PER_DEG_S = Fraction(115, 8)  # LSB in one deg/s: 14.375
REGISTER_ACCESS = Fraction(20, 1000)  # seconds from power-on to the first register access
START_UP = Fraction(50, 1000)  # seconds from power-on, from H_RESET, or from the end of sleep until the gyroscopes run
PLL_SETTLING = Fraction(1, 1000)
FIRST_RESERVED, LAST_RESERVED = 0x23, 0x3C  # registers 35 to 60, from which the pointer does not advance
SHOWN = ("TEMP_OUT_H", "TEMP_OUT_L", *DATA)
ROOM = 25.0  # default temperature in degrees Celsius


class Itg3200Options(Answers):
    who_am_i_bit_0: TextOption = choice("ad0", "zero", question="Bit 0 of WHO_AM_I, which is not part of the ID field.")
    who_am_i_write: TextOption = choice(
        "stored", "changes_address", question="Does writing WHO_AM_I change the address it answers?"
    )
    pointer_stops: TextOption = choice(
        "first_reserved",
        "last_before",
        question="Where the pointer stays after GYRO_ZOUT_L: on 0x23, which reads 0, or on 0x22.",
    )
    fs_sel_other: TextOption = choice(
        "as_3", "halves_each_step", question="Full scale with FS_SEL 0, 1, 2: as with 3, or 250, 500, 1000 deg/s."
    )
    burst: TextOption = choice("coherent", "live", question="Do the bytes of one burst belong to one sample?")
    standby_axis: TextOption = choice("holds", "zero", question="What the registers of an axis in standby show.")
    reset_blocks_bus: BoolOption = choice(False, True, question="Is there no register access for 20 ms after H_RESET?")


class Itg3200(RegisterChip):
    """The chip. `RegisterPointer` connects it to a bus.

    temperature: function that returns degrees Celsius at a tick.
    """

    STATE = State("address _clock _taken _ready_shown _shown _burst _scale_known", ticks="_awake _settled")
    MAP = MAP
    SECTION = f"{SHEET} register map"
    ADDRESSES = ADDRESSES
    OPTIONS = Itg3200Options
    DATA = DATA
    UNIT = "deg/s"

    def __init__(
        self,
        timebase: Timebase,
        source: Source,
        address: int = ADDRESSES[0],
        options: Itg3200Options | None = None,
        powered: int = 0,
        temperature: Callable[[int], float] = lambda tick: ROOM,
    ) -> None:
        super().__init__(timebase, source, address, powered, REGISTER_ACCESS)
        self.options = options or Itg3200Options()
        self.temperature = temperature
        self._clock: Clock | None  # clock of samples; None while asleep
        self._taken: int  # number of samples of `_clock` that were due so far; the registers have only the last of them
        self._awake: int  # tick at which the gyroscopes have started up
        self._settled: int  # tick at which the clock source is ready
        self._ready_shown: bool  # True if INT_STATUS.ITG_RDY was set since the clock source was last started
        self._shown = dict.fromkeys(SHOWN, 0)  # contents of the temperature and data registers
        self._burst: dict[str, int]  # `_shown` as it was when the present burst began
        self._scale_known = True  # True if FS_SEL was 3 when the last sample was taken
        self._ad0 = ADDRESSES.index(address)
        self._identify()
        self._start(powered)

    @property
    def rate(self) -> Fraction:
        """Sample rate in Hz: F_int / (SMPLRT_DIV + 1). F_int is 8 kHz if DLPF_CFG is 0, else 1 kHz."""
        internal = 1000 if self.get("DLPF_FS", "DLPF_CFG") else 8000
        return Fraction(internal, self.get("SMPLRT_DIV") + 1)

    @property
    def lsb_per_unit(self) -> Fraction:
        """Number of LSB in one deg/s with the present FS_SEL."""
        if self.options.fs_sel_other.unrecorded() == "halves_each_step":
            return LSB_PER_DEG_S * (8 >> self.get("DLPF_FS", "FS_SEL"))
        return LSB_PER_DEG_S

    def begin(self, now: int) -> bool:
        self.advance_to(now)
        self._burst = dict(self._shown)
        return super().begin(now)

    def following(self, number: int) -> int:
        """Return the number of the next register, or `number` if it is in the reserved range 35 to 60.

        With the option pointer_stops = last_before, the pointer stays at 34, the register before the reserved ones. The
        data sheet reserves the registers 33 to 60, although 33 and 34 are GYRO_ZOUT. This model reserves 35 to 60.
        """
        if FIRST_RESERVED <= number <= LAST_RESERVED:
            return number
        stops = number + 1 == FIRST_RESERVED and self.options.pointer_stops.assume(self.touched) == "last_before"
        if stops:
            return number
        return super().following(number)

    # Samples ------------------------------------------------------------------------

    def advance_to(self, now: int) -> None:
        if not self._ready_shown and now >= self._settled and self.get("INT_CFG", "ITG_RDY_EN"):
            self._ready_shown = True
            self.put("INT_STATUS", "ITG_RDY", 1)
        if self._clock is None:
            return
        due = self._clock.cycle_after(now)
        if due > self._taken:
            self._taken = due
            self._sample(self._clock.tick(due - 1))
            if self.get("INT_CFG", "RAW_RDY_EN"):
                self.put("INT_STATUS", "RAW_DATA_RDY", 1)

    def _sample(self, tick: int) -> None:
        """Store the values at this tick in the data registers. An option decides what an axis in standby shows."""
        self._show("TEMP_OUT", nearest((self.temperature(tick) - 35) * 280) - 13200)
        scale = self.lsb_per_unit
        self._scale_known = self.get("DLPF_FS", "FS_SEL") == 3
        for axis, value in zip("XYZ", self.source(tick), strict=True):
            if not self.get("PWR_MGM", f"STBY_{axis}G"):
                self._show(f"GYRO_{axis}OUT", nearest(value * scale))
                continue
            if self.options.standby_axis.assume(self.touched) == "zero":
                self._show(f"GYRO_{axis}OUT", 0)

    def _show(self, name: str, value: int) -> None:
        word = clipped(value, -0x8000, 0x7FFF) & 0xFFFF
        self._shown[f"{name}_H"], self._shown[f"{name}_L"] = word >> 8, word & 0xFF

    # Accesses -----------------------------------------------------------------------

    def on_register_read(self, now: int, register: Register) -> int:
        if register.name in SHOWN:
            value = self._data(register.name)
        else:
            value = super().on_register_read(now, register)
        if register.name == "WHO_AM_I" and self._ad0:
            self.options.who_am_i_bit_0.assume(self.touched)
        if register.name == "INT_STATUS" or self.get("INT_CFG", "INT_ANYRD_2CLEAR"):
            self.stored[self.MAP["INT_STATUS"].offset] = 0
        return value

    def _data(self, name: str) -> int:
        if name in DATA and not self._scale_known:
            self.options.fs_sel_other.assume(self.touched)
        if self._burst != self._shown and self.options.burst.assume(self.touched) == "coherent":
            return self._burst[name]
        return self._shown[name]

    def on_register_write(self, now: int, register: Register, old: int) -> None:
        name, value = register.name, self.stored[register.offset]
        if name == "DLPF_FS":
            if self.get(name, "FS_SEL") != 3:
                found = self.get(name, "FS_SEL")
                self.note("duty", f"FS_SEL = {found} is reserved; 3 is the full scale", f"{SHEET} DLPF_FS")
            if self.get(name, "DLPF_CFG") == 7:
                self.note("duty", "DLPF_CFG = 7 is reserved; 1 kHz is used here", f"{SHEET} DLPF_FS")
        if name in ("DLPF_FS", "SMPLRT_DIV") and value != old and self._clock is not None:
            self._sample_from(max(now, self._awake))
        elif name == "PWR_MGM":
            self._power(now, old)
        elif name == "WHO_AM_I" and self.options.who_am_i_write.assume(self.touched) == "changes_address":
            self.address = self.get("WHO_AM_I", "ID") << 1 | self._ad0

    def _power(self, now: int, old: int) -> None:
        if self.get("PWR_MGM", "H_RESET"):
            self._reset(now)
            return
        changed = old ^ self.get("PWR_MGM")
        source = self.get("PWR_MGM", "CLK_SEL")
        if source > 5:
            self.note("duty", f"CLK_SEL = {source} is reserved", f"{SHEET} PWR_MGM")
        elif source > 3:
            self.note(
                "unknown",
                f"CLK_SEL = {source} selects an external clock; this model keeps its internal rate",
                f"{SHEET} PWR_MGM",
            )
        if changed & 0x07:
            self._settled, self._ready_shown = self.after(now, PLL_SETTLING), False
        if changed & 0x40:
            self._start(now)

    def _reset(self, now: int) -> None:
        """Perform H_RESET: all registers are as after power-on, the bit clears itself, and the gyroscopes restart."""
        self.stored = {register.offset: register.reset for register in self.MAP}
        self._shown = dict.fromkeys(SHOWN, 0)
        self._identify()
        if self.options.reset_blocks_bus.assume(self.touched):
            self.ready = self.after(now, REGISTER_ACCESS)
        self._start(now)

    def _start(self, now: int) -> None:
        """Start the gyroscopes, or stop sampling if SLEEP is set.

        The gyroscopes start up for 50 ms. The first sample follows one period later.
        """
        self._clock = None
        if not self.get("PWR_MGM", "SLEEP"):
            self._settled, self._ready_shown = self.after(now, PLL_SETTLING), False
            self._awake = self.after(now, START_UP)
            self._sample_from(self._awake)

    def _sample_from(self, begin: int) -> None:
        self._clock, self._taken = self.beats(self.after(begin, 1 / self.rate), self.rate), 0

    def _identify(self) -> None:
        """Set the address according to pin AD0. Bit 0 of WHO_AM_I shows AD0 or 0, as `who_am_i_bit_0` selects."""
        self.address = ADDRESSES[self._ad0]
        self.put("WHO_AM_I", "BIT0", self._ad0 if self.options.who_am_i_bit_0.unrecorded() == "ad0" else 0)


CHIP = Itg3200
