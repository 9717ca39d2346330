"""Extremes outside the models' arithmetic: time, clocks, lines, sums of noise, inputs.

    longest run, clocks of some ppm over a day, a transfer at the last tick, 10^9 samples of noise, NaN in arrays

Each finding is measured: the error is provoked, the edges are counted, the two runs are compared.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import partial
from math import fsum, nan
from random import Random

import numpy as np

from ...bus.i2c.controller import I2cController
from ...bus.i2c.transfer import BusTiming, Phase, Transfer
from ...bus.uart.sender import UartSender
from ...core.kernel import Kernel
from ...core.records import Recorder
from ...core.sampler import watch
from ...core.time import DAY, LAST_TICK, Clock, Timebase, TimeError
from ...core.wire import Wire
from ..models.arrays import codes_of
from ..models.finite import NotFinite
from ..models.parameters import ImuParameters
from ..models.period import check_period
from ..models.quantity import BadParameter
from ..noise import AxisNoise, Gaussian, NoiseTerms
from .events import first_where
from .finding import EVERY, Finding, Happens

SYSCLK = 150_000_000
ODD_CRYSTAL = 143_181_815  # 28.636363 MHz, PLL 10
BAUD = 115_200
LINES_RUN = "5 ms"
PPM = (-100_000, -37, 37, 100_000)
MORE_THAN_A_CENTURY = Fraction(109 * 365 * DAY)  # seconds
FAR = 10**9  # samples
TRIED = 1 << 20  # of them added one by one
UNIT_ROUNDOFF = 2.0**-53

Edges = list[tuple[str, int, int]]  # wire, ticks after the start, level


def longest_run() -> Iterator[Finding]:
    """Find the longest run. Ticks reach up to 2^62; neither a chip nor a recording's int64 overflows before that."""
    for name, hertz in (("150 MHz", SYSCLK), ("28.636363 MHz x 5", ODD_CRYSTAL)):
        begins = first_where(partial(_too_long, Timebase(hertz)), 1, 1e11)
        message = _why(partial(Timebase(hertz).end_of_run, 0, MORE_THAN_A_CENTURY), TimeError)
        yield Finding(
            f"length of a run, {name}",
            EVERY,
            "refused" if message else "agrees",
            begins,
            "s",
            note=message or "more than a century was accepted",
        )


def _too_long(base: Timebase, length: float) -> bool:
    return bool(_why(partial(base.end_of_run, 0, Fraction(length)), TimeError))


def clocks() -> Iterator[Finding]:
    """Run a clock with an error in ppm for a day: each edge is within a tick of its exact time, without drift."""
    base = Timebase(SYSCLK)
    for ppm in PPM:
        hertz = SYSCLK * (1 + Fraction(ppm, 1_000_000))
        clock = Clock(base, hertz)
        cycles = int(hertz * DAY)
        random = Random(ppm)
        tried = [cycles, *(random.randrange(cycles) for _ in range(1000))]
        late = max(abs(clock.tick(n) - n * base.per_second / hertz) for n in tried)
        exact = late < 1 and all(clock.cycle_at(clock.tick(n)) == n for n in tried)
        rounded = abs(round(base.per_second / hertz) * cycles - clock.tick(cycles)) / base.per_second
        yield Finding(
            f"clock {ppm:+d} ppm, a day",
            EVERY,
            "exact" if exact else "off",
            None,
            "",
            note=f"{cycles} cycles, each within a tick; a period rounded to ticks would be off by {rounded:.3g} s",
        )


def lines_at_the_last_tick() -> Iterator[Finding]:
    """Compare a transfer and a UART burst in a run that ends with the last tick with those from tick 0 on."""
    begins = LAST_TICK - Timebase(SYSCLK).ticks(LINES_RUN)
    for name, traffic in (("I2C transfer", i2c_edges), ("UART burst", uart_edges)):
        first, last = traffic(0), traffic(begins)
        same = first == last
        note = f"{len(last)} edges, {'the same as' if same else 'different from those'} at tick 0"
        yield Finding(f"{name} at the last tick", EVERY, "exact" if same else "off", None, "", note=note)


