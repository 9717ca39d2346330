"""A bare SCI and a few lines around it: frames and register writes go in; TXD edges, fields and requests come out.

    levels ("0 10101010 1") --> RXD --> Sci --> TXD --> edges --> levels
                 register fields --> Sci --> requests, counted

The rig shares nothing with the model but its register map (names) and its options. Its
own view of time: cycles of SYSCLKOUT, an SCICLK is `sciclk` of them, a bit is `bit`.
The model's SCICLK runs freely, so the rig first finds where it ticks (a twin sends one
character and its start bit is looked at) and then lets every diagram begin half an
SCICLK off the ticks: column n of a diagram in SCICLK holds exactly sample n.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Self

from periph_sim.core.options import options_from
from periph_sim.f28335.sci.module import Sci
from periph_sim.f28335.sci.options import SciOptions
from periph_sim.f28335.sci.register_map import SCI_MAP
from tests.f28335.module_rig import ModuleRig

START = 4000  # cycles from switching on to the first column, so that nothing of the set-up is left under way

# Which register a field is in. Registers of one value (SCIHBAUD, SCITXBUF, ...) are named as registers.
REGISTER_OF = {f.name: r for r in SCI_MAP for f in r.fields if f.name not in SCI_MAP}

RUNNING = {"SCICHAR": 7, "RXENA": 1, "TXENA": 1, "SWRESET": 1}  # 8-N-1, both directions on
FIFO = {"SCIRST": 1, "SCIFFENA": 1, "TXFIFOXRESET": 1, "RXFIFORESET": 1}


def levels(text: str) -> str:
    """A frame as it is drawn, "0 10101010 1", without the blanks."""
    return text.replace(" ", "")


def frame(
    data: int, bits: int = 8, *, address: int | None = None, parity: str = "none", stops: int = 1, bad: str = ""
) -> str:
    """The levels of one frame, one character a bit. bad: "parity" or "stop", which is then sent inverted."""
    body = [data >> i & 1 for i in range(bits)]
    if address is not None:
        body.append(address)
    if parity != "none":
        odd_now = sum(body) % 2
        body.append((odd_now if parity == "even" else 1 - odd_now) ^ (bad == "parity"))
    return "".join(str(b) for b in [0, *body, *[0 if bad == "stop" and i == 0 else 1 for i in range(stops)]])


class Module(Sci):
    """A class of Python, compiled or not: tests put calls of their own in the place of its methods."""


class _Line(ModuleRig):
    """The chip and its line RXD. level: of RXD."""

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
            self.look()
        self.run_until(now)


class SciRig(_Line):
    """options: open questions by name. fields: register fields by name, beside 8-N-1 with both directions on.

    fifo=True switches the FIFOs on; raw=True leaves every register at its reset value.
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
        """Now is the next cycle that lies half an SCICLK off the ticks."""
        self.run_until(self.now + (self._half - self.now) % self.sciclk)
        return self.now

    def wait(self, bits: float = 0, *, sciclk: float = 0, cycles: int = 0) -> None:
        self.run_until(self.now + round(bits * self.bit + sciclk * self.sciclk) + cycles)

    # Signals of a diagram.

    def columns(self) -> tuple[int, int]:
        return self.bit, self.now

    def drive(self, now: int, signal: str, level: int) -> None:
        """RXD, or as for any module."""
        if signal == "RXD":
            self.rxd(now, level)
        else:
            super().drive(now, signal, level)

    def show(self, signal: str) -> int:
        """RXD, TXD, a field, a whole register, or how often RXINT or TXINT was asked for (last hex digit)."""
        if signal in ("RXINT", "TXINT"):
            return self.count(signal) % 16
        if signal == "TXD":
            return self.chip.out
        if signal == "RXD":
            return self.level
        return self.get(signal)

    def reset(self) -> None:
        """System reset, and the module's clock switched on again, which the reset had switched off."""
        self.chip.reset(self.now)
        self.look()
        self.chip.gate(self.now, True)
        self.look()

    def set_brr(self, brr: int) -> None:
        """Writes both halves; `sciclk` and `bit` follow. The ticks lie anywhere afterwards."""
        self.write("SCIHBAUD", brr >> 8)
        self.write("SCILBAUD", brr & 0xFF)
        self.sciclk = 4 * (max(brr, 1) + 1)
        self.bit = 8 * self.sciclk

    # RXD.

    def send(self, text: str, *, bit: float = 0, glitches: tuple[tuple[int, int], ...] = (), at: int = -1) -> int:
        """When the first bit began. Plays levels into RXD, one a bit, and stays there to the end of the last.

        bit: the sender's bit in cycles, the receiver's own if 0. glitches: (bit, sub-sample 1..8) sent inverted.
        at: when to begin; the next cycle half an SCICLK off the ticks if not given.
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
        """When the first sample's column began. The same with one level an SCICLK."""
        return self.send(text, bit=self.sciclk)

    def heard(self, text: str) -> Self:
        """Plays levels into RXD."""
        self.send(text)
        return self

    def take(self, text: str) -> int:
        """Plays levels into RXD, and reads SCIRXBUF."""
        self.send(text)
        return self.read("SCIRXBUF")

    def restart(self) -> None:
        """SW RESET is written 0, then 1."""
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
        """The levels in the middle of `count` bits of TXD from `start` on; the rig runs on until they are over."""
        self.run_until(max(self.now, start + count * self.bit))
        return "".join(str(self.txd_at(start + i * self.bit + self.bit // 2)) for i in range(count))

    def put(self, word: int, bits: float = 0, *, sciclk: float = 0, cycles: int = 0) -> Self:
        """Write SCITXBUF, and wait."""
        self.write("SCITXBUF", word)
        self.wait(bits, sciclk=sciclk, cycles=cycles)
        return self

    def transmit(self, word: int, count: int) -> str:
        """Writes `word` to SCITXBUF of an idle transmitter: the first `count` bits from its start bit on."""
        seen = len(self.edges)
        self.write("SCITXBUF", word)
        self.wait(3)
        assert len(self.edges) > seen, "no start bit within three bits of the write"
        return self.sent(self.edges[seen][0], count)

    def frames(self, length: int) -> list[tuple[int, str]]:
        """(start, levels) of every frame on TXD so far, each `length` bits long; the rig's own decoder."""
        found: list[tuple[int, str]] = []
        for fall in self.falls():
            if not found or fall >= found[-1][0] + length * self.bit - self.bit // 2:
                marks = (self.txd_at(fall + i * self.bit + self.bit // 2) for i in range(length))
                found.append((fall, "".join(str(m) for m in marks)))
        return found

    def characters(self, bits: int = 8, extra: int = 0, wait: float = 0) -> list[int]:
        """The data of every frame on TXD after so many bits; extra: bits between data and the single stop bit."""
        self.wait(wait)
        return [int(text[1 : 1 + bits][::-1], 2) for _, text in self.frames(bits + 2 + extra)]

    def changes(self, signal: str, cycles: int) -> Iterator[tuple[int, int]]:
        """(time, new value) whenever `signal` changes within the next `cycles`, looked at in every cycle."""
        before = self.show(signal)
        for time in range(self.now + 1, self.now + cycles + 1):
            self.run_until(time)
            if self.show(signal) != before:
                before = self.show(signal)
                yield time, before
