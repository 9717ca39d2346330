"""Snapshots and resets of each chip under random stimuli.

    chip with random stimuli --take--> snapshot --restore--> another chip that had other stimuli, at a later cycle
              '------------------ both then have equal stimuli and equal results ------------------'

In the second chip, each attribute that is not part of the declared state has another value, and each declared instant
is moved to another cycle. In the same way, a chip that was reset is compared with a new one.
"""

from __future__ import annotations

from collections.abc import Callable
from random import Random
from typing import Any

import pytest

from periph_sim.core.chip import NEVER
from periph_sim.core.restore import restore
from periph_sim.core.snapshot import Module, take_snapshot
from periph_sim.f28335.cpu_timer.module import CpuTimer
from periph_sim.f28335.cpu_timer.register_map import PRD, TCR
from periph_sim.f28335.gpio.module import Gpio
from periph_sim.f28335.i2c import register_map as at
from periph_sim.f28335.i2c.module import I2c
from periph_sim.f28335.i2c.options import I2cOptions
from periph_sim.f28335.i2c.register_map import MDR_IRS, MDR_MST, MDR_STP, MDR_STT, MDR_TRX
from periph_sim.f28335.pie.module import Pie
from periph_sim.f28335.sci.module import Sci
from periph_sim.f28335.sci.register_map import SCI_MAP
from periph_sim.f28335.spi.module import Spi
from periph_sim.f28335.spi.register_map import SPI_MAP
from periph_sim.f28335.system_control.module import SystemControl
from periph_sim.f28335.system_control.register_map import SCSR, WDCR, WDKEY
from periph_sim.f28335.system_options import SystemOptions
from periph_sim.f28335.xint.module import Xint

SYSTEM = SystemOptions()
LATER = (
    2520 * 720_720
)  # cycles: a multiple of the periods of all LSPCLK dividers, OSCCLK fractions and watchdog prescalers
PUBLIC = (
    *("out", "held", "requests", "loaded", "filter_width", "enabled", "driven", "driven_high", "pulses"),
    *("sysclk_hz", "gates", "hspclk_divider", "lspclk_divider", "reset_requested"),
)
STEPS = 120
MOMENTS = 12


class Driver:
    """Applies random stimuli to a chip and logs the results. now: cycles since the start of the driver."""

    PAUSES: tuple[int, ...] = (1, 1, 2, 5, 40, 300, 3000)

    def __init__(self, chip: Any, begin: int, seed: str) -> None:
        self.chip = chip
        self.begin = begin
        self.now = 1
        self.random = Random(seed)
        self.log: list[object] = []
        self.offsets = [register.offset for register in chip.MAP]

    def step(self) -> None:
        random = self.random
        self._wait(random.choice(self.PAUSES))
        what = random.randrange(10)
        offset = random.choice(self.offsets)
        if what < 3:
            self.write(offset, random.choice((0, 0xFFFF, random.getrandbits(16), 1 << random.randrange(16))))
        elif what == 3:
            self.log.append(self.chip.read(self.begin + self.now, offset))
        elif what == 4:
            self.log.append(self.chip.peek(self.begin + self.now, offset))
        elif what == 5 and not random.randrange(8):
            self.seldom(self.begin + self.now)
        else:
            self.stimulate()
        self._look()

    def write(self, offset: int, value: int) -> None:
        self.chip.write(self.begin + self.now, offset, value)

    def stimulate(self) -> None:
        if self.chip.INPUTS:
            self.pins(self.random.getrandbits(len(self.chip.INPUTS)))

    def pins(self, levels: int) -> None:
        self.chip.pins(self.begin + self.now, levels)

    def idle(self) -> None:
        """Set the pins to the initial levels of a new chip."""
        if self.chip.INPUTS:
            self.pins(NEW_PINS.get(type(self.chip), 0))

    def seldom(self, now: int) -> None:
        random = self.random
        what = random.randrange(6)
        if not what:
            self.chip.reset(now)
        elif what < 3:
            self.chip.set_lspclk(now, random.choice((1, 2, 4, 6)), self.begin + random.randrange(8))
        else:
            self.chip.gate(now, what > 3)

    def _wait(self, cycles: int) -> None:
        """Advance some cycles and wake the chip whenever it is due."""
        to = self.now + cycles
        while self.chip.next_wake < self.begin + to:
            self.now = max(self.now, self.chip.next_wake - self.begin)
            self.wake()
            self._look()
        self.now = to

    def wake(self) -> None:
        self.chip.wake(self.begin + self.now)

    def _look(self) -> None:
        """Log the state that is visible to the chip's owner, and clear requests and notes like the owner."""
        chip = self.chip
        wake = chip.next_wake if chip.next_wake == NEVER else max(0, chip.next_wake - self.begin - self.now)
        self.log.append((self.now, wake, [note.text for note in chip.notes], self.seen()))
        chip.requests = 0
        chip.notes.clear()

    def seen(self) -> list[object]:
        values = [getattr(self.chip, name, None) for name in PUBLIC]
        return [value for value in values if not callable(value)]


