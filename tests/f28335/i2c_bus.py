"""A wired-AND I2C bus with bare chips and scripted partners, in SYSCLKOUT cycles, and a decoder of its traffic.

    chips, Target, Foreign  -->  wires  -->  edges  -->  decode()  -->  "S 50W A 12 A P"

`Bus` advances the time. Within a cycle, first the partners act, then the wires settle, then
the chips wake, then the firmware (the test) acts. Every edge is recorded. `decode` derives
the transfers from the edges alone and shares no code with the model. `Bench` adds the
firmware side: registers and fields with the manual's names, and the signals of timing
diagrams (`tests/waves.py`).

In the notation of transfers, S is a START (also a repeated one), P a STOP, A and N are the
receiver's ACK and NACK, 50W is an address byte, other bytes are hexadecimal, and ~101 is
a byte that was cut off after three bits.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable
from typing import NamedTuple, Protocol

from periph_sim.core.chip import NEVER, Note
from periph_sim.core.options import Value, options_from
from periph_sim.f28335.i2c.module import I2c
from periph_sim.f28335.i2c.options import I2cOptions

from ..waves import DiagramRig
from .i2c_registers import FLAGS, MDR, OFFSET

SCL, SDA = 0, 1
LINES = ("SCL", "SDA")
RELEASED = 0b11  # both lines released

# TI's setting for 400 kHz at 150 MHz: Tmod 15 cycles, low 15 * (10 + 5), high 15 * (5 + 5).
LOW, HIGH = 225, 150
SLOT = LOW + HIGH
HOLD = 20  # cycles from the fall of SCL until a scripted partner moves SDA


class Edge(NamedTuple):
    time: int
    line: int
    level: int


class Party(Protocol):
    """A chip or scripted partner that drives the two wires."""

    next_wake: int
    out: int

    def pins(self, now: int, levels: int) -> object: ...

    def wake(self, now: int) -> None: ...


# ---- decoding -----------------------------------------------------------------------------------


class BusItem(NamedTuple):
    """One item of a transfer. start: cycle of the START or STOP, or of the first SCL rise of the byte."""

    start: int
    text: str


def decode(edges: Iterable[Edge], bits: int = 8, free: bool = False) -> list[BusItem]:
    """Return the items of the transfers in the edges.

    bits: the number of bits in a data byte.
    free: True if no address byte follows a START.
    """
    level = [1, 1]
    items: list[BusItem] = []
    got: list[int] = []  # bits of the current byte, including the acknowledge bit
    rises: list[int] = []
    active, first = False, False

    def cut() -> None:  # at a START or STOP, SCL is high: its last rise was not that of a bit
        if got:
            got.pop()
        if got:
            items.append(BusItem(rises[0], "~" + "".join(map(str, got))))
        got.clear()
        rises.clear()

    for time, line, new in edges:
        level[line] = new
        if line == SDA and level[SCL]:
            if active:
                cut()
            active = first = not new
            items.append(BusItem(time, "P" if new else "S"))
        elif line == SCL and new and active:
            got.append(level[SDA])
            rises.append(time)
        elif line == SCL and active:  # a byte is complete when SCL falls after its acknowledge bit
            address = first and not free
            if len(got) == (8 if address else bits) + 1:
                *data, answer = got
                value = int("".join(map(str, data)), 2)
                text = f"{value >> 1:02x}{'R' if value & 1 else 'W'}" if address else f"{value:02x}"
                items += [BusItem(rises[0], text), BusItem(rises[-1], "N" if answer else "A")]
                first = False
                got.clear()
                rises.clear()
    return items


# ---- partners -------------------------------------------------------------------------------------


class Target:
    """A device that acknowledges `address`, sends `gives` when read, and stores received bytes in `got`.

    nack: numbers of the received bytes that it does not acknowledge (0 is the first data byte).
    stretch: (byte, bit) -> the number of cycles for which it holds SCL low after fall `bit` of byte
        `byte` (0 is the address byte; fall 9 is that of the acknowledge bit).
    free: there is no address; "r" receives, "t" transmits from the first byte on.
    also: further address bytes that it acknowledges (0 is the general call).
    """

    def __init__(
        self,
        address: int = 0x50,
        gives: Iterable[int] = (),
        *,
        nack: Iterable[int] = (),
        stretch: dict[tuple[int, int], int] | None = None,
        bits: int = 8,
        free: str = "",
        also: Iterable[int] = (),
        absent: bool = False,
    ) -> None:
        self.address = address
        self.gives = list(gives)
        self.nack = set(nack)
        self.stretch = stretch or {}
        self.bits = bits
        self.free = free
        self.also = set(also)
        self.absent = absent
        self.later: dict[
            int, int
        ] = {}  # first byte (0 is the address byte) -> the number of bits of data from that byte on
        self.got: list[int] = []
        self.answers: list[int] = []  # acknowledge bits of the master to the sent bytes; 0 is ACK
        self.out = RELEASED
        self.next_wake = NEVER
        self._due: list[tuple[int, int, int]] = []  # (time, line, level)
        self._level = [1, 1]
        self._role = ""  # "a" address, "2" second address byte, "r" or "t" as in `free`, "" if not addressed
        self._ten = False  # the 10-bit address has been matched since the last STOP
        self._next = ""  # the role in the next byte
        self._byte = self._bit = self._value = self._given = 0

    def _later(self, time: int, line: int, level: int) -> None:
        self._due = sorted([*self._due, (time, line, level)])
        self.next_wake = self._due[0][0]

    def wake(self, now: int) -> None:
        while self._due and self._due[0][0] <= now:
            _, line, level = self._due.pop(0)
            self.out = self.out & ~(1 << line) | level << line
        self.next_wake = self._due[0][0] if self._due else NEVER

    def pins(self, now: int, levels: int) -> None:
        (scl, sda), self._level = self._level, [levels & 1, levels >> 1]
        if self._level[SCL] != scl:
            self._rise() if not scl else self._fall(now)
        elif scl and self._level[SDA] != sda:
            self._begin() if sda else self._end()

    def _begin(self) -> None:
        self._role = self.free or "a"
        self._byte = self._bit = self._value = 0

    def _end(self) -> None:
        self._role, self._ten = "", False

    def _size(self) -> int:
        return 8 if self._role in "a2" else self.bits

    def _rise(self) -> None:
        if not self._role:
            return
        self._bit += 1
        if self._bit <= self._size():
            self._value = self._value << 1 | self._level[SDA]
        elif self._role == "t":
            self.answers.append(self._level[SDA])
            if self._level[SDA]:
                self._role = ""

    def _fall(self, now: int) -> None:
        held = self.stretch.get((self._byte, self._bit), 0)
        if held and self._bit:
            self.out &= ~(1 << SCL)
            self._later(now + held, SCL, 1)
        if not self._role:
            self._later(now + HOLD, SDA, 1)
            return
        if self._bit == self._size() + 1:
            self._byte, self._bit, self._value = self._byte + 1, 0, 0
            self.bits = self.later.get(self._byte, self.bits)
            self._role = self._next
        level = 1
        if self._bit == self._size() and self._role != "t":
            level = self._judge()
        elif self._role == "t" and self._bit < self.bits:
            if self._bit == 0:
                self._given = self.gives.pop(0) if self.gives else 0xFF
            level = self._given >> (self.bits - 1 - self._bit) & 1
            self._next = "t"
        self._later(now + HOLD, SDA, level)

    def _judge(self) -> int:
        """Return the acknowledge bit for a complete byte, and set the role for the next byte."""
        role, value = self._role, self._value
        self._next = ""
        if role == "r":
            self.got.append(value)
            refused = len(self.got) - 1 in self.nack
            self._next = "" if refused else "r"
            return int(refused)
        if self.absent:
            return 1
        read = value & 1
        if role == "2":
            self._ten = value == self.address & 0xFF
            self._next = "r" if self._ten else ""
        elif self.address > 0x7F:
            header = 0xF0 | self.address >> 8 << 1
            if value == header:
                self._next = "2"
            elif value == header | 1 and self._ten:
                self._next = "t"
        elif value >> 1 == self.address or value in self.also:
            self._next = "t" if read else "r"
        return int(not self._next)


class Wait(NamedTuple):
    """Wait of a scripted master for a number of cycles, or until `line` has `level` if that happens earlier."""

    cycles: int
    line: int = -1
    level: int = -1


class Foreign:
    """Another master that plays a script such as "S 50W 12 P" or "S 50R ?A ?N P"; "+500" is a pause of 500 cycles.

    at: the cycle in which it begins, or None to pull SDA in the same cycle as another party, so that
        both masters start together.
    low, high: the times of its own clock.
    lost: True once it has released SDA and sampled 0 while sending.
    got: the bytes that it has read.
    acknowledges: the acknowledge bits for the bytes that it has sent.

    It does not check whether the bus is free.
    """

    def __init__(self, script: str, at: int | None = 0, *, low: int = LOW, high: int = HIGH) -> None:
        self.low, self.high = low, high
        self.lost = False
        self.got: list[int] = []
        self.acknowledges = ""
        self.done = False
        self.out = RELEASED
        self._level = [1, 1]
        self._wait = Wait(0)
        self._script = script
        self.next_wake = 0 if at is None else at
        self._join = at is None
        self._fell = 0
        self._now = 0
        self._steps = self._play()

    def pins(self, now: int, levels: int) -> None:
        before, self._level = self._level, [levels & 1, levels >> 1]
        self._now = now
        if before[SCL] and not self._level[SCL]:
            self._fell = now
        line = self._wait.line
        if line >= 0 and self._level[line] != before[line] and self._wait.level == self._level[line]:
            self._go(now)

    def wake(self, now: int) -> None:
        self._go(now)

    def _go(self, now: int) -> None:
        self._now = now
        while True:
            wait = next(self._steps, None)
            if wait is None or self.done:
                self.done, self.next_wake, self._wait = True, NEVER, Wait(0)
                return
            if (wait.line >= 0 and self._level[wait.line] == wait.level) or wait.cycles <= 0:
                continue
            self._wait = wait
            self.next_wake = now + wait.cycles
            return

    def _pull(self, line: int) -> None:
        self.out &= ~(1 << line)
        self._level[line] = 0
        if line == SCL:
            self._fell = self._now

    def _release(self, line: int) -> None:
        self.out |= 1 << line

    def _play(self) -> Generator[Wait, None, None]:
        if self._join:
            yield Wait(NEVER // 2, SDA, 0)
        for word in self._script.split():
            if word == "S":
                yield from self._start()
            elif word == "P":
                yield from self._stop()
            elif word.startswith("+"):
                yield Wait(int(word[1:]))
            elif word.startswith("?"):
                value = 0
                for _ in range(8):
                    value = value << 1 | (yield from self._clock(1))
                self.got.append(value)
                yield from self._clock(int(word == "?N"))
            else:
                value = int(word.rstrip("RW"), 16)
                if word[-1] in "RW":
                    value = value << 1 | (word[-1] == "R")
                for bit in range(7, -1, -1):
                    level = yield from self._clock(value >> bit & 1)
                    if level != value >> bit & 1:
                        self.lost, self.out = True, RELEASED
                        return
                self.acknowledges += "NA"[not (yield from self._clock(1))]

    def _start(self) -> Generator[Wait, None, None]:
        if self._level[SCL] == 0:
            yield from self._raise(1)
            yield Wait(self.high)
        self._pull(SDA)
        yield Wait(self.high, SCL, 0)
        self._pull(SCL)

    def _stop(self) -> Generator[Wait, None, None]:
        yield from self._raise(0)
        yield Wait(self.high)
        self._release(SDA)
        yield Wait(HOLD)

    def _raise(self, sda: int) -> Generator[Wait, None, None]:
        """Put a bit on SDA in the low phase, release SCL at the end of the low period, and wait until SCL is high."""
        yield Wait(HOLD)
        if sda:
            self._release(SDA)
        else:
            self._pull(SDA)
        yield Wait(self._fell + self.low - self._now)
        self._release(SCL)
        yield Wait(NEVER // 2, SCL, 1)

    def _clock(self, sda: int) -> Generator[Wait, None, int]:
        """Send one clock pulse with this bit on SDA, and return the actual level of SDA."""
        yield from self._raise(sda)
        level = self._level[SDA]
        yield Wait(self.high, SCL, 0)
        self._pull(SCL)
        return level


class LineDriver:
    """A driver on each line that the test pulls and releases, now or later."""

    def __init__(self) -> None:
        self.out = RELEASED
        self.next_wake = NEVER
        self._due: list[tuple[int, int, int]] = []  # (time, line, level), in the order of their times

    def put(self, line: int, level: int) -> None:
        self.out = self.out & ~(1 << line) | level << line

    def put_later(self, time: int, line: int, level: int) -> None:
        """Schedule a level. The times of successive calls must not decrease."""
        self._due.append((time, line, level))
        self.next_wake = self._due[0][0]

    def pins(self, now: int, levels: int) -> object: ...

    def wake(self, now: int) -> None:
        while self._due and self._due[0][0] <= now:
            _, line, level = self._due.pop(0)
            self.put(line, level)
        self.next_wake = self._due[0][0] if self._due else NEVER


# ---- the bus --------------------------------------------------------------------------------------


class Bus(DiagramRig):
    """Two wires. rise: cycles from the release by the last driver until the line is high."""

    def __init__(self, chips: Iterable[I2c], partners: Iterable[Party] = (), rise: int = 0) -> None:
        self.now = 0
        self.driver = LineDriver()
        self.chips = list(chips)
        self.partners: list[Party] = [self.driver, *partners]
        self.rise_time = rise
        self.level = [1, 1]
        self.edges: list[Edge] = []
        self._rising = [NEVER, NEVER]

    def join(self, partner: Party) -> None:
        self.partners.append(partner)
        partner.pins(self.now, self.level[SCL] | self.level[SDA] << 1)

    def settle(self) -> None:
        """Update the wires and notify all parties until no wire changes."""
        moved = True
        while moved:
            moved = False
            both = RELEASED
            for party in (*self.partners, *self.chips):
                both &= party.out
            for line in (SCL, SDA):
                moved |= self._move(line, both >> line & 1)
            if moved:
                for party in (*self.partners, *self.chips):
                    party.pins(self.now, self.level[SCL] | self.level[SDA] << 1)

    def _move(self, line: int, driven: int) -> bool:
        if driven and not self.level[line] and self.rise_time:
            if self._rising[line] == NEVER:
                self._rising[line] = self.now + self.rise_time
            driven = int(self._rising[line] <= self.now)
        elif not driven:
            self._rising[line] = NEVER
        if driven == self.level[line]:
            return False
        self._rising[line] = NEVER
        self.level[line] = driven
        self.edges.append(Edge(self.now, line, driven))
        return True

    def nearest(self) -> int:
        return min(*self._rising, *(p.next_wake for p in (*self.partners, *self.chips)))

    def _event(self) -> None:
        """Run everything that is due in this cycle."""
        for _ in range(50):
            for partner in self.partners:
                if partner.next_wake <= self.now:
                    partner.wake(self.now)
            self.settle()
            for chip in self.chips:
                if chip.next_wake <= self.now:
                    chip.wake(self.now)
            self.settle()
            if self.nearest() > self.now:
                return
        raise AssertionError(f"a partner or chip repeatedly requests a wake-up at {self.now}")

    def run_until(self, time: int) -> None:
        while self.nearest() <= time:
            self.now = max(self.now, self.nearest())
            self._event()
        self.now = max(self.now, time)

    def run(self, cycles: int) -> None:
        self.run_until(self.now + cycles)

    def until(self, done: Callable[[], object], cycles: int = 400 * SLOT) -> int:
        """Run until `done` holds after an event, and return the cycle; raise AssertionError after `cycles`."""
        limit = self.now + cycles
        while not done():
            nearest = self.nearest()
            if nearest > limit:
                raise AssertionError(
                    f"the condition did not hold within {cycles} cycles; transfers until then: {self.decoded()}"
                )
            self.run_until(nearest)
        return self.now

    def decoded(self, since: int = 0, **how: bool | int) -> str:
        """Return the decoded transfers from cycle `since` on, as text."""
        return " ".join(s.text for s in decode(self.edges, **how) if s.start >= since)  # type: ignore[arg-type]

    def decoded_after(self, cycles: int) -> str:
        """Run for some cycles and return all decoded transfers as text."""
        self.run(cycles)
        return self.decoded()

    def times(self, line: int, level: int, since: int = 0) -> list[int]:
        return [e.time for e in self.edges if e.line == line and e.level == level and e.time >= since]

    def edge(self, line: int, level: int, number: int = 1) -> int:
        """Run until this edge has occurred `number` times from now on, and return the cycle of the last."""
        start, have = self.now, len(self.times(line, level))
        self.until(lambda: len(self.times(line, level)) >= have + number)
        assert self.now >= start
        return self.times(line, level)[-1]

    def pull(self, line: int) -> None:
        self.driver.put(line, 0)
        self.settle()

    def release(self, line: int) -> None:
        self.driver.put(line, 1)
        self.settle()

    def pulse(self, line: int, cycles: int) -> None:
        """Pull a line low for a number of cycles."""
        self.pull(line)
        self.run(cycles)
        self.release(line)


# ---- firmware -------------------------------------------------------------------------------------


def mdr(names: str, bc: int = 0) -> int:
    """Return the value of I2CMDR in which IRS and these bits are set."""
    value = MDR["IRS"] | bc
    for name in names.split():
        value |= MDR[name]
    return value


class Bench(Bus):
    """A bus with the module under test, `m`, which is enabled with TI's clock setting and I2CSAR = 0x50.

    second: options of a second module `s`, or None if there is no second module.
    own: I2COAR of `m`.
    """

    def __init__(
        self,
        *partners: Party,
        options: I2cOptions | None = None,
        second: I2cOptions | None = None,
        rise: int = 0,
        psc: int = 14,
        clkl: int = 10,
        clkh: int = 5,
        own: int = 0,
        enable: bool = True,
    ) -> None:
        self.m = I2c(options or I2cOptions())
        chips = [self.m]
        if second is not None:
            chips.append(I2c(second))
        super().__init__(chips, partners, rise)
        self.s = chips[-1]
        for chip in chips:
            chip.gate(0, True)
            self.w("I2CPSC", psc, chip)
            self.w("I2CCLKL", clkl, chip)
            self.w("I2CCLKH", clkh, chip)
            self.w("I2CSAR", 0x50, chip)
            self.w("I2COAR", own * (chip is self.m), chip)
            if enable:
                self.w("I2CMDR", MDR["IRS"], chip)
        self.run(2 * SLOT)

    @property
    def target(self) -> Target:
        """Return the first device on the bus."""
        return next(one for one in self.partners if isinstance(one, Target))

    @property
    def foreign(self) -> Foreign:
        """Return the first other master."""
        return next(one for one in self.partners if isinstance(one, Foreign))

    # registers

    def w(self, register: str, value: int, chip: I2c | None = None) -> None:
        (chip or self.m).write(self.now, OFFSET[register], value)
        self.settle()

    def r(self, register: str, chip: I2c | None = None) -> int:
        value = (chip or self.m).read(self.now, OFFSET[register])
        self.settle()
        return value

    def peek(self, register: str, chip: I2c | None = None) -> int:
        return (chip or self.m).peek(self.now, OFFSET[register])

    def mode(
        self, names: str, bc: int = 0, chip: I2c | None = None, count: int | None = None, data: int | None = None
    ) -> None:
        """Write I2CMDR with IRS and these bits set. count, data: values written to I2CCNT and I2CDXR before."""
        if count is not None:
            self.w("I2CCNT", count, chip)
        if data is not None:
            self.w("I2CDXR", data, chip)
        self.w("I2CMDR", mdr(names, bc), chip)

    def set(self, names: str, chip: I2c | None = None) -> None:
        """Set bits of I2CMDR by a read-modify-write access."""
        value = self.r("I2CMDR", chip)
        for name in names.split():
            value |= MDR[name]
        self.w("I2CMDR", value, chip)

    def flag(self, name: str, chip: I2c | None = None) -> int:
        """Return a bit of I2CSTR or I2CMDR, read without side effects."""
        if name in FLAGS:
            return int(bool(self.peek("I2CSTR", chip) & FLAGS[name]))
        return int(bool(self.peek("I2CMDR", chip) & MDR[name]))

    def flags(self, names: str, chip: I2c | None = None) -> str:
        """Return the names of the flags that are 1."""
        return " ".join(n for n in names.split() if self.flag(n, chip))

    def clear(self, names: str, chip: I2c | None = None) -> None:
        self.w("I2CSTR", sum(FLAGS[n] for n in names.split()), chip)

    # sequences of firmware accesses

    def feed(self, data: Iterable[int], chip: I2c | None = None, cycles: int = 400 * SLOT) -> None:
        """Write each byte to I2CDXR as soon as XRDY is 1."""
        for byte in data:
            self.until(lambda: self.flag("XRDY", chip), cycles)
            self.w("I2CDXR", byte, chip)

    def drain(self, count: int, chip: I2c | None = None, cycles: int = 400 * SLOT) -> list[int]:
        """Read I2CDRR each time RRDY is 1, and return the bytes."""
        got = []
        for _ in range(count):
            self.until(lambda: self.flag("RRDY", chip), cycles)
            got.append(self.r("I2CDRR", chip))
        return got

    def send(
        self, data: Iterable[int], extra: str = "STP", bc: int = 0, count: int | None = None, until: str = ""
    ) -> None:
        """Send bytes to the address in I2CSAR. extra: further bits of I2CMDR; until: run until this flag is 1."""
        data = list(data)
        self.mode(f"MST TRX STT {extra}", bc, count=len(data) if count is None else count)
        self.feed(data)
        if until:
            self.until(lambda: self.flag(until))

    def stopped(self, cycles: int = 400 * SLOT) -> int:
        """Run until the module has sent its STOP and the bus is free, and return the cycle."""
        return self.until(lambda: self.level == [1, 1] and not self.flag("BB") and not self.flag("STP"), cycles)

    def decoded_at_stop(self, since: int = 0, **how: bool | int) -> str:
        """Run until the module has sent its STOP, and return the decoded transfers as text."""
        self.stopped()
        return self.decoded(since, **how)

    def stop(self) -> None:
        """Set STP and run until the STOP was sent."""
        self.set("STP")
        self.stopped()

    def after(self, flag: str, clocks: int = 1) -> None:
        """Run until a flag is 1, and then for a number of SCL periods."""
        self.until(lambda: self.flag(flag))
        self.run(clocks * SLOT)

    def suspend(self, on: bool) -> None:
        """Stop at a breakpoint (True), or continue (False)."""
        self.m.suspend(self.now, on)
        self.settle()

    def write_all(self, data: Iterable[int], extra: str = "STP", bc: int = 0) -> str:
        """Send all bytes and a STOP, and return the decoded transfer as text."""
        since = self.now
        self.send(data, extra, bc)
        self.stopped()
        return self.decoded(since, bits=bc or 8)

    def read_all(self, count: int, extra: str = "STP", bc: int = 0) -> list[int]:
        self.w("I2CCNT", count)
        self.mode(f"MST STT {extra}", bc)
        got = self.drain(count)
        self.stopped()
        return got

    def held(self, cycles: int = 4 * SLOT) -> bool:
        """Run for the given time and return True if SCL was low throughout."""
        before = len(self.times(SCL, 1))
        self.run(cycles)
        return self.level[SCL] == 0 and len(self.times(SCL, 1)) == before

    def quiet(self, cycles: int = 20 * SLOT) -> bool:
        """Run for the given time and return True if no wire changed."""
        before = len(self.edges)
        self.run(cycles)
        return len(self.edges) == before

    def duties(self, chip: I2c | None = None) -> list[Note]:
        """Return the "duty" notes of a chip, which report broken rules, and remove all its notes."""
        notes = (chip or self.m).notes
        found = [n for n in notes if n.code == "duty"]
        notes.clear()
        return found

    # timing diagrams

    def drive(self, now: int, signal: str, level: int) -> None:
        """Pull (0) or release (1) SCL or SDA, write a register, or set a bit of I2CMDR."""
        self.run_until(now)
        if signal in LINES:
            (self.release if level else self.pull)(LINES.index(signal))
        elif signal in OFFSET:
            self.w(signal, level)
        elif level:
            self.set(signal)

    def show(self, signal: str) -> int:
        if signal in LINES:
            return self.level[LINES.index(signal)]
        return self.peek(signal) if signal in OFFSET else self.flag(signal)


def with_(**options: Value) -> I2cOptions:
    """Return options with these values, after validation; the others have their default."""
    return options_from(I2cOptions, options)
