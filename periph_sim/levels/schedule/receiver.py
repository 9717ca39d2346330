"""When a host frame asks for service: the begin of a frame goes in, the cycle of the interrupt's latch comes out.

    last byte's start edge --sync--> first sample --due--> FIFO holds the frame --rx_int_extra, IFR_DELAY--> latch

    s = ceil((cycle_at(edge) + sync - phase) / period)        latch = phase + (s + due) * period + extra

A sample is a SCICLK; its place in the CPU's cycles is taken from an edge run of the host alone, as is `due`, and both
are the same for every byte there. The search for a start bit is open when the next one comes, or the case is refused:
so the last byte's own edge decides, whatever came before. Source: f28335.sci.receiver_bits.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ...core.options import options_from
from ...core.records import Kind, Record
from ...devices.host_pc import FRAME_BYTES
from ...f28335.cpu.instruction_costs import IFR_DELAY
from ...f28335.sci.character_format import SciFormat
from ...f28335.sci.options import SciOptions
from ...scene.case.model import Case, HostTable
from ...scene.firmware_loader import Firmware
from ...scene.scene import Scene
from ...scene.uart_lines import line_of
from .clock import CpuClock, Ints
from .errors import refuse

FRAMES = 2
BITS = 10  # of a byte on the line
SCI = "SCI-A"


@dataclass(frozen=True)
class Line:
    """Offsets from a frame's begin in ticks. starts: of each byte's start bit. end: of the last stop bit."""

    starts: tuple[int, ...]
    end: int


def line(host: HostTable, per_second: int) -> Line:
    """As `bus.uart.sender` cuts a burst into bits."""
    bit = Fraction(per_second) / (host.baud * (1 + host.error / 100))
    each = BITS + host.gap
    starts = tuple(int(byte * each * bit // 1) for byte in range(FRAME_BYTES))
    return Line(starts, int(((FRAME_BYTES - 1) * each + BITS) * bit // 1))


@dataclass(frozen=True)
class Receiver:
    """phase, period: of the samples, in cycles. due: samples from a byte's first to its move to the FIFO.

    extra: cycles from there to the IFR. edge: ticks from a frame's begin to its last start bit.
    """

    phase: int
    period: int
    sync: int
    due: int
    extra: int
    edge: int

    def latch(self, clock: CpuClock, begin: Ints, out: Ints) -> Ints:
        """The cycle at which the interrupt of a frame with this begin reaches the IFR. out: where it is written."""
        np.add(begin, self.edge, out=out)
        self._moved(clock, out)
        out += self.extra
        return out

    def moved(self, clock: CpuClock, edge: Ints) -> Ints:
        """The cycle at which a byte with this start edge is in the FIFO."""
        found = edge.copy()
        self._moved(clock, found)
        return found

    def _moved(self, clock: CpuClock, edge: Ints) -> None:
        """In place, in as few passes as can be: - cycle, - sample, the cycle again."""
        edge *= -clock.den
        edge //= clock.num
        edge += self.phase - self.sync
        edge //= self.period
        edge *= -self.period
        edge += self.phase + self.due * self.period


def probe(case: Case, unit: str) -> Case:
    """The host alone: a few frames without jitter, and requests when all is over."""
    host, controller = case.host, case.controller
    assert host is not None and controller is not None
    length = host.first + (FRAMES + 1) * host.period
    quiet = host.model_copy(update={"jitter": Fraction(0), "frames": FRAMES})
    late = controller.model_copy(update={"first": 2 * length})
    return case.model_copy(update={"host": quiet, "controller": late, "budget": (), "breaks": (), "duration": length})


def receiver(case: Case, unit: str, scene_of: Mapping[str, Firmware] | None = None) -> tuple[Receiver, Scene]:
    """Of an edge run of `probe`, which is given too. BadSchedule where bytes do not come as the formula says."""
    quiet = probe(case, unit)
    words: list[tuple[int, int]] = []  # tick, words in the FIFO
    ends: list[int] = []

    def hear(record: Record) -> None:
        if record.what == "SCIFFRX.RXFFST":
            words.append((record.tick, record.value))

    subjects = {Kind.FLAG: {f"{unit}.{SCI}.SCIFFRX"}}
    scene = Scene(quiet, lambda recorder, _: recorder.subscribe([Kind.FLAG], hear, subjects), scene_of)
    assert scene.host is not None and quiet.host is not None
    scene.host.sent.append(lambda number, values, end: ends.append(end - scene.start))
    scene.run(quiet.duration)
    dsp, per_second = scene.units[unit], scene.timebase.per_second
    if not dsp.has(SCI) or not ends:
        raise refuse(case.name, "no host frame reaches the unit's SCI-A")
    bits, options = line(quiet.host, per_second), dsp.plan.answers(SciOptions)
    hz, sci = dsp.clock.hz, line_of(dsp)
    nominal = Fraction(dsp.control.sysclk_hz) / (8 * Fraction(sci.baud))
    exact = per_second / hz
    clock = CpuClock(exact.numerator, exact.denominator)
    if nominal.denominator != 1 or sci.bits != 8 or sci.parity != "none":
        raise refuse(case.name, "the SCI's frames are not 8 data bits without parity")
    moves = [int(clock_cycle(exact, tick - scene.start)) for (tick, now), before in _grown(words) if now > before]
    edges = [end - bits.end + start for end in ends for start in bits.starts]
    form, period = SciFormat(0x07, options_from(SciOptions, case.unit[unit].options.get("sci", {}))), int(nominal)
    if len(moves) != len(edges):
        raise refuse(case.name, f"{len(moves)} of {len(edges)} bytes of the host reach the SCI's FIFO")
    extra = options.rx_int_extra.unrecorded() + IFR_DELAY
    found = Receiver(moves[0] % period, period, options.rx_sync_stages.unrecorded(), form.due, extra, bits.starts[-1])
    if found.moved(clock, np.array(edges)).tolist() != moves:
        raise refuse(case.name, "the host's bytes do not reach the SCI's FIFO a fixed time behind their start bits")
    apart = min(after - before for before, after in zip(bits.starts, bits.starts[1:], strict=False))
    if ((apart * exact.denominator // exact.numerator) - 1) // period < form.hunt:
        raise refuse(case.name, "the host is so much faster than the SCI that start bits come before it looks for them")
    return found, scene


def clock_cycle(cycle: Fraction, tick: int) -> int:
    """The first cycle that begins at or after a tick."""
    return -(-tick * cycle.denominator // cycle.numerator)


def _grown(words: list[tuple[int, int]]) -> list[tuple[tuple[int, int], int]]:
    """Each change with the number of words before it."""
    return list(zip(words, [0, *(count for _, count in words)], strict=False))