class I2cDriver(Driver):
    """Acts as another master and as slaves that acknowledge. others: the levels of the bus without the chip."""

    PAUSES = (1, 20, 60, 200, 700)
    others = 3

    def pins(self, levels: int) -> None:
        self.others = levels
        super().pins(levels & self.chip.out)

    def wake(self) -> None:
        super().wake()
        self.pins(self.others)

    def stimulate(self) -> None:
        random = self.random
        what = random.randrange(8)
        if not what:
            self.pins(random.getrandbits(2))
        elif what == 1:
            self.set_up()
        elif what < 4:
            self._lines((3, 1, 0))  # START
            own = self.chip.peek(self.begin + self.now, at.OAR)
            self._byte(own << 1 & 0xFF | random.getrandbits(1) if random.randrange(3) else random.getrandbits(8))
        elif what == 4:
            self._lines((0, 1, 3))  # STOP
        else:
            self._byte(random.getrandbits(8))

    def set_up(self) -> None:
        """Enable the module, as a slave or as a master, sometimes with FIFOs and with interrupts."""
        random = self.random
        self.write(at.IER, random.getrandbits(7))
        self.write(at.FFTX, random.choice((0, 0x6000 | random.getrandbits(6))))
        self.write(at.FFRX, random.choice((0, 0x2000 | random.getrandbits(6))))
        self.write(at.CNT, random.randrange(4))
        commands = random.choice((0, 0, 0, MDR_STT, MDR_STT | MDR_STP))
        self.write(at.MDR, MDR_IRS | (MDR_MST | random.choice((0, MDR_TRX)) | commands if commands else 0))

    def _byte(self, byte: int) -> None:
        """Send eight bits and an acknowledge bit, which is random unless the chip pulls SDA."""
        for bit in range(9):
            sda = byte >> (7 - bit) & 1 if bit < 8 else self.random.getrandbits(1)
            self._lines((2 * sda, 2 * sda | 1, 2 * sda))

    def _lines(self, levels: tuple[int, ...]) -> None:
        for level in levels:
            self.pins(level)
            self._look()
            self._wait(self.random.choice((20, 45)))


class SciDriver(Driver):
    """Sends frames at the rate of the chip or at another rate."""

    PAUSES = (1, 5, 40, 300, 3000)

    def stimulate(self) -> None:
        random = self.random
        what = random.randrange(4)
        if not what:
            self.pins(random.getrandbits(1))
        elif what == 1:
            self.set_up()
        else:
            self.frame(random.choice((random.getrandbits(8), 0x41, 0)))

    def set_up(self) -> None:
        """Enable the module, sometimes with its FIFO."""
        random = self.random
        for name in ("SCIHBAUD", "SCIPRI"):
            self.write(SCI_MAP[name].offset, 0)
        self.write(SCI_MAP["SCILBAUD"].offset, random.randrange(4))
        self.write(SCI_MAP["SCIFFTX"].offset, random.choice((0x8000, 0xE020 | random.getrandbits(5))))
        self.write(SCI_MAP["SCIFFRX"].offset, 0x2020 | random.getrandbits(5))
        self.write(SCI_MAP["SCICTL2"].offset, 3)
        self.write(SCI_MAP["SCICTL1"].offset, 0x23 | random.choice((0, 0x40)))

    def frame(self, byte: int) -> None:
        bit = self.chip._rx_clock.period * 8
        for level in (0, *(byte >> place & 1 for place in range(8)), 1, 1):
            self.pins(level)
            self._look()
            self._wait(bit)


