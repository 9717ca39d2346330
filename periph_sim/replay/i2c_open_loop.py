"""Open loop: the chip receives the exact edges of an I2C capture, and its outputs are compared with the capture.

    capture --every edge of SCL and SDA--> input wires, driven by the capture only --> chip
                                           back wires, driven by the chip only     <-- chip
    in bits that the chip must drive:      the back wire must have the captured level when SCL rises
    in all other bits:                     the chip must not pull SDA low if the captured bit is 1

If the chip still holds SCL low when SCL rises in the capture, its answer is late. The chip's later data are then not
those that it would send to a controller that waits. A low phase of the capture that is much longer than usual is a
stretch of the captured target or a pause of the controller. A note in the report counts those in which the simulated
chip released SCL earlier.

An edge of SDA in the same sample as an edge of SCL is moved by half a sample into the low phase of SCL: before a rising
edge of SCL, after a falling edge.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial

import numpy as np

from ..bus.edge_player import EdgePlayer, OneWayWire
from ..core.kernel import Kernel
from ..core.records import Recorder
from ..core.tolerance import Tolerance
from ..core.wire import Wire
from ..records.recording import Subscribe
from ..scene.case.model import Case
from ..scene.context import SceneWires
from ..scene.scene import Scene
from ..traces.capture.capture import Capture, Channel
from ..traces.decode import i2c as decode
from .replay import Progress, SlaveReplay
from .report import TIMING, Divergence, Report, compare, i2c_words, verdict_of
from .setup import LEAD, TAIL, Played, events_of

Position = int | Fraction  # a position in a capture; a Fraction for an edge that was moved by half a sample


class _OpenWires(SceneWires):
    def made(self, kernel: Kernel, name: str, recorder: Recorder) -> Wire:
        return (OneWayWire if name in ("SCL", "SDA") else Wire)(kernel, name, recorder)


class OpenScene(Scene):
    """A scene whose units read SCL and SDA, but drive other wires instead (`OneWayWire.back`)."""

    WIRES = _OpenWires


@dataclass(frozen=True)
class _Held:
    """A low phase of SCL before a bit of a transfer that addresses the chip. Times are in seconds."""

    at: Fraction  # the time at which SCL rises in the capture
    captured: Fraction  # the low time of SCL in the capture
    needed: Fraction  # the time from SCL's falling edge to its release by the chip; 0 if the chip does not pull SCL low
    late: Fraction  # the time from SCL's captured rise to its release by the chip; 0 if the chip releases SCL earlier
    bit: str  # the name of the bit in messages


class I2cOpenReplay(SlaveReplay):
    """A replay like `I2cReplay`, in which the controller does not wait while the chip holds SCL low.

    tolerance: the time for which the chip may hold SCL low after SCL rises in the capture. None: a sample period plus a
        SYSCLKOUT cycle. A longer hold makes the replay fail.

    The other arguments are those of `I2cReplay`.
    """

    LOOP = "open"
    NAME = "chip would drive"

    def __init__(
        self,
        case: Case,
        capture: Capture,
        scl: str | int,
        sda: str | int,
        addresses: Sequence[int] = (),
        first: int | None = None,
        subscribe: Subscribe | None = None,
        tolerance: Tolerance | None = None,
    ) -> None:
        self._repeated = partial(I2cOpenReplay, case, capture, scl, sda, addresses, first)
        super().__init__(case, capture, scl, sda, addresses, first, subscribe, tolerance, LEAD)
        part, scene = self._part, self.scene
        stop = part.transfers[-1].stop
        end = capture.length if first is None or stop is None else stop.at
        self._end_tick = self._tick(end) + self.timebase.ticks(TAIL, "nearest")
        for wire, line, edges in zip(self._wires, part.lines, _edges(*part.lines, part.half_sample, end), strict=True):
            ticks = [(self._tick(at), level) for at, level in edges]
            if not line.initial:  # pull the line low before the module is enabled, so that it detects no START
                ticks.insert(0, (scene.start, 0))
            EdgePlayer(scene.kernel, wire, ticks)

    def _build(self, case: Case, prepared: Case, subscribe: Subscribe | None) -> Scene:
        return OpenScene(prepared, subscribe)

    def _drive(self, progress: Progress | None = None, until: int | None = None) -> str:
        if until is None:
            self._play(self._end_tick, progress)
        else:
            self.kernel.run_until(min(until + 1, self._end_tick))
        return ""

    # The chip's own outputs ----------------------------------------------------

    def _would_be(self, sda: Channel) -> list[decode.Transfer]:
        """Return the capture's transfers with the bits that they would have if the chip were on the bus.

        A bit that the chip must drive has the chip's level. Any other bit is 0 if the chip pulls SDA low in this bit.
        """
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
        value = None if byte.value is None else decode.number_of(bits[:8])
        return decode.Byte(byte.at, value, None if byte.acked is None else not bits[8].value, tuple(bits))

    def _tick(self, position: Position) -> int:
        return self.origin + int(position * self._per_position)

    def _holds(self, scl: Channel) -> list[_Held]:
        """Compare each low phase of the captured SCL before a bit of an access to the firmware with the chip's hold.

        Bits whose low phase was not captured from its beginning are left out. scl: SCL if only the chip drives it.
        """
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
        """Return the low phase of SCL before a bit.

        name: the name of the bit in messages.
        edges: the ticks at which the chip pulls SCL low, and those at which it releases SCL.
        """
        assert bit.low is not None
        falls, rises = edges
        rise, fall = self._tick(bit.at), self._tick(bit.at - bit.low)
        over = fall
        pull = bisect_left(falls, fall)  # index of the chip's first pull in this low phase, if there is one
        if pull < len(falls) and falls[pull] < rise:
            let_go = bisect_left(rises, falls[pull])
            over = rises[let_go] if let_go < len(rises) else self.kernel.now
        per_second = self.timebase.per_second
        return _Held(
            Fraction(bit.at) / self._part.rate,
            Fraction(bit.low) / self._part.rate,
            Fraction(over - fall, per_second),
            Fraction(max(0, over - rise), per_second),
            name,
        )

    # The report ---------------------------------------------------------------------

    def _report(self, stuck: list[str]) -> Report:
        part, own = self._part, self._answering
        self._replayed = driven = self.log.capture(self.timebase, self.kernel.now)
        self._transfers = self._would_be(driven.channel("SDA"))
        events = events_of(self._transfers)
        self._compared = i2c_words(part.expected, part.rate), i2c_words(events, part.rate)
        outcome = compare(*self._compared)
        held = self._holds(driven.channel("SCL"))
        late = [one for one in held if one.late > self._allowed]
        first_late = tuple(self._late(one, part) for one in late[:1])
        ranked = tuple(sorted(outcome.ranked + first_late, key=lambda divergence: divergence.index))
        us = 1_000_000
        return self._bus_summary(
            replace(outcome, ranked=ranked),
            events,
            own.own,
            self._allowed,
            part.notes + self._pauses(held, late),
            verdict=verdict_of(bool(ranked), bool(own.asked)),
            unjudged=own.unjudged,
            transfers=len(part.transfers),
            stretch_worst_us=float(max((one.needed for one in held), default=Fraction(0)) * us),
            stretch_total_us=float(sum((one.needed for one in held), Fraction(0)) * us),
            late_worst_us=float(max((one.late for one in held), default=Fraction(0)) * us),
        )

    def _replayed_transfers(self) -> tuple[list[decode.Transfer], tuple[Fraction, int]]:
        return self._transfers, (self._part.rate, 0)

    def _late(self, held: _Held, part: Played) -> Divergence:
        """Return the divergence of kind TIMING for a late answer of the chip."""
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
        """Return up to two notes, on differences between the low phases of SCL in the capture and those of the chip.

        The first note is on long captured low phases that the chip would have ended earlier. The second note is on low
        phases that the chip would have held beyond the captured rise of SCL by more than the tolerance.
        """
        notes = []
        long = [one for one in held if one.captured > self._part.long_low / self._part.rate]
        spare = [one for one in long if one.needed < one.captured]
        if spare:
            most = max(spare, key=lambda one: one.captured - one.needed)
            notes.append(
                f"long low phases of SCL that the chip would have ended earlier: {len(spare)} of {len(long)}; "
                f"that at {float(most.at):.6f} s lasts {_us(most.captured)}, and the chip needs {_us(most.needed)}"
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
    """Return the edges of SCL and those of SDA up to and including position `end`, as (position, level).

    An edge of SDA in the same sample as an edge of SCL is moved by half a sample into the low phase of SCL.
    """
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
