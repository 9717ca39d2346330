"""ADXL345 accelerometer: registers, samples of an acceleration in g, flags and the FIFO.

    Source (g) --output rate--> offset, range, format --> Fifo --> DATAX0 to DATAZ1, INT_SOURCE, FIFO_STATUS

Not modelled:
- detection of tap, activity, inactivity and free fall; a note is added when one of these events is enabled
- AUTO_SLEEP and the self-test force
- the filter: a sample is the value of the source at the instant of the sample
- the INT pins, and so the event that triggers the FIFO in trigger mode
- the minimum of 5 us between two reads of the FIFO: on a bus of up to 400 kHz, the reads are always further apart

Source: ADXL345 data sheet Rev 0, register map, FIFO section and the sections named at the methods.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from fractions import Fraction

from ...core.options import Answers, IntOption, TextOption, choice
from ...core.registers import Register, RegisterMap
from ...core.state import State
from ...core.time import Clock, Timebase
from .register_chip import Bits, RegisterChip, Source, byte_register, clipped, nearest

SHEET = "ADXL345 Rev 0"
MAP_SECTION = f"{SHEET} register map"
OFFSETS = ("OFSX", "OFSY", "OFSZ")
DATA = ("DATAX0", "DATAX1", "DATAY0", "DATAY1", "DATAZ0", "DATAZ1")
EVENTS: Bits = (
    ("DATA_READY", "7"),
    ("SINGLE_TAP", "6"),
    ("DOUBLE_TAP", "5"),
    ("Activity", "4"),
    ("Inactivity", "3"),
    ("FREE_FALL", "2"),
    ("Watermark", "1"),
    ("Overrun", "0"),
)
AXES_OF_ACTIVITY: Bits = (
    ("ACT_ac_dc", "7"),
    ("ACT_X", "6"),
    ("ACT_Y", "5"),
    ("ACT_Z", "4"),
    ("INACT_ac_dc", "3"),
    ("INACT_X", "2"),
    ("INACT_Y", "1"),
    ("INACT_Z", "0"),
)
TAP_AXES: Bits = (("Suppress", "3"), ("TAP_X", "2"), ("TAP_Y", "1"), ("TAP_Z", "0"))
TAP_STATUS: Bits = (
    ("ACT_X", "6"),
    ("ACT_Y", "5"),
    ("ACT_Z", "4"),
    ("Asleep", "3"),
    ("TAP_X", "2"),
    ("TAP_Y", "1"),
    ("TAP_Z", "0"),
)
POWER_CTL: Bits = (("Link", "5"), ("AUTO_SLEEP", "4"), ("Measure", "3"), ("Sleep", "2"), ("Wakeup", "1:0"))
DATA_FORMAT: Bits = (
    ("SELF_TEST", "7"),
    ("SPI", "6"),
    ("INT_INVERT", "5"),
    ("FULL_RES", "3"),
    ("Justify", "2"),
    ("Range", "1:0"),
)

MAP = RegisterMap(
    "ADXL345",
    SHEET,
    (
        byte_register(0x00, "DEVID", "R", 0xE5, MAP_SECTION),
        byte_register(0x1D, "THRESH_TAP", "R/W", 0x00, MAP_SECTION),
        *(byte_register(0x1E + i, name, "R/W", 0x00, MAP_SECTION) for i, name in enumerate(OFFSETS)),
        byte_register(0x21, "DUR", "R/W", 0x00, MAP_SECTION),
        byte_register(0x22, "Latent", "R/W", 0x00, MAP_SECTION),
        byte_register(0x23, "Window", "R/W", 0x00, MAP_SECTION),
        byte_register(0x24, "THRESH_ACT", "R/W", 0x00, MAP_SECTION),
        byte_register(0x25, "THRESH_INACT", "R/W", 0x00, MAP_SECTION),
        byte_register(0x26, "TIME_INACT", "R/W", 0x00, MAP_SECTION),
        byte_register(0x27, "ACT_INACT_CTL", "R/W", 0x00, MAP_SECTION, AXES_OF_ACTIVITY),
        byte_register(0x28, "THRESH_FF", "R/W", 0x00, MAP_SECTION),
        byte_register(0x29, "TIME_FF", "R/W", 0x00, MAP_SECTION),
        byte_register(0x2A, "TAP_AXES", "R/W", 0x00, MAP_SECTION, TAP_AXES),
        byte_register(0x2B, "ACT_TAP_STATUS", "R", 0x00, MAP_SECTION, TAP_STATUS),
        byte_register(0x2C, "BW_RATE", "R/W", 0x0A, MAP_SECTION, (("LOW_POWER", "4"), ("Rate", "3:0"))),
        byte_register(0x2D, "POWER_CTL", "R/W", 0x00, MAP_SECTION, POWER_CTL),
        byte_register(0x2E, "INT_ENABLE", "R/W", 0x00, MAP_SECTION, EVENTS),
        byte_register(0x2F, "INT_MAP", "R/W", 0x00, MAP_SECTION, EVENTS),
        byte_register(0x30, "INT_SOURCE", "R", 0x02, MAP_SECTION, EVENTS),
        byte_register(0x31, "DATA_FORMAT", "R/W", 0x00, MAP_SECTION, DATA_FORMAT),
        *(byte_register(0x32 + i, name, "R", 0x00, MAP_SECTION) for i, name in enumerate(DATA)),
        byte_register(
            0x38, "FIFO_CTL", "R/W", 0x00, MAP_SECTION, (("Mode", "7:6"), ("Trigger", "5"), ("Samples", "4:0"))
        ),
        byte_register(0x39, "FIFO_STATUS", "R", 0x00, MAP_SECTION, (("FIFO_TRIG", "7"), ("Entries", "5:0"))),
    ),
)


DEPTH = 32
HELD = DEPTH + 1  # maximum number of samples that can be read: those of the FIFO and one at the filter's output


BYPASS, FIFO = 0, 1  # values of FIFO_CTL.Mode; 2 is stream and 3 is trigger


class Fifo:
    """The output register and the FIFO, with DATA_READY, Overrun and the number of entries.

        sample --> bypass: output register
               --> FIFO, stream, trigger: 32 samples and one more at the output of the filter --> output register

    output: the six bytes of the data registers.
    mode: FIFO_CTL.Mode.
    samples: FIFO_CTL.Samples, the watermark.
    """

    STATE = State("output mode samples overrun _unread _waiting")

    def __init__(self, overrun_when_filled: bool) -> None:
        self.output = bytes(6)
        self.mode = BYPASS
        self.samples = 0  # FIFO_CTL.Samples, the watermark
        self.overrun = False
        self._unread = False  # True in bypass mode if the sample in the output register was not read yet
        self._waiting: deque[bytes] = deque()
        self._overrun_when_filled = overrun_when_filled

    @property
    def entries(self) -> int:
        return len(self._waiting)

    @property
    def data_ready(self) -> bool:
        return self._unread if self.mode == BYPASS else bool(self._waiting)

    @property
    def watermark(self) -> bool:
        """True if the FIFO has at least FIFO_CTL.Samples entries.

        At power-on there are no entries and Samples is 0, so this is True, and INT_SOURCE reads 0x02.
        """
        return self.entries >= self.samples

    def set_up(self, mode: int, samples: int) -> None:
        """Apply a write of FIFO_CTL. Bypass empties the FIFO; the other modes keep its contents.

        If the mode changes, Overrun is cleared, and the sample in the output register counts as read.
        """
        if mode == BYPASS:
            self._waiting.clear()
        if mode != self.mode:
            self.overrun = self._unread = False
        self.mode, self.samples = mode, samples

    def push(self, sample: bytes) -> None:
        """Add a new sample from the filter.

        If the FIFO is full, FIFO mode drops the new sample, and the modes stream and trigger drop the oldest sample.
        """
        if self.mode == BYPASS:
            self.overrun |= self._unread
            self.output, self._unread = sample, True
            return
        lost = len(self._waiting) == HELD
        if not (lost and self.mode == FIFO):
            self._waiting.append(sample)
            if lost:
                self._waiting.popleft()
        self.overrun |= len(self._waiting) >= DEPTH if self._overrun_when_filled else lost

    def latch(self) -> bytes:
        """Remove the oldest sample from the FIFO and return it for a burst of reads.

        If the FIFO is empty, return the sample in the output register. The whole sample counts as read, even if the
        burst reads only some of its bytes. Overrun is cleared.
        """
        if self._waiting:
            self.output = self._waiting.popleft()
        self._unread = self.overrun = False
        return self.output


ADDRESSES = (0x53, 0x1D)  # I2C addresses with the pin SDO/ALT ADDRESS low and high
LSB_PER_G = 256
OFFSETS_PER_G = 64  # number of LSB of an offset register in one g: 15.6 mg/LSB
TURN_ON = Fraction(11, 10_000)  # delay of the first sample after Measure is set, in seconds, in addition to one period
LAST = 0x39
UNMODELLED = 0x7C  # bits of INT_ENABLE whose events are not modelled: taps, activity, inactivity, free fall


class Adxl345Options(Answers):
    pointer_past_end: TextOption = choice(
        "goes_on", "wraps_to_0", "stays", question="Where the pointer goes after the last register, 0x39."
    )
    rate_change: TextOption = choice(
        "restarts", "after_next_sample", question="When a new rate begins to count while the chip measures."
    )
    overrun_in_fifo: TextOption = choice(
        "when_filled", "when_lost", question="What sets Overrun in FIFO, stream and trigger mode."
    )
    entries_most: IntOption = choice(32, 33, question="What FIFO_STATUS shows while 33 samples can be read.")


class Adxl345(RegisterChip):
    """The chip, which acknowledges its address from power-up on. `RegisterPointer` connects it to a bus."""

    STATE = State("fifo _clock _taken _latched")
    MAP = MAP
    SECTION = f"{SHEET}, register map: reserved, do not access"
    ADDRESSES = ADDRESSES
    OPTIONS = Adxl345Options
    DATA = DATA
    BYTE_ORDER = "little"
    UNIT = "g"

    def __init__(
        self,
        timebase: Timebase,
        source: Source,
        address: int = ADDRESSES[0],
        options: Adxl345Options | None = None,
        powered: int = 0,
    ) -> None:
        super().__init__(timebase, source, address, powered, ready=Fraction(0))
        self.options = options or Adxl345Options()
        self.fifo = Fifo(self.options.overrun_in_fifo.unrecorded() == "when_filled")
        self._clock: Clock | None = None  # clock of the samples; None in standby and sleep
        self._taken = 0  # number of periods of `_clock` whose samples were taken
        self._latched: bytes | None = None  # the sample that the present burst reads; None before its first data byte

    @property
    def rate(self) -> Fraction:
        """Sample rate in Hz. Rev 0 of the data sheet lists only the BW_RATE codes 6 to 15; later revisions list all."""
        return Fraction(3200, 2 ** (15 - self.get("BW_RATE", "Rate")))

    @property
    def lsb_per_unit(self) -> Fraction:
        """Number of LSB in one g with the present DATA_FORMAT, for right-justified data."""
        return Fraction(LSB_PER_G, 1 if self.get("DATA_FORMAT", "FULL_RES") else 2 ** self.get("DATA_FORMAT", "Range"))

    def quantity(self, word: int) -> str:
        return super().quantity(word >> 16 - self._bits if self.get("DATA_FORMAT", "Justify") else word)

    def begin(self, now: int) -> bool:
        self._latched = None
        return super().begin(now)

    def following(self, number: int) -> int:
        if number != LAST:
            return super().following(number)
        goes = self.options.pointer_past_end.assume(self.touched)
        if goes == "goes_on":
            return super().following(number)
        return 0 if goes == "wraps_to_0" else number

    @property
    def _bits(self) -> int:
        """Number of bits of a sample with the present DATA_FORMAT."""
        return 10 + self.get("DATA_FORMAT", "Range") * self.get("DATA_FORMAT", "FULL_RES")

    # Samples ------------------------------------------------------------------------

    def advance_to(self, now: int) -> None:
        if self._clock is None:
            return
        due = self._clock.cycle_after(now)
        new = range(self._taken, due)
        self._taken = max(due, self._taken)
        # At most 66 samples are computed, because they are enough to fill the FIFO and set Overrun. In FIFO mode these
        # are the first samples, because later ones are dropped. In the other modes they are the newest samples.
        most = 2 * 33
        if len(new) > most:
            new = new[:most] if self.fifo.mode == FIFO else new[-most:]
        for number in new:
            self.fifo.push(self.formatted(self.source(self._clock.tick(number))))

    def formatted(self, g: Sequence[float | Fraction]) -> bytes:
        """Return the data bytes of accelerations in g, with the present offsets, resolution and justification."""
        bits = self._bits
        scale = self.lsb_per_unit
        data = b""
        for axis, value in enumerate(g):
            offset = self.get(OFFSETS[axis])
            word = nearest(value * scale + (offset - 256 if offset & 0x80 else offset) * scale / OFFSETS_PER_G)
            word = clipped(word, -(1 << bits - 1), (1 << bits - 1) - 1)
            if self.get("DATA_FORMAT", "Justify"):
                word <<= 16 - bits
            data += (word & 0xFFFF).to_bytes(2, "little")
        return data

    # Accesses -----------------------------------------------------------------------

    def on_register_read(self, now: int, register: Register) -> int:
        if register.name in DATA:
            if self._latched is None:
                self._latched = self.fifo.latch()
            return self._latched[DATA.index(register.name)]
        if register.name == "INT_SOURCE":
            self.put("INT_SOURCE", "DATA_READY", self.fifo.data_ready)
            self.put("INT_SOURCE", "Watermark", self.fifo.watermark)
            self.put("INT_SOURCE", "Overrun", self.fifo.overrun)
            if self.fifo.entries >= DEPTH:
                self.options.overrun_in_fifo.assume(self.touched)
        elif register.name == "FIFO_STATUS":
            entries = self.fifo.entries
            if entries > DEPTH:
                entries = min(entries, self.options.entries_most.assume(self.touched))
            self.put("FIFO_STATUS", "Entries", entries)
        return super().on_register_read(now, register)

    def on_register_write(self, now: int, register: Register, old: int) -> None:
        value = self.stored[register.offset]
        if register.name == "POWER_CTL":
            if value & 0x10:
                self.note("unknown", "AUTO_SLEEP is set; this model never enters sleep by itself", f"{SHEET} POWER_CTL")
            if (value ^ old) & 0x0C:
                self._start(now)
        elif register.name == "BW_RATE":
            self._rate_changed(now, old)
        elif register.name == "FIFO_CTL":
            self.fifo.set_up(self.get("FIFO_CTL", "Mode"), self.get("FIFO_CTL", "Samples"))
        elif register.name == "INT_ENABLE" and value & UNMODELLED:
            self.note(
                "unknown",
                f"INT_ENABLE = {value:#04x}: taps, activity, inactivity and free fall are not detected by this model",
                f"{SHEET} INT_ENABLE",
            )
        elif register.name == "DATA_FORMAT" and value & 0x80:
            self.note("unknown", "SELF_TEST is set; this model adds no force", f"{SHEET} DATA_FORMAT")

    def _start(self, now: int) -> None:
        """Start or stop sampling after a change of Measure or Sleep.

        The chip samples while Measure is set and Sleep is clear. The first sample comes after one period and 1.1 ms.
        """
        self._clock, self._taken = None, 0
        if self.get("POWER_CTL", "Measure") and not self.get("POWER_CTL", "Sleep"):
            self._clock = self.beats(self.after(now, 1 / self.rate + TURN_ON), self.rate)

    def _rate_changed(self, now: int, old: int) -> None:
        code, low_power = self.get("BW_RATE", "Rate"), self.get("BW_RATE", "LOW_POWER")
        if low_power and not 0x7 <= code <= 0xC:
            self.note("duty", f"LOW_POWER is set with rate code {code:#x}; 0x7 to 0xC allow it", f"{SHEET} BW_RATE")
        if self._clock is None or not (old ^ code) & 0x0F:
            return
        if self.options.rate_change.assume(self.touched) == "restarts":
            first = self.after(now, 1 / self.rate)
        else:
            first = self._clock.tick(self._taken)
        self._clock, self._taken = self.beats(first, self.rate), 0


CHIP = Adxl345