class SpiDriver(Driver):
    """Sends clocks to a slave, and data to a master."""

    PAUSES = (1, 5, 20, 100)

    def stimulate(self) -> None:
        random = self.random
        if not random.randrange(4):
            self.set_up()
        for _ in range(random.randrange(20)):
            self.pins(random.getrandbits(2) | random.choice((0, 0, 0, 8)) | self.random.getrandbits(1) << 2)
            self._look()
            self._wait(random.choice((3, 9)))

    def set_up(self) -> None:
        random = self.random
        self.write(SPI_MAP["SPICTL"].offset, random.getrandbits(5))
        self.write(SPI_MAP["SPIBRR"].offset, random.randrange(6))
        self.write(SPI_MAP["SPIFFTX"].offset, random.choice((0x8000, 0xE000 | random.getrandbits(6))))
        self.write(SPI_MAP["SPIFFRX"].offset, 0x2000 | random.getrandbits(6))
        self.write(SPI_MAP["SPIFFCT"].offset, random.randrange(4))
        self.write(SPI_MAP["SPICCR"].offset, 0x80 | random.getrandbits(7))
        for _ in range(random.randrange(4)):
            self.write(SPI_MAP["SPITXBUF"].offset, random.getrandbits(16))


class GpioDriver(Driver):
    """Reports edges with the method for 88 pins, which do not fit in the mask of `pins`, and watches the XINT lines."""

    def stimulate(self) -> None:
        now, random = self.begin + self.now, self.random
        if random.randrange(6):
            self.chip.edges(now, random.getrandbits(88) & random.getrandbits(88), exact=random.random() < 0.7)
        else:
            self.chip.watch_xints(now, random.getrandbits(7))
            self.log.append(self.chip.xint_levels(now))

    def idle(self) -> None:
        self.chip.watch_xints(self.begin + self.now, 0)
        self.chip.edges(self.begin + self.now, Gpio(SYSTEM).pads)
        self._wait(2)

    def seen(self) -> list[object]:
        changed, self.chip.changed = self.chip.changed, []
        now = self.begin + self.now
        return [*super().seen(), changed, [self.chip.peripheral_level(now, one) for one in ("SDAA", "SCIRXDA")]]


class PieDriver(Driver):
    """Requests and holds lines, and fetches vectors."""

    def stimulate(self) -> None:
        now, random = self.begin + self.now, self.random
        group, line = random.randrange(1, 13), random.randrange(1, 9)
        what = random.randrange(4)
        if what == 3:
            self.log.append(self.chip.vector(now, group))
        elif what == 2:
            self.chip.request(now, group, line)
        else:
            self.chip.hold(now, group, line, bool(what))

    def seen(self) -> list[object]:
        seen = super().seen()
        if self.random.randrange(3):
            self.chip.pulses = 0
        return seen


class TimerDriver(Driver):
    def stimulate(self) -> None:
        self.write(PRD.offset, self.random.choice((0, 3, 100)))
        self.write(TCR.offset, self.random.choice((0x4020, 0x8000, 0x4000, 0x0010)))