def i2c_edges(start: int) -> Edges:
    """Return the edges of a write to an unused address, at 100 kHz, from tick `start` on."""
    kernel, recorder = Kernel(start), Recorder()
    scl, sda = Wire(kernel, "SCL", recorder), Wire(kernel, "SDA", recorder)
    edges = _watched(start, scl, sda)
    half = Timebase(SYSCLK).ticks("5 us")
    timing = BusTiming(half, half, half // 10, half, half, half, half)
    I2cController(kernel, recorder, scl, sda, timing).begin(
        Transfer("t", [Phase(0x50, False, b"\xa5")]), lambda _: None
    )
    kernel.run_until(start + Timebase(SYSCLK).ticks(LINES_RUN))
    return edges


def uart_edges(start: int) -> Edges:
    """Return the edges of sixteen bytes at 115200 bit/s."""
    base, kernel, recorder = Timebase(SYSCLK), Kernel(start), Recorder()
    line = Wire(kernel, "RX", recorder)
    edges = _watched(start, line)
    UartSender(kernel, recorder, line, Fraction(base.per_second, BAUD)).send(
        bytes(range(0, 256, 16)), Fraction(1), lambda _: None
    )
    kernel.run_until(start + base.ticks(LINES_RUN))
    return edges


def _watched(start: int, *wires: Wire) -> Edges:
    edges: Edges = []
    for wire in wires:
        watch([wire], partial(_keep, edges, wire.name, start))
    return edges


def _keep(edges: Edges, wire: str, start: int, tick: int, level: int) -> None:
    edges.append((wire, tick - start, level))


def noise_sums() -> Iterator[Finding]:
    """Check noise at sample 10^9. White noise and bias instability need no sum; the random walk is the only sum."""
    for name, terms in (("white", NoiseTerms(1.0)), ("bias instability", NoiseTerms(0.0, 1.0))):
        noise = AxisNoise(terms, 0.02, 1, name)
        same = noise.values(FAR - 5, 10)[5] == noise.at(FAR)
        note = "computed from its number: no sum, no drift" if same else "another value than in a block"
        yield Finding(f"{name} noise, sample 10^9", EVERY, "exact" if same else "off", None, "", note=note)
    walk = AxisNoise(NoiseTerms(0.0, 0.0, 1.0), 1.0, 1, "walk")
    sums = walk.values(0, TRIED)
    off = abs(float(sums[-1]) - fsum(Gaussian(1, "walk/random walk").values(0, TRIED - 1)))
    most = float(np.abs(sums).max())
    bound = UNIT_ROUNDOFF * FAR
    happens: Happens = "agrees" if off <= UNIT_ROUNDOFF * TRIED * most else "off"
    note = f"rounding: at most {bound:.1e} of the walk's largest value; found {off / most:.0e} after 2^20"
    yield Finding("random walk, 10^9 samples", EVERY, happens, None, "", note=note)


def inputs() -> Iterator[Finding]:
    """Check that models reject NaN in arrays, and a period other than the one at which they run."""
    still = np.zeros(10)
    wrong = still.copy()
    wrong[7] = nan
    found = _why(lambda: codes_of(ImuParameters(), (still, wrong, still), (still, still, still)), NotFinite)
    yield _refusal("NaN in an array", found)
    found = _why(lambda: check_period(ImuParameters(period=10.0), Fraction(1, 50), "once a round"), BadParameter)
    yield _refusal("models' period of 10 s, rounds of 20 ms", found)


def _refusal(what: str, message: str) -> Finding:
    return Finding(what, EVERY, "refused" if message else "agrees", None, "", note=message or "it passed")


def _why(tried: Callable[[], object], error: type[Exception]) -> str:
    """Return the message of the expected error; empty if it is not raised."""
    try:
        tried()
    except error as refusal:
        return str(refusal)
    return ""
