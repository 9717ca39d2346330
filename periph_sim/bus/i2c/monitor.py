"""Monitor of an I2C bus: reconstructs the transfers of a master from the levels and from the parties that pull.

    SCL, SDA, parties --> START, clocks, STOP of the master --> Transfer: phases, bytes, ACKs, times, stretching

The master is the party that pulls SDA for the START and then SCL. A clock begins when the master pulls SCL. A START or
STOP is the master's own pull or release of SDA while SCL is high. So a spike by another party, or a target that has
lost count of the bits, changes the bits that the master reads, but not the STARTs, clocks and STOPs of the transfer. If
SCL stays low after the master's release, the clock is stretched. The master can be an agent, firmware or a capture.

Source: UM10204 sections 3.1.4 to 3.1.10, Table 10 (tSP).
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import final

from ...core.sampler import watch
from ...core.state import State
from ...core.time import NO_TIME
from ...core.wire import Wire
from ...traces.decode.i2c_stream import BITS, SCL, SDA, I2cStream
from .bit_skip import SKIPPED_BITS, BitParty, BitTimes
from .transfer import Phase, Transfer


@final
class I2cMonitor(BitParty):
    """Reconstructs the transfers on one bus.

    on_transfer: called with each transfer at its STOP, or, if the master has given it up, at the next START. It is not
        called if no address byte was complete.
    names: for each known address, the name of the transfers that begin with this address.
    filter: the minimum length, in ticks, of a level of SDA; shorter levels are ignored.
    """

    STATE = State(
        "_starting _scl_mask _sda_mask _pulls_scl _pulls_sda _first _transfer _phase _acks "
        "_got _stream _sda_seen _levels _clock_length _stretch",
        ticks="_start_at _began_at _let_go_at _rose_at _ended_at _pulled_at _sda_at",
        expires="_start_at _began_at _let_go_at _rose_at _ended_at _pulled_at _sda_at",
    )

    def normal_state(self, cycle: int, tick: int) -> dict[str, object]:
        """Return the values that replace those of attributes when two states are compared (`proof.normal_state`).

        The last sample of the decoder `_stream` is left out. It has no effect, because the monitor passes only bits and
        conditions to the decoder, never samples.
        """
        return {"_stream.levels": None}

    def __init__(
        self,
        scl: Wire,
        sda: Wire,
        on_transfer: Callable[[Transfer], None],
        names: Mapping[int, str],
        filter: int = 0,
    ) -> None:
        self._scl, self._sda = scl, sda
        self._on_transfer = on_transfer
        self._names = names
        self._start_at = NO_TIME  # the tick of a possible START, until a party that pulled SDA for it pulls SCL
        self._starting = 0  # the mask of the parties that pulled SDA for the possible START
        self._masters_of: dict[int, tuple[int, int]] = {}  # cache: the result of `_masters` for each `_starting`
        self._versions = scl.version, sda.version  # `Wire.version` of both wires for which `_masters_of` is valid
        self._scl_mask = self._sda_mask = 0  # the master's masks on the wires; 0 between transfers
        self._pulls_scl = self._pulls_sda = False  # True while the master pulls this wire low
        self._began_at = NO_TIME
        self._first = True  # True if the master's next pull of SCL is part of the START
        self._let_go_at = NO_TIME  # the tick of the master's release of SCL, until SCL rises
        self._rose_at = NO_TIME
        # The tick of the last STOP by another party; NO_TIME if there was none since the master's last clock began.
        self._ended_at = NO_TIME
        # The tick of the master's last pull of SCL, and the number of ticks between the master's last two pulls of SCL.
        self._pulled_at = self._clock_length = 0
        self._transfer = Transfer("", [])
        self._phase = Phase(0, False)
        self._stretch = 0  # the longest clock stretch in the present phase, in ticks
        self._acks: list[bool] = []  # acknowledges of the data bytes of the phase
        self._got = bytearray()
        self._stream = I2cStream()  # decoder of the master's bits and conditions
        self._filter = filter
        self._sda_at = -filter
        # When SDA changes, the level that ends is stored here if it lasted for the filter time. After a spike, this
        # therefore equals the present level.
        self._sda_seen = 1
        sampler = watch([scl, sda], self)
        self._levels = sampler.levels
        for wire in (scl, sda):
            wire.notify_on_pulls(sampler)

    @property
    def held_since(self) -> int:
        """The tick at which the master released SCL, while SCL is still low; else NO_TIME."""
        return self._let_go_at

    @property
    def begun_at(self) -> int:
        """The tick of the START of the transfer in progress; NO_TIME if there is none."""
        return self._began_at if self._scl_mask else NO_TIME

    @property
    def open_transfer(self) -> Transfer | None:
        """The transfer in progress, with the phases whose address byte is complete; None if there is no such phase."""
        return self._transfer if self._scl_mask and self._transfer.phases else None

    def sampled(self, now: int, levels: int) -> None:
        before, self._levels = self._levels, levels
        if not self._scl_mask:
            if before & levels & SCL:
                if (before ^ levels) & SDA:
                    self._start_at = NO_TIME if levels & SDA else now
                self._starting = self._sda.pulling
            elif self._start_at != NO_TIME:
                self._first_clock(now)
        else:
            pulls = bool(self._scl.pulling & self._scl_mask)
            if pulls or self._pulls_scl or self._let_go_at != NO_TIME:
                self._clock(now, before, levels, pulls)
            else:
                self._condition(now, before, levels)
        if (before ^ levels) & SDA:
            if now - self._sda_at >= self._filter:
                self._sda_seen = before >> 1
            self._sda_at = now

    def on_bits_skipped(self, shown: int, times: BitTimes) -> None:
        self._levels = SDA if shown & 1 else 0
        self._sda_seen = shown & 1
        if not self._scl_mask:
            return
        if self._is_answered():
            self._phase.answer_at = times.rise(0)
        self._stream.skip(shown)
        self._pulled_at = times.fall(SKIPPED_BITS)
        self._clock_length = self._pulled_at - times.fall(SKIPPED_BITS - 1)
        self._rose_at = times.rise(SKIPPED_BITS - 1)
        self._pulls_sda = bool(self._sda.pulling & self._sda_mask)

    # START and STOP ----------------------------------------------------------------

    def _first_clock(self, now: int) -> None:
        """Begin a transfer if a party that pulled SDA for a START also pulls SCL. This party is the master."""
        mask, sda_mask = self._masters()
        if self._scl.pulling & mask:
            self._scl_mask, self._sda_mask = mask, sda_mask
            self._pulls_scl, self._pulls_sda = True, bool(self._sda.pulling & self._sda_mask)
            self._transfer, self._began_at = Transfer("", []), self._start_at
            self._phase_begins(self._start_at)
            self._first, self._pulled_at = False, now
            self._start_at = self._let_go_at = self._ended_at = NO_TIME

    def _masters(self) -> tuple[int, int]:
        """Return the masks, on SCL and SDA, of the parties that pulled SDA for the START."""
        versions = self._scl.version, self._sda.version
        if versions != self._versions:
            self._versions = versions
            self._masters_of.clear()
        holds = self._masters_of.get(self._starting)
        if holds is None:
            pulling = [who for place, who in enumerate(self._sda.parties()) if self._starting >> place & 1]
            masters = {who.partition(".")[0] for who in pulling}
            holds = self._masters_of[self._starting] = _mask(self._scl, masters), _mask(self._sda, masters)
        return holds

    def _condition(self, now: int, before: int, levels: int) -> None:
        """Detect START and STOP while SCL is high and released by the master."""
        pulled, self._pulls_sda = self._pulls_sda, bool(self._sda.pulling & self._sda_mask)
        # The master has given up its transfer if another party has made a STOP, and the master's last clock began more
        # than two periods ago.
        given_up = self._ended_at != NO_TIME and now - self._pulled_at > 2 * self._clock_length
        if before & ~levels & SDA and given_up:
            self._over(self._ended_at)
            self._start_at, self._starting = now, self._sda.pulling
        elif self._pulls_sda and not pulled:
            self._phase_begins(now)
        elif pulled and not self._pulls_sda:
            self._over(now)
        elif before & levels & SCL and levels & ~before & SDA and now - self._sda_at >= self._filter:
            self._ended_at = now

    def _phase_begins(self, at: int) -> None:
        self._phase = Phase(0, False)
        self._phase.start_at = at
        self._stretch = 0
        self._acks, self._got = self._phase.acks, self._phase.got
        self._stream.condition(True)
        self._first = True

    def _over(self, at: int) -> None:
        self._scl_mask = self._sda_mask = 0
        self._let_go_at = NO_TIME
        if self._transfer.phases:
            self._transfer.stop_at = at
            self._on_transfer(self._transfer)

    # Clocks ------------------------------------------------------------------------

    def _clock(self, now: int, before: int, levels: int, pulls: bool) -> None:
        """Process a change in the low phase of a clock: the master's pull of SCL, the rise of SCL, or one in between.

        before, levels: the levels of both lines before and after the change.
        pulls: True if the master pulls SCL after the change.
        """
        if pulls and not self._pulls_scl:
            self._ended_at = NO_TIME
            self._clock_length, self._pulled_at = now - self._pulled_at, now
            if self._first:
                self._first = False
            else:
                self._bit_over(now, before >> 1 if now - self._sda_at >= self._filter else self._sda_seen)
        elif self._pulls_scl and not pulls:
            self._let_go_at = now
        self._pulls_scl = pulls
        self._pulls_sda = bool(self._sda.pulling & self._sda_mask)
        if levels & SCL and self._let_go_at != NO_TIME:
            stretch = now - self._let_go_at
            if stretch > self._stretch:
                self._stretch = self._phase.stretch = stretch
            self._rose_at, self._let_go_at = now, NO_TIME

    def _bit_over(self, now: int, bit: int) -> None:
        stream = self._stream
        stream.bit(bit)
        if stream.bits == BITS:
            stream.byte_over()
            self._byte_over(now)
        elif stream.bits == 1 and self._is_answered():
            self._phase.answer_at = self._rose_at

    def _is_answered(self) -> bool:
        """Return True if the present or next byte is the first data byte after an address that was acknowledged."""
        return self._stream.index == 0 and self._stream.acked

    def _byte_over(self, now: int) -> None:
        phase, transfer, stream = self._phase, self._transfer, self._stream
        byte, ack = stream.byte, stream.acked
        if stream.index == 0:
            phase.address, phase.read, phase.acked = stream.address, stream.read, ack
            transfer.phases.append(phase)
            if not transfer.name:
                transfer.name = self._names.get(phase.address) or f"{phase.address:#04x}"
            if ack:
                phase.answer_from = now
        else:
            self._acks.append(ack)
            if stream.read:
                self._got.append(byte)
            else:
                phase.data += bytes([byte])


def _mask(wire: Wire, parties: set[str]) -> int:
    """Return the mask of these parties on a wire. A unit's pin, named UNIT.PIN, counts as UNIT."""
    return sum(1 << place for place, who in enumerate(wire.parties()) if who.partition(".")[0] in parties)
