"""Skipping of the first seven bits of an I2C byte: the state after them is set in one step, without an event per edge.

    SCL  _|~|_|~|_|~|_|~|_|~|_|~|_|~|_|~|_|~|_       each edge is an event
    SCL  ____________________________|~|_|~|_        the same byte, the same ticks, the same states before and after
          ^ `skips` is called         ^ events resume here

During the first seven bits of a byte only the levels of the lines change: flags, FIFOs, interrupts and the ACK change
at the eighth rise of SCL or later. So these bits are not observable, with two kinds of exceptions:
- Edges are recorded, or a party holds SCL low at the first bit or may stretch the clock in the byte. Then no bit of the
  byte is skipped.
- Firmware acts in mid-byte, or a party pulls or releases a line. Then the skipped events are first run up to now, in
  their order (`materialize`).
The byte on SDA (`shown`) has a 0 in each bit in which any party pulls SDA.

    SCL  _|~|_|~|_ ... _|~|_      numbers of the edges in `BitTimes`:
          0   1         7         rises; number 7 belongs to the eighth bit
            1   2     7           falls
"""

# core: compiled

from __future__ import annotations

from collections.abc import Mapping
from typing import final

from ...core.agent import Agent, Event, Shortcut
from ...core.kernel import Kernel
from ...core.time import NO_TIME, Clock
from ...core.wire import Wire
from .line_events import SCL, SDA

SKIPPED_BITS = 7  # number of bits of a byte that are skipped in one step
ONES = 0xFF


class BitTimes:
    """The ticks of the edges of SCL during a byte, computed from the first rise and from the period of SCL.

    since: the tick of the first rise. low, high: the low and the high time of SCL, in ticks.
    """

    __slots__ = ("high", "low", "since")

    def __init__(self) -> None:
        self.since = NO_TIME
        self.low = self.high = 0

    def rise(self, number: int) -> int:
        """Return the tick of the rise with this number, 0 to 7."""
        return self.since + number * (self.low + self.high)

    def fall(self, number: int) -> int:
        """Return the tick of the fall with this number, 1 to 7."""
        return self.rise(number - 1) + self.high


@final
class CycleTimes(BitTimes):
    """The ticks of the edges of SCL, computed from `since`, `low` and `high` in cycles of a clock."""

    __slots__ = ("_clock",)

    def __init__(self, clock: Clock) -> None:
        BitTimes.__init__(self)
        self._clock = clock

    def rise(self, number: int) -> int:
        return self._clock.tick(self.since + number * (self.low + self.high))

    def fall(self, number: int) -> int:
        return self._clock.tick(self.since + (number - 1) * (self.low + self.high) + self.high)


class BitParty(Agent):
    """Base of parties on SCL and SDA whose state after the first seven bits of a byte can be set in one step."""

    __slots__ = ()

    def pulls(self, line: int) -> int:
        """Return the mask of this party on a line, SCL or SDA, as in `Wire.pulling`; 0 if it never pulls the line."""
        return 0

    def ready(self, low: int, high: int, hold: int, each: bool) -> bool:
        """Return True if the party waits for the first bit of a byte and will change only SDA before the eighth bit.

        low, high, hold: durations of the controller, in ticks, as in `BusTiming`.
        each: True if the caller checks afterwards with `separates`, for each change of SDA, that no party sees the
            change in the same sample as the fall of SCL; `hold` is then 0. False if this method must check this itself,
            on the basis of `hold`.
        """
        return True

    def sda_follows_at(self, fall: int) -> int:
        """Return the tick at which the party changes SDA after a fall of SCL at tick `fall`."""
        return fall

    def separates(self, fall: int, moved: int) -> bool:
        """Return True if the party sees a fall of SCL and a later change of another party's SDA in different samples.

        A chip that samples the lines at its own clock may see both in one sample. The result is then False, and the
        bits of the byte are not skipped.
        fall, moved: the ticks of the fall of SCL and of the change of SDA.
        """
        return True

    def byte(self) -> int:
        """Return the byte that the party shifts out; 0xFF if the party leaves SDA released."""
        return ONES

    def keeps_bus(self, shown: int) -> bool:
        """Return False if the party is a master and loses arbitration in this byte. shown: the byte on SDA."""
        return True

    def set_bit_position(self, shown: int, bit: int, fell: int) -> None:
        """Enter the state after the first `bit` bits of a byte, where `bit` is 0 or 7.

        shown: the byte on SDA. fell: the tick of the last fall of SCL.
        """

    def on_bits_skipped(self, shown: int, times: BitTimes) -> None:
        """Called when the skipped bits are over and SCL is about to rise for the eighth bit.

        Parties that only listen change their state here. All other parties change their state in `set_bit_position`.
        shown: the byte on SDA. times: the ticks of the edges of SCL.
        """


