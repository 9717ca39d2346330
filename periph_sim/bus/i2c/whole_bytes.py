"""Seven bits of a byte at once: SCL about to rise for the first goes in; about to rise for the eighth comes out.

    SCL  _|~|_|~|_|~|_|~|_|~|_|~|_|~|_|~|_|~|_       every edge an event
    SCL  ____________________________|~|_|~|_        the same byte, the same ticks, between the same two states
          ^ asked here               ^ goes on here

Nothing but the wires shows of these seven bits: flags, FIFOs, interrupts and ACKs move at the eighth rise or later. So
nobody can tell, unless somebody records edges, holds a line, or meddles in the middle. Recorded edges are made for the
records alone (`edge_play`); where a line may be held, the byte passes edge by edge; where somebody meddles, it is
played again up to now (`catch_up`).
"""

# core: compiled

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from ...core.kernel import Agent, Event, Kernel, Shortcut
from ...core.shortcuts import shortcuts_of
from ...core.time import NO_TIME
from ...core.wire import PullWatch, Sampler, Tape, Wire
from .bit_times import BitTimes
from .edge_play import BITS, Deaf, EdgePlay, SdaFollows
from .line_events import SCL, SDA

if TYPE_CHECKING:
    from ...core.shortcuts import Shortcuts

ONES = 0xFF


class ByteParty(Agent):
    """One who listens to the lines, and knows what seven bits of a byte do to him."""

    __slots__ = ()

    def pulls(self, line: int) -> int:
        """Its hold on a line, SCL or SDA, as a mask of the wire's parties; 0 if it has none."""
        return 0

    def ready(self, low: int, high: int, hold: int, each: bool) -> bool:
        """Whether it waits for the first bit of a byte, and nothing of its own comes in between.

        low, high, hold: ticks, as the controller clocks. each: it will be asked `apart` of each move of SDA.
        """
        return True

    def follow_at(self, fall: int) -> int:
        """The tick at which it moves SDA behind a fall of SCL at tick `fall`, if it does."""
        return fall

    def apart(self, fall: int, moved: int) -> bool:
        """Whether SCL's fall and SDA's move, by somebody else, are two events to it."""
        return True

    def steps(self) -> bool:
        """Whether it knows `edge`, for whole bytes in steps."""
        return True

    def byte(self) -> int:
        """What it shifts out, 0xFF where it lets SDA go."""
        return ONES

    def goes_on(self, shown: int) -> bool:
        """Whether it does where this byte shows, which others have pulled at, too."""
        return True

    def stand(self, shown: int, bit: int, fell: int) -> None:
        """Be where `bit` bits, 0 or 7, of the byte `shown` have passed. fell: the tick at which SCL fell last.

        For who pulls a line: there may be a way back.
        """

    def meanwhile(self) -> SdaFollows | None:
        """Who moves SDA for it where each edge of these bits is recorded, told of them in its place; if anybody."""
        return None

    def edge(self, tick: int, levels: int) -> None:
        """From `tick` on the lines are at these levels, and who pulls them is on the wires."""
        raise NotImplementedError

    def pulls_sda(self) -> bool:
        """Whether it does now. Not asked of the controller."""
        return False

    def holds(self) -> bool:
        """Whether it holds SCL low. Not asked of the controller."""
        return False

    def heard(self, shown: int, times: BitTimes) -> None:
        """Seven bits have passed: SCL is about to rise for the eighth.

        For who only listens: it is told as they are over.
        """


