"""Extremes that do not depend on the arithmetic: time, clocks, lines, noise, inputs, baud rates, Allan variances.

    longest run, clocks with errors over a day, a transfer at the last tick, 10^9 samples of noise, NaN in a sample,
    a sender's largest rate error, large offsets and steep ramps, a scene whose crystals are 200 000 ppm apart

Each finding comes from a test: the code is executed with the extreme input, and its result is checked.

Baud rates: an SCI samples at eight times its own rate and counts from the first low sample of each start bit, which may
be up to one sample after the sender's falling edge. The majority of samples 4 to 6 of 8 decides the level of the stop
bit, so two of these three samples must be in the sender's stop bit. For a fast sender, the first two of the three must
be before the next start bit. For a slow sender, the last two must be after the last data bit. So sample 5 decides in
both cases. It comes 72 + 4 samples after the first low sample, and therefore 72 + 4 to 72 + 5 samples after the
sender's falling edge. If a bit of the sender has a length of b samples,

    fast   10 b >= 72 + 5        slow   9 b <= 72 + 4        (TI SPRUFZ5A section 1.2.7, figure 1-7)
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from functools import partial
from itertools import accumulate
from math import fsum, nan
from random import Random

import numpy as np

from ...bus.i2c.controller import I2cController
from ...bus.i2c.transfer import BusTiming, Phase, Transfer
from ...bus.uart.sender import UartSender
from ...core.examples import EXAMPLES
from ...core.kernel import Kernel
from ...core.records import Recorder
from ...core.sampler import watch
from ...core.socket import Socket
from ...core.time import DAY, LAST_TICK, Clock, Timebase, TimeError
from ...core.wire import Wire
from ...f28335.sci.module import Sci
from ...f28335.sci.register_map import SCI_MAP
from ...scene.case.load import load
from ...scene.case.party_tables import Controller
from ...scene.scene import Scene
from ..identification.allan import allan
from ..models.imu import Imu, NotFinite
from ..models.parameters import ImuParameters
from ..models.quantity import BadParameter
from ..noise import AxisNoise, Gaussian, NoiseTerms
from ..numeric.float64 import Float64
from .events import first_where, refusal, why_refused
from .sweep import EVERY, ExtremeFinding, Happens

SYSCLK = 150_000_000
ODD_CRYSTAL = 143_181_815  # SYSCLKOUT in Hz with a crystal of 28.636363 MHz, whose frequency the PLL multiplies by 5
BAUD = 115_200
LINES_RUN = "5 ms"
PPM = (-100_000, -37, 37, 100_000)
MORE_THAN_A_CENTURY = Fraction(109 * 365 * DAY)  # duration of a run in seconds
FAR = 10**9  # the number of a distant sample
TRIED = 1 << 20  # number of samples of the random walk that is compared with an exact sum
UNIT_ROUNDOFF = 2.0**-53

Edges = list[tuple[str, int, int]]  # name of the wire, ticks after the start of the run, level


def longest_run() -> Iterator[ExtremeFinding]:
    """Find the shortest run that is rejected as too long, and check that a run of more than a century is rejected.

    Ticks end at 2^62, before a counter of a chip or the int64 of a recording overflows.
    """
    for name, hertz in (("150 MHz", SYSCLK), ("28.636363 MHz x 5", ODD_CRYSTAL)):
        begins = first_where(partial(_too_long, Timebase(hertz)), 1, 1e11)
        message = why_refused(partial(Timebase(hertz).end_of_run, 0, MORE_THAN_A_CENTURY), TimeError)
        yield ExtremeFinding(
            f"length of a run, {name}",
            EVERY,
            "refused" if message else "agrees",
            begins,
            "s",
            note=message or "more than a century was accepted",
        )


def _too_long(base: Timebase, length: float) -> bool:
    return bool(why_refused(partial(base.end_of_run, 0, Fraction(length)), TimeError))


def clocks() -> Iterator[ExtremeFinding]:
    """Check that a clock that is fast or slow by some ppm accumulates no rounding errors.

    The last edge of a day, and 1000 random edges of that day, must be within a tick of their exact times.
    """
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
        yield ExtremeFinding(
            f"clock {ppm:+d} ppm, a day",
            EVERY,
            "exact" if exact else "off",
            None,
            "",
            note=f"{cycles} cycles, each within a tick; a period rounded to ticks would be off by {rounded:.3g} s",
        )


def lines_at_the_last_tick() -> Iterator[ExtremeFinding]:
    """Compare an I2C transfer and a UART burst just before the last tick with the same traffic from tick 0 on."""
    begins = LAST_TICK - Timebase(SYSCLK).ticks(LINES_RUN)
    for name, traffic in (("I2C transfer", i2c_edges), ("UART burst", uart_edges)):
        first, last = traffic(0), traffic(begins)
        same = first == last
        note = f"{len(last)} edges, {'the same as' if same else 'different from those'} at tick 0"
        yield ExtremeFinding(f"{name} at the last tick", EVERY, "exact" if same else "off", None, "", note=note)


def i2c_edges(start: int) -> Edges:
    """Return the edges of an I2C write to an unused address, at 100 kHz, from tick `start` on."""
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
    """Return the edges of sixteen UART bytes at 115200 bit/s, from tick `start` on."""
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


def noise_sums() -> Iterator[ExtremeFinding]:
    """Check that sample 10^9 of the noise is the same in a block and alone, and check the rounding of a random walk.

    The last value of a random walk of 2^20 samples is compared with the exact sum of its steps.

    White noise and bias instability are calculated from the number of the sample. Only the random walk is a sum.
    """
    for name, terms in (("white", NoiseTerms(1.0)), ("bias instability", NoiseTerms(0.0, 1.0))):
        noise = AxisNoise(terms, 0.02, 1, name)
        same = noise.values(FAR - 5, 10)[5] == noise.at(FAR)
        note = "computed from its number: no sum, no drift" if same else "another value than in a block"
        yield ExtremeFinding(f"{name} noise, sample 10^9", EVERY, "exact" if same else "off", None, "", note=note)
    walk = AxisNoise(NoiseTerms(0.0, 0.0, 1.0), 1.0, 1, "walk")
    sums = walk.values(0, TRIED)
    off = abs(float(sums[-1]) - fsum(Gaussian(1, "walk/random walk").values(0, TRIED - 1)))
    most = float(np.abs(sums).max())
    bound = UNIT_ROUNDOFF * FAR
    happens: Happens = "agrees" if off <= UNIT_ROUNDOFF * TRIED * most else "off"
    note = f"rounding: at most {bound:.1e} of the walk's largest value; found {off / most:.0e} after 2^20"
    yield ExtremeFinding("random walk, 10^9 samples", EVERY, happens, None, "", note=note)


def inputs() -> Iterator[ExtremeFinding]:
    """Check that two wrong inputs of the models are rejected.

    One is a sample that contains a NaN. The other is a value of `ImuParameters.period` that differs from the time
    between the rounds in which the models run.
    """
    model = Imu(Float64(), ImuParameters())
    zero = model.at_rest.body
    found = why_refused(lambda: model.check((0.0, nan, 0.0), zero, model.silence), NotFinite)
    yield refusal("NaN in a sample", found)
    found = why_refused(lambda: ImuParameters(period=10.0).check_period(Fraction(1, 50), "once a round"), BadParameter)
    yield refusal("models' period of 10 s, rounds of 20 ms", found)


BRR = 40  # value of the baud rate registers, for 114 329 bit/s
SAMPLE = 4 * (BRR + 1)  # length of a sample in SYSCLKOUT cycles, with LSPCLK = SYSCLKOUT / 4
NOMINAL = 8  # samples per bit if the sender has the right rate
PHASES = 16  # number of instants within a sample at which the first start bit begins, one in each run
BYTES = b"\x55\x00\x7f" * 4  # twelve bytes whose last data bit is 0, unlike a stop bit
# The shortest bit (fast sender) and the longest bit (slow sender) with which all bytes are received, in samples.
LIMITS = {"fast": Fraction(77, 10), "slow": Fraction(76, 9)}
HALVINGS = 8  # number of bisections of the range of bit lengths, which is at first half a sample wide
START = 10_000  # cycle of the first start bit


def baud_rates() -> Iterator[ExtremeFinding]:
    """Find the largest rate error of a sender at which an SCI receives all bytes, and compare it with the exact limit.

    The search is a bisection. A rate error passes if all bytes are received in each of PHASES runs, in which the first
    start bit begins at different instants within a sample.
    """
    for name, limit in LIMITS.items():
        good, bad = Fraction(NOMINAL), Fraction(NOMINAL) + (Fraction(1, 2) if limit > NOMINAL else -Fraction(1, 2))
        last = abs(bad - good) / (1 << HALVINGS)
        while abs(bad - good) > last:
            middle = (good + bad) / 2
            good, bad = (middle, bad) if all(received(middle, phase) for phase in range(PHASES)) else (good, middle)
        exact = min(good, bad) - Fraction(1, 8 * PHASES) <= limit <= max(good, bad) + Fraction(1, 8 * PHASES)
        found, meant = (float(100 * (NOMINAL / bit - 1)) for bit in (good, limit))
        note = f"12 bytes in a row are received up to {found:+.2f} %; the limit is {meant:+.3f} %"
        yield ExtremeFinding(f"baud rate of a {name} sender", EVERY, "exact" if exact else "off", meant, "%", note=note)


def received(bit: Fraction, phase: int) -> bool:
    """Return True if an SCI receives all bytes without an error.

    bit: the sender's bit time, in samples of the receiver.
    phase: the instant of the first start bit within a sample, in units of 1 / PHASES of a sample: 0 to PHASES - 1.
    """
    kernel, recorder, timebase = Kernel(), Recorder(), Timebase(SYSCLK)
    clock, line, sci = Clock(timebase, SYSCLK), Wire(kernel, "RX", recorder), Sci()
    socket = Socket(kernel, clock, recorder, "SCI-A", sci, lambda cycle, lines: None)
    sci.gate(0, True)
    for cycle, (register, value) in enumerate(
        (("SCILBAUD", BRR), ("SCICCR", 7), ("SCIFFTX", 0xE000), ("SCIFFRX", 0x2000), ("SCICTL1", 0x21))
    ):
        socket.write(cycle, SCI_MAP[register].offset, value)
    socket.inputs.listen(0, line)
    kernel.run_until(clock.tick(START + phase * SAMPLE // PHASES))
    UartSender(kernel, recorder, line, bit * SAMPLE * clock.tick(1)).send(BYTES, Fraction(0), lambda tick: None)
    kernel.run_until(clock.tick(START + 130 * NOMINAL * SAMPLE))
    cycle = clock.cycle_at(kernel.now)
    errors = socket.read(cycle, SCI_MAP["SCIRXST"].offset)
    words = [socket.read(cycle, SCI_MAP["SCIRXBUF"].offset) for _ in BYTES]
    return not errors & SCI_MAP["SCIRXST"]["RXERROR"].mask and bytes(word & 0xFF for word in words) == BYTES


LENGTH = 3001  # number of samples; their mean is no whole number, so `allan` rounds when it subtracts the mean
NOISE = 9  # maximum noise in LSB; all samples are whole numbers, so that `exact_variance` does not round
OFFSETS = (10**9, 10**15)
RAMPS = (10**3, 10**9)  # slopes of the ramps in LSB per sample
ALLOWED = 1e-9  # maximum relative error of the variance


def allan_variances() -> Iterator[ExtremeFinding]:
    """Check the Allan variances of noise plus an offset, and of noise plus a ramp, against their exact values."""
    random = Random(1)
    noise = [random.randint(-NOISE, NOISE) for _ in range(LENGTH)]
    for offset in OFFSETS:
        yield _finding(f"Allan variance, offset of {offset:.0e}", [offset + one for one in noise])
    for slope in RAMPS:
        yield _finding(f"Allan variance, ramp of {slope:.0e}", [slope * n + one for n, one in enumerate(noise)])


def _finding(extreme: str, samples: list[int]) -> ExtremeFinding:
    found = allan(np.array(samples, np.float64), 1.0)
    meant = [exact_variance(samples, m) for m in found.counts.tolist()]
    off = max(abs(Fraction(one) / of - 1) for one, of in zip(found.variance.tolist(), meant, strict=True))
    agrees = off <= ALLOWED
    note = f"{'' if agrees else 'not '}within {ALLOWED:.0e} of the exact variance at {len(meant)} averaging times"
    return ExtremeFinding(extreme, EVERY, "agrees" if agrees else "off", None, "", note=note)


def exact_variance(samples: list[int], m: int) -> Fraction:
    """Return the exact Allan variance: half the mean square of the change between adjacent averages over m samples."""
    sums = [0, *accumulate(samples)]
    changes = (sums[i + 2 * m] - 2 * sums[i + m] + sums[i] for i in range(len(samples) - 2 * m + 1))
    return Fraction(sum(change**2 for change in changes), 2 * (len(samples) - 2 * m + 1) * m**2)


CRYSTALS_PPM = 100_000  # deviation of each crystal in ppm, up or down, which is the largest value that a case accepts
SCENE_LENGTH = Fraction(1, 10)  # duration of the run in seconds
LEAST_ROUNDS = 4


def imu_hil_clocks() -> Iterator[ExtremeFinding]:
    """Run the case imu_hil.toml twice, with the crystals of unit and controller at opposite extremes.

    The host's bit rate has the same error as the unit's crystal, because an SCI cannot receive with a rate error of ten
    percent. The bytes of each round are compared with the frames. The tick at which each round is due is compared with
    the exact time, which is calculated as a fraction from the controller's period and crystal.
    """
    for sign in (1, -1):
        unit, controller = sign * CRYSTALS_PPM, -sign * CRYSTALS_PPM
        changes = [f"unit.dsp.ppm={unit}", f"controller.ppm={controller}", f"host.error={Fraction(unit, 10_000)}"]
        scene = Scene(load(EXAMPLES / "timing" / "imu_hil.toml", changes))
        due: list[int] = []
        scene.bus.rounds.on_due.append(due.append)
        result = scene.run(SCENE_LENGTH)
        counts, (wrong,) = result.counts, [one for one in result.budgets if one.name == "wrong bytes"]
        table, per_second = scene.case.controller or Controller(), scene.timebase.per_second
        exact = [(table.first + n * table.period) * per_second / (1 + table.ppm / 10**6) for n in range(len(due))]
        late = max(abs(tick - scene.start - one) for tick, one in zip(due, exact, strict=True))
        answered = wrong.passed and not counts["missed"] and not counts["nacked"] and counts["rounds"] >= LEAST_ROUNDS
        note = (
            f"{wrong.count} bytes as in the frames, {counts['rounds']} rounds, each within {float(late):.2g} of a tick "
            "of its exact instant"
        )
        extreme = f"imu_hil, unit {unit:+d} ppm, controller {controller:+d} ppm"
        yield ExtremeFinding(extreme, EVERY, "exact" if answered and late < 1 else "off", None, "", note=note)
