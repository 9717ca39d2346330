"""Origins of reads: the host frame whose values a read returned, and the bytes that would have been right.

    frames of the host ---------.
    MODEL pin (model runs) ------+--> Origins --of(phase)--> Origin: frame, tick of its end, right bytes
    reads of the controller ----'

The firmware emulates sensor chips, which the controller reads. An emulated chip is called a chip here. A chip shows a
frame while its registers contain the values of this frame.

If the chips show the values of frames (`FrameOrigins`), a read's bytes are compared with the last 8 frames and with
every frame since the one that the chip showed last. The measure `age` judges how old the values are.

If firmware computes the chips' values with models (`ModelOrigins`), each model run may have used any of the last 64
frames that ended before the MODEL pin rose. A chain is one possible sequence of the frames that the successive model
runs used. No model run of a chain uses an older frame than the model run before it. After each read, the chains whose
values disagree with the bytes read are removed. The number of chains is limited: if chains had to be left out, a read
that agrees with none of the remaining chains is not judged. The level of the MODEL pin is the only information that the
firmware provides.
"""

# core: compiled

from __future__ import annotations

from array import array
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from itertools import combinations_with_replacement
from struct import Struct
from typing import NamedTuple, final

from ...bus.i2c.transfer import Phase, Transfer
from ...core.time import NO_TIME
from ...devices.chip_model import BYTES, ChipModel, ModelOutput
from ...devices.host_frames import HostFrames

BEFORE_ANY = -1  # used as the frame number of the values that a chip has before the first frame


class Origin(NamedTuple):
    """The host frame whose values a read returned.

    frame: the number of the frame, the youngest if several fit; BEFORE_ANY for values from before the first frame; None
        if the bytes are the values of no frame.
    ended: the tick at which the last stop bit of this frame ended; NO_TIME without a frame.
    wanted: the bytes that would have been right; of several possibilities, the bytes most similar to the bytes read.
    judged: False if it is not known whether the bytes are right, because not all possible frames were compared, or
        because the bytes are zeros of a chip that has never returned the values of a frame.
    """

    frame: int | None
    ended: int
    wanted: bytes
    judged: bool = True

    @property
    def known(self) -> bool:
        """True if the bytes are the values of a frame that the host has sent."""
        return self.frame is not None and self.frame != BEFORE_ANY


