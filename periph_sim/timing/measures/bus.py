"""Measures of reads on the bus: transfers go in; answer times, stretching, refusals and wrong bytes come out."""

# core: compiled

from __future__ import annotations

from ...bus.i2c.transfer import Phase, Transfer
from ...core.counted import counted
from ...core.time import NO_TIME
from ...devices.sensor_rounds import ADDRESSES
from .measure import READ, Counter, Measure, ReadOrigins, SceneEvents


def begin_of(transfer: Transfer, phase: Phase) -> int:
    """The tick of a phase's START; of its transfer's where the phase never began, since the one before was refused."""
    if phase.start_at != NO_TIME:
        return phase.start_at
    first: Phase = transfer.phases[0]
    return first.start_at


class PhaseMeasure(Measure):
    """A measure of addressed phases, told of each when its transfer is over."""

    def listen(self, scene: SceneEvents) -> None:
        scene.on_transfer(self._transfer)

    def _transfer(self, transfer: Transfer) -> None:
        for phase in transfer.phases:
            self.phase(transfer, phase)

    def phase(self, transfer: Transfer, phase: Phase) -> None:
        """A phase of a transfer that is over."""
        raise NotImplementedError


class Response(PhaseMeasure):
    """From the SCL fall that ends the ACK slot of a read address to the SCL rise of the first data bit."""

    needs = "I2C-A"
    asked = "reads asked"

    def phase(self, transfer: Transfer, phase: Phase) -> None:
        if phase.read:
            self.occasion(begin_of(transfer, phase))
            if phase.answer_at != NO_TIME:
                self.take(phase.answer_at - phase.answer_from, phase.answer_from)


class Stretch(PhaseMeasure):
    """Longest time SCL was held low after the master had let go of it, per acknowledged phase, whoever that is."""

    needs = "I2C-A"
    occurrence = READ
    asked = "addressed phases asked"

    _held_since: int

    def listen(self, scene: SceneEvents) -> None:
        self._scene = scene
        super().listen(scene)

    def phase(self, transfer: Transfer, phase: Phase) -> None:
        self.occasion(begin_of(transfer, phase))
        if phase.acked:
            self.take(phase.stretch, phase.start_at)

    def finish(self, now: int) -> None:
        self._held_since = self._scene.held_since()

    def unfinished(self, now: int) -> list[tuple[int, int]]:
        return [] if self._held_since == NO_TIME else [(now - self._held_since, self._held_since)]

    def unfinished_text(self) -> str:
        return "SCL was still held low when the run ended"


class Nacked(Counter):  # core: python
    """Requests whose address nobody acknowledged."""

    needs = "I2C-A"

    def listen(self, scene: SceneEvents) -> None:
        self._scene = scene
        scene.on_transfer(self._transfer)

    def close(self, now: int) -> str:
        """A refused request counts even if its master, which may hang, gives no STOP before the run ends."""
        transfer = self._scene.open_transfer()
        if transfer is not None:
            self._transfer(transfer)
        return super().close(now)

    def _transfer(self, transfer: Transfer) -> None:
        if not transfer.acked and transfer.phases[0].start_at != NO_TIME:
            self.one_more(transfer.phases[0].start_at)


class WrongBytes(PhaseMeasure):
    """Bytes read that are not what they should be: `expect` of the request, or what a host frame makes them.

    worst is how many were wrong, count how many were compared: a run that compared nothing proves nothing.
    """

    needs = "rounds"
    asked = "bytes asked"
    unit = "bytes"
    series = False

    _origins: ReadOrigins | None

    def listen(self, scene: SceneEvents) -> None:
        self._origins = scene.origins() if scene.checks_host() else None
        self.where: dict[str, int] = {}  # "gyroscope byte 0" -> how often it was wrong
        self.first = ""  # the first wrong read, as a sentence
        self._zeros: dict[int, int] = {}  # by address: bytes that are right if a frame is shown later
        self._unknown = 0  # bytes that may be right or wrong
        super().listen(scene)

    def phase(self, transfer: Transfer, phase: Phase) -> None:
        if not phase.read:
            return
        got = phase.got
        if phase.expect is not None or (self._origins is not None and phase.address in ADDRESSES):
            self.occasion(begin_of(transfer, phase), max(phase.count, len(got)))
        if got:
            wanted = self._wanted(phase)
            compared: int = min(len(got), len(wanted))
            if phase.expect is None and self._origins is not None and not self._is_judged(phase, compared):
                return
            self.count += compared
            if got[:compared] != wanted[:compared]:
                self._wrong(transfer, phase, wanted)

    def _is_judged(self, phase: Phase, compared: int) -> bool:
        """False, after counting the bytes of the read, where they may be right or wrong."""
        origin = None if self._origins is None else self._origins.of(phase)
        if origin is None:
            return True
        if origin.known:
            self.count += self._zeros.pop(phase.address, 0)
        elif not origin.judged and origin.frame is None:
            self._unknown += compared
        elif not origin.judged:
            self._zeros[phase.address] = self._zeros.get(phase.address, 0) + compared
        return origin.judged

    def finish(self, now: int) -> None:
        zeros = sum(self._zeros.values())
        if zeros:
            self.not_judged = f"{counted(zeros, 'byte')} read as 0 from chips that never showed a host frame's values"
        elif self._unknown:
            self.not_judged = f"{counted(self._unknown, 'byte')} may be of frames that were not compared with them"

    def _wrong(self, transfer: Transfer, phase: Phase, wanted: bytes) -> None:
        """A read in which some bytes are not those."""
        wrong = [i for i, (a, b) in enumerate(zip(phase.got, wanted, strict=False)) if a != b]
        if not self.worst:
            self.worst_at = self.least_at = phase.start_at
            self.first = f"{transfer.name} read {phase.got.hex(' ')} where {wanted.hex(' ')} was expected"
        self.worst = self.least = self.worst + len(wrong)
        for i in wrong:
            place = f"{transfer.name} byte {i}"
            self.where[place] = self.where.get(place, 0) + 1

    def _wanted(self, phase: Phase) -> bytes:
        if phase.expect is not None:
            return phase.expect
        origin = None if self._origins is None else self._origins.of(phase)
        return b"" if origin is None else origin.wanted


class Stuck(Counter):  # core: python
    """Times a line of the bus was held low longer than `stuck_after`."""

    needs = "I2C-A"

    def listen(self, scene: SceneEvents) -> None:
        scene.on_stuck(self.one_more)
