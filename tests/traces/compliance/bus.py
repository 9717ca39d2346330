"""Generator of an exact capture of two I2C transfers whose times, in nanoseconds, can all be set.

     hd_sta  low  high         su_sta hd_sta             su_sto   buf
SCL ------|______|----|__ ... |------|------|__ ... ____|------|---------
SDA --|_____/---------        -------\\_____________________________/---------\\__
            ^ data: time of the change of SDA after the fall of SCL
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import ceil
from pathlib import Path

from periph_sim.traces.capture.capture import Capture, channel_of
from periph_sim.traces.compliance import Mode

NS = 10**9


@dataclass(frozen=True)
class Odd:
    """A bit that differs from the others.

    data: times at which SDA changes, an odd number of them
    low: length of its low phase of SCL
    """

    data: tuple[int, ...] | None = None
    low: int | None = None


@dataclass(frozen=True)
class Spike:
    """A spike on SCL or SDA: `after` a rise of SCL, given by its number, the level is inverted for `length`."""

    line: str
    rise: int
    after: int
    length: int


@dataclass(frozen=True)
class Bus:
    """Times of the bus in nanoseconds.

    odd: differing bits in the first transfer by (byte, place); place 8 is the ACK
    """

    low: int
    high: int
    hd_sta: int
    su_sta: int
    su_sto: int
    buf: int
    data: int
    odd: dict[tuple[int, int], Odd] = field(default_factory=dict)
    spike: Spike | None = None

    def but(self, **changes: object) -> Bus:
        return replace(self, **changes)  # type: ignore[arg-type]


# All times are well within the limits of the mode.
EASY = {
    Mode.STANDARD: Bus(low=6_500, high=5_500, hd_sta=5_500, su_sta=6_500, su_sto=5_500, buf=6_500, data=1_500),
    Mode.FAST: Bus(low=1_700, high=900, hd_sta=900, su_sta=900, su_sto=900, buf=1_700, data=400),
    Mode.FAST_PLUS: Bus(low=700, high=400, hd_sta=400, su_sta=400, su_sto=400, buf=700, data=300),
}

# Write 0xA5 to 0x51; after a repeated START, read 0x5A from it with NACK. Each byte has its ninth bit.
WRITE = ([1, 0, 1, 0, 0, 0, 1, 0, 0], [1, 0, 1, 0, 0, 1, 0, 1, 0])
READ = ([1, 0, 1, 0, 0, 0, 1, 1, 0], [0, 1, 0, 1, 1, 0, 1, 0, 1])


class _Drawn:
    def __init__(self, bus: Bus, begin: int) -> None:
        self.bus = bus
        self.now = begin
        self.scl: list[tuple[int, int]] = [(0, 1)]
        self.sda: list[tuple[int, int]] = [(0, 1)]
        self.rises: list[int] = []

    def start(self) -> None:
        self._sda(0)
        self.now += self.bus.hd_sta

    def byte(self, bits: list[int], odd: dict[int, Odd]) -> None:
        for place, bit in enumerate(bits):
            self._low(bit, odd.get(place, Odd()))
            self.now += self.bus.high

    def again(self) -> None:
        self._low(1, Odd())
        self.now += self.bus.su_sta
        self.start()

    def stop(self) -> None:
        self._low(0, Odd())
        self.now += self.bus.su_sto
        self._sda(1)

    def _low(self, level: int, odd: Odd) -> None:
        """Let SCL fall now, change SDA to `level`, and let SCL rise."""
        self.scl.append((self.now, 0))
        fall = self.now
        if level != self.sda[-1][1]:
            for after in odd.data or (self.bus.data,):
                self.now = fall + after
                self._sda(1 - self.sda[-1][1])
        self.now = fall + (odd.low or self.bus.low)
        self.scl.append((self.now, 1))
        self.rises.append(self.now)

    def _sda(self, level: int) -> None:
        self.sda.append((self.now, level))


def drawn(bus: Bus) -> Capture:
    """Return an exact capture of the bus in nanoseconds."""
    d = _Drawn(bus, 20_000)
    for number in range(2):
        odd = bus.odd if not number else {}
        d.start()
        for place, bits in enumerate(WRITE + READ):
            if place == len(WRITE):
                d.again()
            d.byte(bits, {bit: how for (byte, bit), how in odd.items() if byte == place})
        d.stop()
        d.now += bus.buf
    length = d.now + 20_000
    if bus.spike is not None:
        states = d.scl if bus.spike.line == "SCL" else d.sda
        begin = d.rises[bus.spike.rise] + bus.spike.after
        level = next(level for at, level in reversed(states) if at <= begin)
        states.extend([(begin, 1 - level), (begin + bus.spike.length, level)])
        states.sort()
    channels = tuple(
        channel_of(name, index, [at for at, _ in states], [level for _, level in states], length)
        for index, (name, states) in enumerate((("SCL", d.scl), ("SDA", d.sda)))
    )
    return Capture(Path("bus"), Fraction(NS), length, channels, sampled=False, exact=True)


def sampled(capture: Capture, rate: int, phase: int = 0) -> Capture:
    """Return the capture of an analyser with `rate` samples per second whose first sample is at `phase` nanoseconds."""
    assert capture.rate == NS
    length = (capture.length - phase) * rate // NS
    channels = []
    for channel in capture.channels:
        at = [0] + [max(0, ceil(Fraction((int(edge) - phase) * rate, NS))) for edge in channel.edges]
        levels = [channel.initial, *channel.levels.tolist()]
        kept = [(a, level) for a, level in zip(at, levels, strict=True) if a < length]
        last = dict(kept)  # the last of several edges between two samples is kept
        channels.append(channel_of(channel.name, channel.index, last, last.values(), length))
    return Capture(capture.path, Fraction(rate), length, tuple(channels))