class BitSkip(Shortcut):
    """The shortcut that skips the first seven bits of bytes on one bus.

    passed: number of bytes so far in which bits were skipped.
    """

    __slots__ = (
        "_controller",
        "_eighth",
        "_ends",
        "_fell",
        "_kernel",
        "_known",
        "_parties",
        "_scl",
        "_sda",
        "_shown",
        "_since",
        "_stand_in",
        "_steady",
        "_tag",
        "_times",
        "_versions",
        "passed",
    )

    def __init__(
        self, kernel: Kernel, scl: Wire, sda: Wire, controller: BitParty | None, stand_in: Mapping[Agent, BitParty]
    ) -> None:
        """Initialize without parties, which are collected at the first byte.

        controller: the agent that clocks the bus, or None if only units clock it.
        stand_in: for each agent on the lines that is not a BitParty, such as a unit, the BitParty that represents it.
        """
        self.passed = 0
        self._kernel = kernel
        self._scl = scl
        self._sda = sda
        self._controller = controller  # the party that clocks the present byte
        self._stand_in = stand_in
        self._parties: list[BitParty] = []
        self._known = False  # True if all listeners and all pins on the lines belong to `_parties`
        self._versions = -1  # the sum of `Wire.version` of both wires for which `_parties` is valid
        self._since = NO_TIME  # the tick at which the skipped bits began
        self._fell = NO_TIME
        self._shown = ONES
        self._steady = BitTimes()  # the edges of SCL in the last byte for which `skips` has returned True
        self._times = self._steady  # the edges of SCL in the last byte in which bits were skipped
        self._ends = 0  # the tick at which the skipped bits end
        self._eighth: Event | None = None
        self._tag = 0

    def skips(self, low: int, high: int, hold: int, tag: int) -> bool:
        """Skip seven bits and return True. Return False if they are observable, or if a skip of them was cut short.

        A skip is cut short by `materialize`, which then runs the same bits as separate events.
        The controller calls this when it is about to release SCL for the first bit. After a skip, the controller's
        `act(tag)` is called at the tick of the eighth rise of SCL.
        low, high, hold: durations of the controller, in ticks, as in `BusTiming`.
        """
        now, controller = self._kernel.now, self._controller
        assert controller is not None
        shown = -1 if self._since == now else self._byte_on_lines(controller, low, high, hold, False)
        if shown < 0:
            return False
        times = self._steady
        times.since, times.low, times.high = now, low, high
        self._begin(times, shown, now - low, tag)
        self._ends = times.rise(SKIPPED_BITS)
        self._eighth = self._kernel.schedule(self._ends, controller, tag)
        return True

    def skips_for(self, party: BitParty, times: BitTimes, fell: int, ends: int) -> bool:  # core: C only
        """Skip seven bits and return True. Return False if they are observable, or if a skip of them was cut short.

        A skip is cut short by `materialize`, which then runs the same bits as separate events.
        party: the party that clocks the bus, at times that are cycles of the party's own clock.
        ends: the tick at which the skip ends. The party itself schedules its next action for this tick.
        fell: the tick of the last fall of SCL.
        """
        if self._since == self._kernel.now:
            return False
        low, high = times.rise(1) - times.fall(1) - 1, times.fall(1) - times.rise(0) - 1
        shown = self._byte_on_lines(party, low, high, 0, True)
        if shown < 0 or not self._all_separate(times):
            return False
        self._controller, self._eighth = party, None
        self._begin(times, shown, fell, 0)
        self._ends = ends
        return True

    def sda_fell(self) -> int:
        """Return the tick of the last fall of SDA in the skipped bits, or NO_TIME if SDA does not fall in them."""
        for number in range(SKIPPED_BITS, 0, -1):
            if self._shown >> (SKIPPED_BITS - number) & 3 == 2:
                fall = self._times.fall(number)
                return min(p.sda_follows_at(fall) for p in self._parties if not p.byte() >> (SKIPPED_BITS - number) & 1)
        return NO_TIME

    def over(self) -> None:
        """End the skip, if one is active. Called when SCL is about to rise for the eighth bit of a byte."""
        if self._kernel.shortcut is self:
            self._set_active(None)
            self.passed += 1
            party: BitParty
            for party in self._parties:
                party.on_bits_skipped(self._shown, self._times)
        self._since = NO_TIME

    def materialize(self) -> None:
        kernel, controller = self._kernel, self._controller
        if self._ends <= kernel.now:
            self.over()  # the skipped bits are over by now, so there is no intermediate state to restore
            return
        assert controller is not None
        self._set_active(None)
        if self._eighth is not None:
            kernel.cancel(self._eighth)
        self._set_bit_position(0, self._fell)
        recorder = self._scl.recorder
        outer, recorder.cause = recorder.cause, 0  # the present record did not cause these events
        kernel.replay(self._since, controller, self._tag)
        recorder.cause = outer

    def _begin(self, times: BitTimes, shown: int, fell: int, tag: int) -> None:
        self._times, self._since, self._fell, self._shown, self._tag = times, self._kernel.now, fell, shown, tag
        self._set_bit_position(SKIPPED_BITS, times.fall(SKIPPED_BITS))
        self._set_active(self)

    def _set_active(self, shortcut: Shortcut | None) -> None:
        """Register the active shortcut, or None, in the kernel and in both wires.

        They materialize the shortcut before a party pulls or releases a line.
        """
        self._kernel.shortcut = self._scl.shortcut = self._sda.shortcut = shortcut

    def _byte_on_lines(self, controller: BitParty, low: int, high: int, hold: int, each: bool) -> int:
        """Return the byte that SDA will show, or -1 if bits of this byte cannot be skipped.

        controller: the party that clocks the byte. low, high, hold, each: as for `BitParty.ready`.
        """
        scl, sda = self._scl, self._sda
        if self._kernel.shortcut is not None or not scl.quiet() or not sda.quiet():
            return -1
        if scl.version + sda.version != self._versions:
            self._collect_parties()
        if not self._known or scl.pulling != controller.pulls(SCL):
            return -1
        shown: int = ONES
        party: BitParty
        for party in self._parties:
            if not party.ready(low, high, hold, each):
                return -1
            shown &= party.byte()
        return shown if controller.keeps_bus(shown) else -1

    def _all_separate(self, times: BitTimes) -> bool:
        """Return True if no party would sample a fall of SCL together with a change of SDA by another party."""
        sender: BitParty
        for sender in self._parties:
            byte: int = sender.byte()
            number: int
            for number in range(1, SKIPPED_BITS + 1):
                if 0 < byte >> (SKIPPED_BITS - number) & 3 < 3:
                    fall = times.fall(number)
                    moved: int = sender.sda_follows_at(fall)
                    party: BitParty
                    for party in self._parties:
                        if party is not sender and not party.separates(fall, moved):
                            return False
        return True

    def _set_bit_position(self, bit: int, fell: int) -> None:
        pulling: int = 0
        party: BitParty
        for party in self._parties:
            if not party.byte() >> (SKIPPED_BITS - bit) & 1:
                pulling |= party.pulls(SDA)
            party.set_bit_position(self._shown, bit, fell)
        self._sda.jump(pulling)

    def _collect_parties(self) -> None:
        """Store the BitParty of each listener on the lines in `_parties`, and set `_known`.

        `_known` becomes True if all listeners and all pins on the lines belong to these parties, otherwise False.
        """
        scl, sda = self._scl, self._sda
        self._versions = scl.version + sda.version
        agents = {listener.agent for listener in (*scl.listeners(), *sda.listeners())}
        found = [agent if isinstance(agent, BitParty) else self._stand_in.get(agent) for agent in agents]
        self._parties = [party for party in found if party is not None]
        self._known = len(self._parties) == len(found) and all(
            sum(party.pulls(line) for party in self._parties) == (1 << wire.attached) - 1
            for wire, line in ((scl, SCL), (sda, SDA))
        )