class WholeBytes(Shortcut):
    """Of one bus. controller: the agent that clocks it, if it is one. stand_in: for agents that are no party, who knows
    it of them.

    passed: how many bytes have passed so.
    """

    __slots__ = (
        "_controller",
        "_deaf",
        "_eighth",
        "_ends",
        "_fell",
        "_kernel",
        "_known",
        "_movers",
        "_parties",
        "_play",
        "_pull_watches",
        "_samplers",
        "_scl",
        "_sda",
        "_shortcuts",
        "_shown",
        "_since",
        "_stand_in",
        "_steady",
        "_tag",
        "_tape",
        "_times",
        "_told",
        "_versions",
        "passed",
    )

    _shortcuts: Shortcuts

    def __init__(
        self, kernel: Kernel, scl: Wire, sda: Wire, controller: ByteParty | None, stand_in: Mapping[Agent, ByteParty]
    ) -> None:
        self.passed = 0
        self._kernel = kernel
        self._shortcuts = shortcuts_of(kernel)
        self._scl = scl
        self._sda = sda
        self._controller = controller  # who clocks this byte, if somebody does
        self._stand_in = dict(stand_in)
        self._parties: list[ByteParty] = []
        self._known = False  # every party of the lines is one of these
        self._versions = -1  # of the wires, when they were looked through
        self._since = NO_TIME  # when the seven bits that pass just now began
        self._fell = NO_TIME
        self._shown = ONES
        self._steady = BitTimes()
        self._times = self._steady  # of this byte
        self._ends = 0  # from here on everybody is where edges would have him
        self._eighth: Event | None = None
        self._tag = 0
        self._play: EdgePlay | None = None  # where edges are recorded
        self._tape = Tape()
        self._deaf = Deaf()
        self._movers: list[SdaFollows] = []  # of this byte
        self._samplers: list[Sampler] = []  # through which the parties are told,
        self._pull_watches: list[PullWatch] = []  # and through these,
        self._told: list[Agent] = []  # each of them
        if controller is not None and (scl.recorded or sda.recorded):
            self._play = EdgePlay(kernel, scl, sda, controller.pulls(SCL), controller.pulls(SDA))

    def passes(self, low: int, high: int, hold: int, tag: int) -> bool:
        """Whether seven bits pass at once: everybody stands before the eighth then, and the controller acts on `tag`.

        It asks as it is about to let SCL go for the first bit. low, high, hold: ticks, as it clocks.
        """
        now, controller = self._kernel.now, self._controller
        assert controller is not None
        shown = -1 if self._since == now else self._showing(controller, low, high, hold, False)
        if shown < 0:
            return False
        times = self._steady
        times.since, times.low, times.high = now, low, high
        self._begin(times, shown, now - low, tag)
        if self._play is not None:
            self._play.begin(controller.byte(), low, high, hold)
        self._ends = times.rise(BITS)
        self._eighth = self._kernel.ask(self._ends, controller, tag)
        return True

    def pass_of(  # core: C only
        self, party: ByteParty, times: BitTimes, fell: int, ends: int, play: EdgePlay | None
    ) -> bool:
        """The same of one who clocks in cycles and not in ticks; it sees itself to what comes at `ends`.

        fell: the tick at which SCL fell last. Where edges are recorded, and so there is a `play`, it begins that now.
        """
        if self._since == self._kernel.now:
            return False
        low, high = times.rise(1) - times.fall(1) - 1, times.fall(1) - times.rise(0) - 1
        shown = self._showing(party, low, high, 0, True)
        if shown < 0 or not self._apart(times):
            return False
        self._controller, self._eighth, self._play = party, None, play
        self._begin(times, shown, fell, 0)
        self._ends = ends
        return True

    def _begin(self, times: BitTimes, shown: int, fell: int, tag: int) -> None:
        self._times, self._since, self._fell, self._shown, self._tag = times, self._kernel.now, fell, shown, tag
        if self._play is not None:
            self._deafen()
        self._stand(BITS, times.fall(BITS))
        self._shortcuts.begin(self)

    def _deafen(self) -> None:
        """Those who are told of edges are told nothing."""
        self._tape.numbers.clear()
        self._scl.tape = self._sda.tape = self._tape
        movers = {party: party.meanwhile() for party in self._parties}
        self._movers = [mover for mover in movers.values() if mover is not None]
        self._told = [sampler.agent for sampler in self._samplers] + [watch.agent for watch in self._pull_watches]
        for sampler in self._samplers:
            sampler.agent = movers.get(self._party(sampler.agent)) or self._deaf
        for watch in self._pull_watches:
            watch.agent = self._deaf

    def _end_play(self) -> None:
        """They are told again."""
        sampler: Sampler
        for place, sampler in enumerate(self._samplers):
            sampler.agent = self._told[place]
        watch: PullWatch
        for place, watch in enumerate(self._pull_watches, len(self._samplers)):
            watch.agent = self._told[place]
        self._scl.tape = self._sda.tape = None

    def _party(self, agent: Agent) -> ByteParty:
        return agent if isinstance(agent, ByteParty) else self._stand_in[agent]

    def _showing(self, controller: ByteParty, low: int, high: int, hold: int, each: bool) -> int:
        """What the lines will show, as a byte; -1 where it must go edge by edge."""
        scl, sda = self._scl, self._sda
        if not scl.quiet() or not sda.quiet():
            return -1
        if scl.version + sda.version != self._versions:
            self._look()
        if not self._known or scl.pulling != controller.pulls(SCL):
            return -1
        shown: int = ONES
        party: ByteParty
        for party in self._parties:
            if not party.ready(low, high, hold, each):
                return -1
            shown &= party.byte()
        return shown if controller.goes_on(shown) else -1

    def _apart(self, times: BitTimes) -> bool:
        """Whether each party tells the moves of SDA, by others, from the falls of SCL before them."""
        sender: ByteParty
        for sender in self._parties:
            byte: int = sender.byte()
            number: int
            for number in range(1, BITS + 1):
                if 0 < byte >> (BITS - number) & 3 < 3:
                    fall = times.fall(number)
                    moved: int = sender.follow_at(fall)
                    party: ByteParty
                    for party in self._parties:
                        if party is not sender and not party.apart(fall, moved):
                            return False
        return True

    def sda_fell(self) -> int:
        """The tick at which SDA fell last in these bits; NO_TIME where it did not."""
        for number in range(BITS, 0, -1):
            if self._shown >> (BITS - number) & 3 == 2:
                fall = self._times.fall(number)
                return min(p.follow_at(fall) for p in self._parties if not p.byte() >> (BITS - number) & 1)
        return NO_TIME

    def strangers(self) -> set[str]:
        """Who may pull a line and is no party now, as the wires name them."""
        self._look()
        named: set[str] = set()
        for wire, line in ((self._scl, SCL), (self._sda, SDA)):
            known = 0
            for party in self._parties:
                known |= party.pulls(line)
            named.update(who for place, who in enumerate(wire.parties()) if not known >> place & 1)
        return named

    def over(self) -> None:
        """SCL is about to rise for the eighth bit of some byte."""
        if self._shortcuts.passes(self):
            self._shortcuts.end(self)
            self.passed += 1
            if self._play is not None:
                self._end_play()
            party: ByteParty
            for party in self._parties:
                party.heard(self._shown, self._times)
        self._since = NO_TIME

    def catch_up(self) -> None:
        kernel, controller = self._kernel, self._controller
        if self._ends <= kernel.now:
            self.over()  # the controller acts in this very tick, or has, from where everybody stands
            return
        assert controller is not None
        self._shortcuts.end(self)
        if self._eighth is not None:
            kernel.cancel(self._eighth)
        if self._play is None:
            self._stand(0, self._fell)
            self._replay(controller)
            return
        self._play.stop()
        mover: SdaFollows
        for mover in self._movers:
            mover.stop()
        self._end_play()
        self._stand(0, self._fell)
        self._scl.jump(controller.pulls(SCL))
        again = self._tape.again
        again[:] = self._tape.numbers
        self._scl.tape = self._sda.tape = self._tape
        self._replay(controller)
        again.clear()
        self._scl.tape = self._sda.tape = None

    def _replay(self, controller: ByteParty) -> None:
        """Nothing of it is an effect of what is being worked under now."""
        recorder = self._scl.recorder
        outer, recorder.cause = recorder.cause, 0
        self._kernel.replay(self._since, controller, self._tag)
        recorder.cause = outer

    def _stand(self, bit: int, fell: int) -> None:
        pulling: int = 0
        party: ByteParty
        for party in self._parties:
            if not party.byte() >> (BITS - bit) & 1:
                pulling |= party.pulls(SDA)
            party.stand(self._shown, bit, fell)
        if self._play is None or not bit:
            self._sda.jump(pulling)

    def _takes(self, party: ByteParty) -> bool:
        """Whether it is a party at this level."""
        return True

    def _look(self) -> None:
        """Who is on the lines now: all that listen, and all that can pull, must be parties."""
        scl, sda = self._scl, self._sda
        self._versions = scl.version + sda.version
        ears = [*scl.ears(), *sda.ears()]
        self._samplers = list({id(ear): ear for ear in ears if isinstance(ear, Sampler)}.values())
        self._pull_watches = [ear for ear in ears if isinstance(ear, PullWatch)]
        agents = {ear.agent for ear in ears}
        found = [agent if isinstance(agent, ByteParty) else self._stand_in.get(agent) for agent in agents]
        self._parties = [party for party in found if party is not None and self._takes(party)]
        self._known = len(self._parties) == len(found) and all(
            sum(party.pulls(line) for party in self._parties) == (1 << wire.attached) - 1
            for wire, line in ((scl, SCL), (sda, SDA))
        )
