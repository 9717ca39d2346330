"""A bare SCI and a rig that drives RXD and registers and records edges of TXD and interrupt requests.

    levels ("0 10101010 1") --> RXD --> Sci --> TXD --> edges --> levels
                 register fields --> Sci --> requests (counted)

The rig shares only the register map (names) and the options with the model. Times are in
cycles of SYSCLKOUT; an SCICLK has `sciclk` cycles, and a bit has `bit` cycles.
The model's SCICLK runs freely. So the rig first finds the cycles of its ticks: it lets a
second module send a character and measures the start bit. Every diagram begins half an
SCICLK before a tick, so that column n of a diagram in SCICLK contains exactly sample n.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Self

from periph_sim.core.options import options_from
from periph_sim.f28335.sci.module import Sci
from periph_sim.f28335.sci.options import SciOptions
from periph_sim.f28335.sci.register_map import SCI_MAP
from tests.f28335.module_rig import ModuleRig

START = 4000  # cycles from enabling the clock to the first column; all effects of the set-up are over by then

# Field -> its register. Registers with a single value (SCIHBAUD, SCITXBUF, ...) are named like registers.
REGISTER_OF = {f.name: r for r in SCI_MAP for f in r.fields if f.name not in SCI_MAP}

RUNNING = {"SCICHAR": 7, "RXENA": 1, "TXENA": 1, "SWRESET": 1}  # 8-N-1, receiver and transmitter enabled
FIFO = {"SCIRST": 1, "SCIFFENA": 1, "TXFIFOXRESET": 1, "RXFIFORESET": 1}


def levels(text: str) -> str:
    """Return a frame such as "0 10101010 1" without the blanks."""
    return text.replace(" ", "")


def frame(
    data: int, bits: int = 8, *, address: int | None = None, parity: str = "none", stops: int = 1, bad: str = ""
) -> str:
    """Return the levels of a frame, one character per bit. bad: "parity" or "stop", the bit that is inverted."""
    body = [data >> i & 1 for i in range(bits)]
    if address is not None:
        body.append(address)
    if parity != "none":
        odd_now = sum(body) % 2
        body.append((odd_now if parity == "even" else 1 - odd_now) ^ (bad == "parity"))
    return "".join(str(b) for b in [0, *body, *[0 if bad == "stop" and i == 0 else 1 for i in range(stops)]])


class Module(Sci):
    """A Python class, so that tests can replace its methods even if the core is compiled."""


class _Line(ModuleRig):
    """The chip and its input. level: the level of RXD."""

    register_of = REGISTER_OF
    buffer = "SCIRXBUF"

    def __init__(self, options: SciOptions) -> None:
        super().__init__(Module(options=options))
        self.level = 1

    def set_up(self, brr: int | None, fields: dict[str, int]) -> Self:
        if brr is not None:
            self.write("SCIHBAUD", brr >> 8)
            self.write("SCILBAUD", brr & 0xFF)
        last = {"SCICTL1": 1, "SCICTL2": 2, "SCIFFCT": 3}
        for name in sorted(fields, key=lambda n: last.get(REGISTER_OF[n].name, 0)):
            if REGISTER_OF[name].name not in last:
                self.set(**{name: fields[name]})
        for register in last:
            group = {n: v for n, v in fields.items() if REGISTER_OF[n].name == register}
            if group:
                self.set(**group)
        self.run_until(START)
        return self

    def start_of_a_frame(self) -> int:
        self.write("SCITXBUF", 0)
        while not self.edges:
            self.run_until(self.now + 16)
        return self.edges[0][0]

    def rxd(self, now: int, level: int) -> None:
        self.run_until(now - 1)
        self.now = now
        if level != self.level:
            self.level = level
            self.chip.pins(now, level)
            self.observe()
        self.run_until(now)


class SciRig(_Line):
    """A rig whose module is set to 8-N-1, with receiver and transmitter enabled.

    options: option -> value.
    fields: further register fields, by name.
    fifo: enable the FIFOs.
    raw: leave all registers at their reset values.
    """

    def __init__(
        self,
        options: dict[str, str | int | bool] | None = None,
        /,
        *,
        brr: int = 24,
        fifo: int = False,
        raw: int = False,
        **fields: int,
    ) -> None:
        self.brr = brr
        self.sciclk = 4 * (max(brr, 1) + 1)
        self.bit = 8 * self.sciclk
        setting = {} if raw else {**RUNNING, **(FIFO if fifo else {}), **fields}
        grid = _Line(SciOptions()).set_up(brr, {**RUNNING}).start_of_a_frame() % self.sciclk
        super().__init__(options_from(SciOptions, options or {}))
        self.set_up(None if raw else brr, setting)
        self._half = (grid + self.sciclk // 2) % self.sciclk
        self.align()

    # Time.

    def align(self) -> int:
        """Run until the next cycle that is half an SCICLK before a tick, and return it."""
        self.run_until(self.now + (self._half - self.now) % self.sciclk)
        return self.now

    def wait(self, bits: float = 0, *, sciclk: float = 0, cycles: int = 0) -> None:
        self.run_until(self.now + round(bits * self.bit + sciclk * self.sciclk) + cycles)

    # Signals of a diagram.

    def columns(self) -> tuple[int, int]:
        return self.bit, self.now

    def drive(self, now: int, signal: str, level: int) -> None:
        """Set RXD, or a signal that every module has."""
        if signal == "RXD":
            self.rxd(now, level)
        else:
            super().drive(now, signal, level)

    def show(self, signal: str) -> int:
        """Return RXD, TXD, a field, a register, or the number of requests of RXINT or TXINT (last hex digit)."""
        if signal in ("RXINT", "TXINT"):
            return self.count(signal) % 16
        if signal == "TXD":
            return self.chip.out
        if signal == "RXD":
            return self.level
        return self.get(signal)

    def reset(self) -> None:
        """Apply a system reset, and enable the clock of the module again."""
        self.chip.reset(self.now)
        self.observe()
        self.chip.gate(self.now, True)
        self.observe()

    def set_brr(self, brr: int) -> None:
        """Write both halves of BRR and update `sciclk` and `bit`. The phase of the ticks is unknown afterwards."""
        self.write("SCIHBAUD", brr >> 8)
        self.write("SCILBAUD", brr & 0xFF)
        self.sciclk = 4 * (max(brr, 1) + 1)
        self.bit = 8 * self.sciclk

    # RXD.

    def send(self, text: str, *, bit: float = 0, glitches: tuple[tuple[int, int], ...] = (), at: int = -1) -> int:
        """Send levels on RXD, one per bit, run until the end of the last bit, and return the start of the first.

        bit: length of a bit in cycles; 0: that of the receiver.
        glitches: (bit, sub-sample 1 to 8) of each sub-sample that is sent inverted.
        at: start; by default, the next cycle that is half an SCICLK before a tick.
        """
        length = bit or self.bit
        begin = self.align() if at < 0 else at
        changes: dict[int, int] = {}
        for i, mark in enumerate(levels(text)):
            changes[begin + round(i * length)] = int(mark)
        for place, sub in glitches:
            level = int(levels(text)[place])
            changes[begin + round((place + (sub - 1) / 8) * length)] = 1 - level
            after = begin + round((place + sub / 8) * length)
            changes.setdefault(after, level)
        for time in sorted(changes):
            self.rxd(time, changes[time])
        self.run_until(begin + round(len(levels(text)) * length))
        return begin

    def send_samples(self, text: str) -> int:
        """Send levels on RXD, one per SCICLK, and return the start of the first."""
        return self.send(text, bit=self.sciclk)

    def with_rxd(self, text: str) -> Self:
        """Send levels on RXD, and return the rig."""
        self.send(text)
        return self

    def send_and_read(self, text: str) -> int:
        """Send levels on RXD, and read SCIRXBUF."""
        self.send(text)
        return self.read("SCIRXBUF")

    def restart(self) -> None:
        """Write SW RESET = 0, then 1."""
        self.set(SWRESET=0)
        self.set(SWRESET=1)

    # TXD.

    def falls(self) -> list[int]:
        return [time for time, level in self.edges if level == 0]

    def txd_at(self, time: int) -> int:
        level = 1
        for when, new in self.edges:
            if when > time:
                break
            level = new
        return level

    def sent(self, start: int, count: int) -> str:
        """Return the levels in the middle of `count` bits of TXD from `start` on, after running until their end."""
        self.run_until(max(self.now, start + count * self.bit))
        return "".join(str(self.txd_at(start + i * self.bit + self.bit // 2)) for i in range(count))

    def put(self, word: int, bits: float = 0, *, sciclk: float = 0, cycles: int = 0) -> Self:
        """Write SCITXBUF, and wait."""
        self.write("SCITXBUF", word)
        self.wait(bits, sciclk=sciclk, cycles=cycles)
        return self

    def transmit(self, word: int, count: int) -> str:
        """Write SCITXBUF of an idle transmitter, and return the first `count` bits from the start bit on."""
        seen = len(self.edges)
        self.write("SCITXBUF", word)
        self.wait(3)
        assert len(self.edges) > seen, "no start bit within three bits of the write"
        return self.sent(self.edges[seen][0], count)

    def frames(self, length: int) -> list[tuple[int, str]]:
        """Return (start, levels) of every frame on TXD so far, decoded without the model. length: bits of a frame."""
        found: list[tuple[int, str]] = []
        for fall in self.falls():
            if not found or fall >= found[-1][0] + length * self.bit - self.bit // 2:
                marks = (self.txd_at(fall + i * self.bit + self.bit // 2) for i in range(length))
                found.append((fall, "".join(str(m) for m in marks)))
        return found

    def characters(self, bits: int = 8, extra: int = 0, wait: float = 0) -> list[int]:
        """Wait for some bits and return the data of all frames on TXD. extra: bits between data and stop bit."""
        self.wait(wait)
        return [int(text[1 : 1 + bits][::-1], 2) for _, text in self.frames(bits + 2 + extra)]

    def changes(self, signal: str, cycles: int) -> Iterator[tuple[int, int]]:
        """Yield (time, new value) of each change of a signal in the next `cycles`, checked in every cycle."""
        before = self.show(signal)
        for time in range(self.now + 1, self.now + cycles + 1):
            self.run_until(time)
            if self.show(signal) != before:
                before = self.show(signal)
                yield time, before
