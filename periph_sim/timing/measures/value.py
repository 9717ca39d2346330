"""Values against the truth: reads of the sensor head go in, how far off they were comes out, in millionths of an LSB.

    read of a chip --values x, y, z--.
                                     |-- worst axis --> value error
    truth at an instant, per chip ---'

The instant is the read's first data bit, which is when its values are given away; or, to leave out their age, that at
which a host frame was due: of the last frames the one that fits best.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from math import ceil

from ...bus.i2c.transfer import Transfer
from ...devices.sensor_rounds import CHIPS
from ...devices.truth import Axes, distance
from .bus import begin_of
from .measure import MILLIONTHS, READ, Measure, SceneEvents

RECENT = 8  # frames that a read may carry, as for "wrong bytes"
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
        self._due: deque[int] = deque(maxlen=RECENT)

    def listen(self, scene: SceneEvents) -> None:
        self._scene = scene
        scene.on_frame(self._frame)
        scene.on_transfer(self._transfer)

    def _frame(self, number: int, values: tuple[int, ...], tick: int) -> None:
        self._due.append(self._scene.frame_due(number))

    def _transfer(self, transfer: Transfer) -> None:
        for phase in transfer.phases:
            if not (phase.read and self._due and phase.address in self._chips):
                continue
            self.occasion(begin_of(transfer, phase))
            if len(phase.got) == BYTES:
                name, chip = self._chips[phase.address]
                instants = self._due if self._at_frame else [phase.answer_at]
                values = chip.values(bytes(phase.got))
                self.take(min(_off(values, self._scene.truth_at(tick)[name]) for tick in instants), phase.start_at)

    def missing(self) -> str:
        names = " or ".join(name for name, _ in self._chips.values())
        return f"no sample of {names} was read after a host frame had come"


def _off(values: Sequence[int], truth: Axes) -> int:
    """Millionths of an LSB between what was read and what is true, of the worst axis; rounded up."""
    return max(ceil(abs(distance(value, true)) * MILLIONTHS) for value, true in zip(values, truth, strict=True))