class SystemDriver(Driver):
    """Services the watchdog at random, and changes to a fast clock."""

    PAUSES = (1, 2, 5, 3000, 60_000)

    def stimulate(self) -> None:
        random = self.random
        self.write(*random.choice(((WDKEY.offset, 0x55), (WDKEY.offset, 0xAA), (WDCR.offset, 0x28), (SCSR.offset, 2))))
        if self.chip.reset_requested and random.randrange(2):
            self.chip.reset(self.begin + self.now)


def clocked(chip: Any, now: int = 0) -> Any:
    """Enable the clock of a chip, and return the chip."""
    chip.gate(now, True)
    return chip


RUNNING = (CpuTimer, Gpio, SystemControl)  # chips whose clock is on after a reset
NEW_PINS = {I2c: 3, Sci: 1, Spi: 15}  # levels of the inputs of a new chip


def wired_gpio() -> Gpio:
    chip = Gpio(SYSTEM)
    chip.wire((1 << 88) - 1)
    return clocked(chip)


CHIPS: dict[str, tuple[Callable[[], Any], type[Driver]]] = {
    "I2C": (lambda: clocked(I2c(I2cOptions(int_line="level", oar_latch="at_irs"))), I2cDriver),
    "SCI": (lambda: clocked(Sci()), SciDriver),
    "SPI": (lambda: clocked(Spi()), SpiDriver),
    "GPIO": (wired_gpio, GpioDriver),
    "XINT": (Xint, Driver),
    "PIE": (lambda: Pie(SYSTEM), PieDriver),
    "timer": (lambda: CpuTimer(SYSTEM), TimerDriver),
    "SYS": (lambda: SystemControl(30_000_000, SYSTEM), SystemDriver),
}


def as_new(driver: Driver, pins_first: bool) -> None:
    """Reset the chip, give its pins the levels of a new chip after the reset or also before, and enable its clock."""
    chip = driver.chip
    chip.set_lspclk(driver.now, 4, driver.now)
    if pins_first:
        driver.idle()
        driver._wait(8)
    if isinstance(driver, SystemDriver):
        chip.reset_requested = False  # otherwise WDFLAG would be set later, as after a reset by the watchdog
    chip.reset(driver.now)
    assert (chip.held, chip.requests) == (0, 0)
    assert chip.next_wake == NEVER or isinstance(chip, RUNNING), "a chip without a clock requests a wake-up"
    if not pins_first or isinstance(driver, I2cDriver):
        driver.idle()
    driver._look()
    chip.loaded = 0
    clocked(chip, driver.now)


@pytest.mark.parametrize("name", CHIPS)
def test_after_a_reset_a_chip_behaves_like_a_new_one(name: str):
    make, kind = CHIPS[name]
    for seed in range(2 * MOMENTS):
        used = kind(make(), 0, f"{seed} used")
        for _ in range(STEPS):
            used.step()
        as_new(used, pins_first=seed % 2 == 0)
        drivers = [kind(used.chip, used.now, f"{seed}"), kind(make(), 0, f"{seed}")]
        for driver in drivers:
            for _ in range(STEPS):
                driver.step()
        assert drivers[0].log == drivers[1].log


@pytest.mark.parametrize("name", CHIPS)
def test_a_restored_chip_behaves_like_the_original(name: str):
    make, kind = CHIPS[name]
    logged = 0
    for seed in range(MOMENTS):
        first, second = kind(make(), 0, f"{seed} first"), kind(make(), 0, f"{seed} second")
        for _ in range(STEPS):
            first.step()
            second.step()
        snapshot = take_snapshot({"chip": Module(first.chip, first.now)}, 0, 0, ())
        moved = snapshot._replace(cycles={"chip": first.now + LATER})
        restore(moved, {"chip": Module(second.chip, second.now)})
        drivers = [kind(one.chip, begin, f"{seed}") for one, begin in ((first, first.now), (second, first.now + LATER))]
        for _ in range(STEPS):
            for driver in drivers:
                driver.step()
        assert drivers[0].log == drivers[1].log
        logged += len({repr(entry) for entry in drivers[0].log})
    assert logged > MOMENTS * STEPS / 2
