"""Open loop: the exact edges of an I2C capture go to the chip, and its outputs are compared with them.

    capture --every edge of SCL and SDA--> the chip's inputs, on which it drives nothing
                                           the chip's outputs --> back wires: its own pulls
    bits that its address must drive:             capture's level  <-- compare -->  back wire as SCL rises
    all other bits:                               capture's level  <-- compare -->  the same, unless it pulls SDA

If the chip still holds SCL when SCL rises in the capture, its answer is late, and the rest of its data differs from the
data that it would send to a controller that waits. Low phases that are longer than usual in the capture are counted if
the chip would have ended them earlier, because the chip did not need them.

An edge of SDA that shares a sample with an edge of SCL is moved half a sample into the low phase.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from ..bus.edge_player import EdgePlayer
from ..bus.one_way import OneWayWire
from ..core.kernel import Kernel
from ..core.records import Recorder
from ..core.wire import Wire
from ..scene.case.model import Case
from ..scene.context import SceneWires
from ..scene.scene import Scene
from ..traces.capture.capture import Capture, Channel
from ..traces.decode import i2c as decode
from .compare import TIMING, Divergence, compare, i2c_words
from .divergence_history import AS_SLAVE, CaptureOrigin, FlagHistory, with_history
from .i2c_setup import TAIL, Played, answering, played
from .picture import LINES, Side, divergence_picture, last_agreed, title_of
from .report import Report, verdict_of
from .scene_setup import LEAD, alone, taken, tolerance_of
from .wire_log import WireLog

if TYPE_CHECKING:
    from ..records.recording import Subscribe

STEPS = 100  # number of reports of progress

Position = int | Fraction  # a position in a capture; a Fraction if an edge was moved by half a sample


class _OpenWires(SceneWires):
    def made(self, kernel: Kernel, name: str, recorder: Recorder) -> Wire:
        return (OneWayWire if name in ("SCL", "SDA") else Wire)(kernel, name, recorder)


class OpenScene(Scene):
    """A scene whose SCL and SDA are not driven by its units."""

    WIRES = _OpenWires


@dataclass(frozen=True)
class _Held:
    """A low phase of SCL before a bit of the chip. Times are in seconds."""

    at: Fraction  # the rise of SCL in the capture
    captured: Fraction  # the low time of SCL in the capture
    needed: Fraction  # the time for which the chip holds SCL low after its fall
    late: Fraction  # the time from the captured rise to the chip's release of SCL; 0 if the chip releases it before
    bit: str


class I2cOpenReplay:
    """A replay like `I2cReplay`, except that the played controller does not wait for the chip."""

    def __init__(
        self,
        case: Case,
        capture: Capture,
        scl: str | int,
        sda: str | int,
        addresses: Sequence[int] = (),
        first: int | None = None,
        subscribe: Subscribe | None = None,
        tolerance: Fraction | None = None,
    ) -> None:
        self._given = (case, capture, scl, sda, addresses, first)
        self._part = part = played(capture, scl, sda, first)
        self._answering = found = answering(case, part, addresses)
        self._scene = scene = OpenScene(alone(case, found.unit, "controller", found.forced, found.offered), subscribe)
        self.kernel = scene.kernel
        self.origin = scene.start + scene.timebase.ticks(LEAD, "nearest")
        self._first = first
        self._tolerance = tolerance
        self._per_position = scene.timebase.per_second / part.rate
        back = [wire.back for wire in (scene.wire("SCL"), scene.wire("SDA")) if isinstance(wire, OneWayWire)]
        self.log = WireLog(*back)
        self._end = self._last_position()
        lines = capture.channel(scl), capture.channel(sda)
        for name, line, edges in zip(("SCL", "SDA"), lines, _edges(*lines, part.half_sample, self._end), strict=True):
            ticks = [(self._tick(at), level) for at, level in edges]
            if not line.initial:  # the line falls before the firmware enables the module, so that it sees no START
                ticks.insert(0, (scene.start, 0))
            EdgePlayer(scene.kernel, scene.wire(name), ticks)

    def _last_position(self) -> int:
        """Return the position at which the played part ends."""
        last = self._part.transfers[-1]
        return self._part.capture.length if self._first is None or last.stop is None else last.stop.at

    # Running ------------------------------------------------------------------------

    def run(self, progress: Callable[[float], None] | None = None) -> Report:
        """Play the capture and compare."""
        wall = perf_counter()
        begin, end = self.kernel.now, self._end_tick()
        for step in range(1, STEPS + 1):
            self.kernel.run_until(begin + (end - begin) * step // STEPS)
            if progress is not None:
                progress(step / STEPS)
        return self._report(perf_counter() - wall)

    def _end_tick(self) -> int:
        return self.origin + int(self._end * self._per_position) + self._scene.timebase.ticks(TAIL, "nearest")

    def _again(self, history: FlagHistory, until: int) -> None:
        replay = I2cOpenReplay(*self._given, subscribe=history.subscribe)
        history.watch(replay._scene)
        replay.kernel.run_until(min(until + 1, replay._end_tick()))

    # The chip's own outputs ----------------------------------------------------

    def _would_be(self, sda: Channel) -> list[decode.Transfer]:
        """Return the capture's transfers with the chip's bits where its address must drive."""
        found: list[decode.Transfer] = []
        for transfer in self._part.transfers:
            phases = []
            for phase in transfer.phases:
                own = phase.address in self._answering.own
                phases.append(
                    decode.Phase(
                        phase.start,
                        phase.address,
                        phase.read,
                        tuple(self._byte(byte, own, sda) for byte in phase.bytes),
                    )
                )
            found.append(decode.Transfer(tuple(phases), transfer.stop, transfer.gap))
        return found

    def _byte(self, byte: decode.Byte, own: bool, sda: Channel) -> decode.Byte:
        chip = sda.before(np.array([self._tick(bit.at) for bit in byte.bits], np.int64)).tolist()
        bits = []
        for bit, level in zip(byte.bits, chip, strict=True):
            ours = own and bit.driver is decode.Party.TARGET
            bits.append(bit._replace(value=level if ours else bit.value & level))
        value: int | None = None
        if byte.value is not None:
            value = 0
            for bit in bits[:8]:
                value = value << 1 | bit.value
        return decode.Byte(byte.at, value, None if byte.acked is None else not bits[8].value, tuple(bits))

    def _tick(self, position: Position) -> int:
        return self.origin + int(position * self._per_position)

    def _holds(self, scl: Channel) -> list[_Held]:
        """Return every low phase of the capture in a turn of the chip, with the chip's hold of SCL in it."""
        edges = scl.edges[scl.levels == 0].tolist(), scl.edges[scl.levels == 1].tolist()
        own = [
            phase
            for transfer in self._part.transfers
            for phase in transfer.phases
            if phase.address in self._answering.own
        ]
        return [
            self._held(
                f"{f'byte {number}' if number else 'address'} {f'bit {place}' if place < 8 else 'ACK'}", bit, edges
            )
            for phase in own
            for number, byte in enumerate(phase.bytes)
            for place, bit in enumerate(byte.bits)
            if bit.low is not None
        ]

    def _held(self, name: str, bit: decode.Bit, edges: tuple[list[int], list[int]]) -> _Held:
        """Return the low phase before a bit. edges: the chip's own falling and rising edges of SCL."""
        assert bit.low is not None
        falls, rises = edges
        rise, fall = self._tick(bit.at), self._tick(bit.at - bit.low)
        over = fall
        pull = bisect_left(falls, fall)  # the chip's first pull in this low phase, if any
        if pull < len(falls) and falls[pull] < rise:
            let_go = bisect_left(rises, falls[pull])
            over = rises[let_go] if let_go < len(rises) else self.kernel.now
        per_second = self._scene.timebase.per_second
        return _Held(
            Fraction(bit.at) / self._part.rate,
            Fraction(bit.low) / self._part.rate,
            Fraction(over - fall, per_second),
            Fraction(max(0, over - rise), per_second),
            name,
        )

    # Summing up ---------------------------------------------------------------------

    def _report(self, wall: float) -> Report:
        scene, kernel, part, own = self._scene, self.kernel, self._part, self._answering
        result = scene.run(Fraction(0))
        driven = self.log.capture(scene.timebase, kernel.now)
        self._driven = driven
        self._transfers = self._would_be(driven.channel("SDA"))
        events = [event for transfer in self._transfers for event in decode.events_of(transfer)]
        tolerance = tolerance_of(self._tolerance, part.sample_rate, scene)
        self._compared = i2c_words(part.expected, part.rate), i2c_words(events, part.rate)
        outcome = compare(*self._compared)
        held = self._holds(driven.channel("SCL"))
        late = [one for one in held if one.late > tolerance]
        first_late = tuple(self._late(one, part) for one in late[:1])
        ranked = tuple(sorted(outcome.ranked + first_late, key=lambda divergence: divergence.index))
        byte = int(9 * (part.low + part.high) * self._per_position)
        us = 1_000_000
        return Report(
            case=scene.case.name,
            capture=str(part.capture.path),
            kind="i2c",
            loop="open",
            verdict=verdict_of(bool(ranked), bool(own.asked)),
            events=len(part.expected),
            agreed=outcome.agreed,
            captured_events=part.captured_events,
            transfers=len(part.transfers),
            captured_transfers=len(part.whole),
            filled=taken(self._given[0], own.unit, own.offered),
            unjudged=own.unjudged,
            first_divergence=outcome.divergence,
            divergences=with_history(
                ranked, CaptureOrigin(scene, self.origin, byte), self._answering.unit, AS_SLAVE, self._again
            ),
            tolerance_us=float(tolerance * us),
            bytes=sum(isinstance(event, decode.Address | decode.Data) for event in events),
            addresses=[f"{address:02X}" for address in own.own],
            nacks=sum(isinstance(event, decode.Nack) for event in events),
            captured_stretch_us=float(part.stretch / part.rate * 1_000_000),
            stretch_worst_us=float(max((one.needed for one in held), default=Fraction(0)) * us),
            stretch_total_us=float(sum((one.needed for one in held), Fraction(0)) * us),
            late_worst_us=float(max((one.late for one in held), default=Fraction(0)) * us),
            simulated_s=float(scene.timebase.seconds(kernel.now - scene.start)),
            wall_s=round(wall, 6),
            kernel_events=kernel.events,
            unknowns=result.unknowns,
            notes=part.notes + self._pauses(held, late) + result.notes,
        )

    def picture(self, report: Report) -> str | None:
        """Return the first divergence of a run as SVG text; None without any."""
        if not report.divergences:
            return None
        divergence, part = report.divergences[0], self._part
        was, came = last_agreed(divergence, *self._compared)
        lines = tuple(
            (name, part.capture.channel(channel)) for name, channel in zip(LINES, self._given[2:4], strict=True)
        )
        captured = Side("capture", lines, part.rate, 0, part.transfers, was)
        wires = tuple((name, self._driven.channel(name)) for name in LINES)
        per_second = Fraction(self._scene.timebase.per_second)
        side = Side("chip would drive", wires, per_second, self.origin, self._transfers, came, (part.rate, 0))
        return divergence_picture(divergence, title_of(report, divergence), captured, side, part.bit)

    def _late(self, held: _Held, part: Played) -> Divergence:
        """Return the first answer that was not ready as a divergence in time."""
        index = sum(Fraction(event.at) / part.rate < held.at for event in part.expected)
        return Divergence(
            index,
            f"SCL rises for {held.bit}",
            f"SCL held for another {float(held.late * 1_000_000):.3f} us",
            float(held.at),
            float(held.at + held.late),
            TIMING,
        )

    def _pauses(self, held: list[_Held], late: list[_Held]) -> list[str]:
        """Return notes on stretches of SCL by only one of the two sides."""
        notes = []
        long = [one for one in held if one.captured > self._part.long_low / self._part.rate]
        spare = [one for one in long if one.needed < one.captured]
        if spare:
            most = max(spare, key=lambda one: one.captured - one.needed)
            notes.append(
                f"long low phases of the capture that the chip would not have made: {len(spare)} of {len(long)}; "
                f"at {float(most.at):.6f} s it has {_us(most.captured)}, the chip held SCL for {_us(most.needed)} of it"
            )
        if late:
            worst = max(late, key=lambda one: one.late)
            notes.append(
                f"stretches that the chip would have made and the capture lacks: {len(late)}; the longest "
                f"{_us(worst.late)} past SCL's rise at {float(worst.at):.6f} s"
            )
        return notes


def _us(seconds: Fraction) -> str:
    return f"{float(seconds * 1_000_000):.3f} us"


def _edges(
    scl: Channel, sda: Channel, half_sample: Fraction, end: int
) -> tuple[list[tuple[Position, int]], list[tuple[Position, int]]]:
    """Return (position, level) of both lines up to `end`; SDA's edges in a sample of SCL's are moved half a sample."""
    rising = dict(_up_to(end + half_sample, scl))
    data: list[tuple[Position, int]] = []
    for at, level in _up_to(end + half_sample, sda):
        if at in rising:
            moved = at + (-half_sample if rising[at] else half_sample)
            if moved <= end:
                data.append((moved, level))
        elif at <= end:
            data.append((at, level))
    return [*_up_to(end, scl)], data


def _up_to(end: Position, line: Channel) -> list[tuple[int, int]]:
    count = int(np.searchsorted(line.edges, int(end), "right"))
    return list(zip(line.edges[:count].tolist(), line.levels[:count].tolist(), strict=True))
