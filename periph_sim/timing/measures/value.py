"""Values against the truth: reads of the sensor head go in, how far off they were comes out, in millionths of an LSB.

    read of a chip --values x, y, z--.
                                     |-- worst axis --> value error
    truth at an instant, per chip ---'

The instant is the read's first data bit, which is when its values are given away; or, to leave out their age, that at
which a host frame was due: the one that fits best of those that have come since the frame that fitted the chip's last
read, and of the last 8.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from math import ceil

from ...bus.i2c.transfer import Transfer
from ...core.counted import counted
from ...core.time import NO_TIME
from ...devices.sensor_rounds import CHIPS
from ...devices.truth import Axes, distance
from .bus import begin_of
from .measure import MILLIONTHS, READ, Measure, SceneEvents

RECENT = 8  # frames that a read is always compared with,
MOST = 64  # and those that it is compared with at most
BYTES = 6  # of a read that carries a whole sample


class ValueDeviation(Measure):
    """|value read - truth| of the worst axis of each read of a chip, as soon as a host frame has come.

    chip: a name of CHIPS; empty for all. at_frame: against the truth at the frame that fits best of the last ones,
    not at the read's first data bit.
    """

    unit = "LSB"
    needs = "host"
    occurrence = READ
    asked = "reads asked"

    def __init__(self, chip: str, at_frame: bool) -> None:
        super().__init__()
        self._chips = {c.address: (name, c) for name, c in CHIPS.items() if chip in ("", name)}
        self._at_frame = at_frame
        self._due: deque[int] = deque(maxlen=MOST)
        self._fitted: dict[str, int] = {}  # by chip, when the frame was due that fitted its last read
        self._left_out = NO_TIME  # when the last frame was due that is no longer in `_due`
        self._unknown = 0  # reads that may fit a frame which was left out

    def listen(self, scene: SceneEvents) -> None:
        self._scene = scene
        scene.on_frame(self._frame)
        scene.on_transfer(self._transfer)

    def _frame(self, number: int, values: tuple[int, ...], tick: int) -> None:
        if len(self._due) == MOST:
            self._left_out = self._due[0]
        self._due.append(self._scene.frame_due(number))

    def _transfer(self, transfer: Transfer) -> None:
        for phase in transfer.phases:
            if not (phase.read and self._due and phase.address in self._chips):
                continue
            self.occasion(begin_of(transfer, phase))
            if len(phase.got) == BYTES:
                name, chip = self._chips[phase.address]
                values = chip.values(bytes(phase.got))
                if self._at_frame:
                    self._at_best(name, values, phase.start_at)
                else:
                    self.take(_off(values, self._scene.truth_at(phase.answer_at)[name]), phase.start_at)

    def _at_best(self, name: str, values: Sequence[int], at: int) -> None:
        """Take the error against the frame that fits best, unless a frame that may fit better was left out."""
        oldest = self._fitted.get(name, NO_TIME)
        recent = len(self._due) - RECENT
        instants = [due for n, due in enumerate(self._due) if n >= recent or due >= oldest]
        off, fitted = min((_off(values, self._scene.truth_at(due)[name]), -due) for due in instants)
        if self._left_out != NO_TIME and oldest <= self._left_out:
            self._unknown += 1
            self.not_judged = f"{counted(self._unknown, 'read')} may fit frames that were not compared with them"
            return
        self._fitted[name] = -fitted
        self.take(off, at)

    def missing(self) -> str:
        names = " or ".join(name for name, _ in self._chips.values())
        return f"no sample of {names} was read after a host frame had come"


def _off(values: Sequence[int], truth: Axes) -> int:
    """Millionths of an LSB between what was read and what is true, of the worst axis; rounded up."""
    return max(ceil(abs(distance(value, true)) * MILLIONTHS) for value, true in zip(values, truth, strict=True))