class FrameHistory:
    """All frames that a host has sent. `youngest` searches them for the youngest frame with given bytes.

    A frame takes 28 bytes of memory, and 6 more for each chip that was read: an hour of 50 frames a second takes 5 MB.
    data: a function from a chip's address and a frame's values to the bytes that the chip returns for these values.
    """

    def __init__(self, data: Callable[[int, tuple[int, ...]], bytes]) -> None:
        self._data = data
        self._numbers: array[int] = array("q")
        self._ended: array[int] = array("q")
        self._values = bytearray()
        self._format: Struct | None = None  # the format of a frame's values; None before the first frame
        # `_shown` maps the address of a chip to the bytes that the chip returns for all frames, in order of the frames.
        self._shown: dict[int, bytearray] = {}

    def add(self, number: int, values: tuple[int, ...], ended: int) -> None:
        """Append a frame. ended: the tick at which the last stop bit of the frame ended."""
        self._numbers.append(number)
        self._ended.append(ended)
        self._format = self._format or Struct(f"<{len(values)}h")
        self._values += self._format.pack(*values)

    def youngest(self, address: int, got: bytes) -> tuple[int, int, bytes] | None:
        """Return the youngest frame for which this chip returns bytes that begin with `got`; None if there is none.

        The frame is returned as (its number, the tick at which it ended, the bytes that the chip returns for it).
        """
        shown = self._shown_at(address)
        at = shown.rfind(got) if len(got) <= BYTES else -1
        while at > 0 and at % BYTES:
            at = shown.rfind(got, 0, at - 1 + len(got))
        if at < 0 or at % BYTES:
            return None
        frame = at // BYTES
        return self._numbers[frame], self._ended[frame], bytes(shown[at : at + BYTES])

    def recent(self, address: int) -> list[bytes]:
        """Return the bytes that the chip with this address returns for each recent frame, the youngest frame first."""
        shown = self._shown_at(address)
        return [bytes(shown[at : at + BYTES]) for at in range(len(shown) - BYTES, -1, -BYTES)[:RECENT]]

    def _shown_at(self, address: int) -> bytearray:
        """Return the bytes that the chip with this address returns for each frame, one frame after the other."""
        shown = self._shown.setdefault(address, bytearray())
        for frame in range(len(shown) // BYTES, len(self._numbers)):
            assert self._format is not None
            shown += self._data(address, self._format.unpack_from(self._values, frame * self._format.size))
        return shown


# A read is right if it returned the values of one of the last RECENT frames, or of any frame that is not older than the
# frame whose values the previous read of the chip returned.
RECENT = 8
KEPT = 64  # number of recent frames from which a model run may have taken its input
COMPLETE = 256  # maximum number of chains (possible sequences of frames) up to which all chains are followed
PASSED_OVER = 3  # with more chains than COMPLETE, only the PASSED_OVER + 1 newest frames are tried for a model run
MOST = 64  # with more chains than COMPLETE, at most this number of them is followed, with younger frames preferred


@final
class Sent:
    """A frame that the host sent. ended: the tick at which the last stop bit of the frame ended."""

    __slots__ = ("ended", "number", "values")

    def __init__(self, number: int, values: tuple[int, ...], ended: int) -> None:
        self.number = number
        self.values = values
        self.ended = ended


NOTHING_SENT = Sent(BEFORE_ANY, (), NO_TIME)


class Origins:
    """Base of the classes that find, for each read of a chip, the host frame that the returned values came from.

    Call `transfer` with each complete transfer. Then, `of` returns the origin of each phase of this transfer.

    addresses: the addresses of the chips whose reads are examined.
    """

    def __init__(self, addresses: frozenset[int]) -> None:
        self.addresses = addresses
        self._of: dict[int, Origin] = {}

    def of(self, phase: Phase) -> Origin | None:
        """Return the origin of the data that a phase of the last transfer read; None if it read no byte of a chip."""
        return self._of.get(id(phase))

    def frame(self, number: int, values: tuple[int, ...], tick: int) -> None:
        """Store the host frame with this number, whose last stop bit ended at `tick`. values: its 16-bit integers."""
        raise NotImplementedError

    def transfer(self, transfer: Transfer) -> None:
        """Find the origin of each read in a complete transfer."""
        self._of.clear()
        for phase in transfer.phases:
            if phase.read and phase.got and phase.address in self.addresses:
                self._of[id(phase)] = self.origin(phase.address, bytes(phase.got))

    def origin(self, address: int, got: bytes) -> Origin:
        """Return the origin of the bytes `got` that a read of a chip returned."""
        raise NotImplementedError


class FrameOrigins(Origins):
    """Origins for chips that return the values of a frame as they are: `HostFrames.data` gives the bytes of each chip.

    Before the first frame, chips return zeros. Until 8 frames have been sent, zeros are right. After that, zeros that
    are the values of no frame are wrong if the chip has already returned the values of a frame; otherwise they are not
    judged.
    """

    def __init__(self, frames: HostFrames) -> None:
        super().__init__(frames.ADDRESSES)
        self._frames: FrameHistory = FrameHistory(frames.data)
        self._shown: dict[int, int] = {}  # maps a chip's address to the number of the frame that it returned last

    def frame(self, number: int, values: tuple[int, ...], tick: int) -> None:
        self._frames.add(number, values, tick)

    def origin(self, address: int, got: bytes) -> Origin:
        last = self._shown.get(address, BEFORE_ANY)
        found = self._frames.youngest(address, got)
        if found is not None and (found[0] >= last or found[2] in self._frames.recent(address)):
            self._shown[address] = found[0]
            return Origin(*found)
        recent, zeros = self._frames.recent(address), bytes(BYTES)
        if len(recent) < RECENT:
            recent.append(zeros)
            if zeros.startswith(got):
                return Origin(BEFORE_ANY, NO_TIME, zeros)
        if last == BEFORE_ANY and not any(got):
            return Origin(BEFORE_ANY, NO_TIME, zeros, False)
        return Origin(None, NO_TIME, max(recent, key=partial(_agreement, got)))


@final
class Chain:
    """A possible sequence of the frames that the model runs used. Only its last two frames are stored.

    sent: the frame that the last model run used.
    before: the number of the frame that the second-to-last model run used.
    shown: the values that the last model run produced. They depend on both frames.
    """

    __slots__ = ("before", "sent", "shown")

    def __init__(self, sent: Sent, before: int, shown: ModelOutput) -> None:
        self.sent = sent
        self.before = before
        self.shown = shown


@final
class ModelRun:
    """A complete model run. number: its number, from 0. sent: the frames that it may have used, oldest first."""

    __slots__ = ("number", "sent")

    def __init__(self, number: int, sent: list[Sent]) -> None:
        self.number = number
        self.sent = sent


class ModelOrigins(Origins):
    """Origins for chips whose values are computed by the firmware: its sensor models calculate them from host frames.

    Call `model_pin` at every change of the firmware's MODEL pin, which is high while the models run.
    """

    def __init__(self, codes: ChipModel) -> None:
        super().__init__(codes.addresses)
        self._codes: ChipModel = codes
        self._sent: deque[Sent] = deque([NOTHING_SENT], maxlen=KEPT)
        self.reset()

    def reset(self) -> None:
        """Discard all chains and model runs after a reset of the unit.

        The MODEL pin is then a pulled-up input, so it is high although no model runs.
        """
        self._pulled_up = True
        self._chains = [Chain(NOTHING_SENT, BEFORE_ANY, self._codes.at_rest)]
        self._left_out = False  # True if chains were left out after the last read that agreed with a chain
        self._before: list[Chain] = []  # the chains as they were before the last model run was added
        self._runs = 0
        self._over: list[ModelRun] = []  # complete model runs that `_chains` does not include yet
        self._last: ModelRun | None = None
        self._may_take: list[Sent] = []

    def frame(self, number: int, values: tuple[int, ...], tick: int) -> None:
        self._sent.append(Sent(number, values, tick))

    def model_pin(self, now: int, level: int) -> None:
        """Handle a change of the MODEL pin at tick `now`. The pin is high during a model run.

        The model run may use any frame that has ended before the pin rises.
        """
        if level:
            self._may_take = list(self._sent)
        elif self._pulled_up:  # the pin falls because it becomes an output, not because a model run ends
            self._pulled_up = False
        else:
            self._last = ModelRun(self._runs, self._may_take)
            self._over.append(self._last)
            self._runs += 1

    def origin(self, address: int, got: bytes) -> Origin:
        run: ModelRun
        for run in self._over:
            self._before, self._chains = self._chains, self._longer(run)
        self._over.clear()
        fitting = _fitting(self._chains, address, got)
        if not fitting and _fitting(self._before, address, got):
            return _nearest(
                got, [(chain.sent, chain.shown.data(address)) for chain in self._before]
            )  # the read began before the last model run was complete, so it returned values of the run before
        if not fitting:
            fitting = _fitting(self._anew(), address, got)
        if fitting:
            self._chains, self._left_out = fitting, False
        nearest = _nearest(got, [(chain.sent, chain.shown.data(address)) for chain in self._chains])
        return nearest._replace(judged=False) if self._left_out else nearest

    def _longer(self, run: ModelRun) -> list[Chain]:
        """Return all possible extensions of the chains by `run`.

        If there are too many, extend each chain only by its newest possible frames, and return the first MOST results.
        """
        count: int = 0
        chain: Chain
        for chain in self._chains:
            count += len(self._may_be(chain, run))
        many: bool = count > COMPLETE
        if many:
            self._left_out = True
        longer: dict[tuple[int, int, int], Chain] = {}
        for chain in self._chains:
            may_be = self._may_be(chain, run)
            sent: Sent
            for sent in reversed(may_be[-PASSED_OVER - 1 :] if many else may_be):
                key = sent.number, chain.sent.number, chain.before
                if key not in longer:
                    longer[key] = self._chain(run.number, sent, chain)
        return list(longer.values())[:MOST] if many else list(longer.values())

    def _may_be(self, chain: Chain, run: ModelRun) -> list[Sent]:
        """Return the frames that `run` may have used, oldest first, if the earlier model runs used those of `chain`.

        The result has the last frame of the chain and all later frames in `run.sent`.
        """
        least = chain.sent.number
        may_be: list[Sent] = []
        sent: Sent
        for sent in reversed(run.sent):
            if sent.number < least:
                break
            may_be.append(sent)
        oldest: int = may_be[-1].number
        if oldest > least:  # `run.sent` lacks the last frame of the chain, and perhaps frames after this frame
            may_be.append(chain.sent)
            self._left_out = self._left_out or oldest > least + 1
        may_be.reverse()
        return may_be

    def _anew(self) -> Iterator[Chain]:
        """Yield new chains, for a read that agrees with no known chain.

        Each new chain consists of three model runs, the third of which is the last complete one, `_last`. Each of the
        three uses one of the PASSED_OVER + 1 newest frames in `_last.sent`, and no older frame than the run before it.
        """
        if self._last is not None:
            number, recent = self._last.number, self._last.sent[-PASSED_OVER - 1 :]
            at_rest = Chain(NOTHING_SENT, BEFORE_ANY, self._codes.at_rest)
            for first, second, third in combinations_with_replacement(recent, 3):
                yield self._chain(number, third, self._chain(0, second, self._chain(0, first, at_rest)))

    def _chain(self, number: int, sent: Sent, before: Chain) -> Chain:
        return Chain(sent, before.sent.number, self._codes.run(number, sent.values or None, before.shown))


def _fitting(chains: Iterable[Chain], address: int, got: bytes) -> list[Chain]:
    """Return the chains in which the chip with this address would return these bytes."""
    fitting = []
    chain: Chain
    for chain in chains:
        if chain.shown.data(address).startswith(got):
            fitting.append(chain)
    return fitting


def _nearest(got: bytes, candidates: Iterable[tuple[Sent, bytes]]) -> Origin:
    """Return the origin of the youngest candidate whose bytes begin with `got`.

    candidates: pairs of a frame and the bytes that the chip returns for the frame. If none of these bytes begin with
    `got`, return an origin without a frame, with the most similar bytes as `wanted`.
    """
    agreeing: int
    best, agreeing = b"", -1
    found: Sent | None = None
    sent: Sent
    for sent, wanted in candidates:
        if wanted.startswith(got):
            if found is None or sent.number > found.number:
                found, best = sent, wanted
        elif found is None:
            agree: int = _agreement(got, wanted)
            if agree > agreeing:
                best, agreeing = wanted, agree
    return Origin(None, NO_TIME, best) if found is None else Origin(found.number, found.ended, best)


def _agreement(got: bytes, wanted: bytes) -> int:
    """Return the number of places at which both arguments have the same byte."""
    return sum(a == b for a, b in zip(got, wanted, strict=False))
