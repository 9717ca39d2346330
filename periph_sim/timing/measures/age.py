"""Age of data: frames of the host and reads of its chips go in; how old what was read was comes out.

    frame 1 ends        frame 2 ends
        |-------- age -----|--------> read of frame 1's values
        |------------------ age ----------------> read of frame 1's values once more, or of no frame's
                           |------------- age ----------------> read of frame 2's values

Every read has an age. Data that no frame comes for gets older and older, whoever is to blame for it.
"""

# core: compiled

from __future__ import annotations

from ...bus.i2c.transfer import Phase, Transfer
from ...core.counted import counted
from ...core.records import UNHEARD, Kind
from ...core.time import NO_TIME
from ...devices.sensor_rounds import CHIPS
from .bus import PhaseMeasure, begin_of
from .measure import MODEL, READ, ReadOrigins, SceneEvents


class ReadMeasure(PhaseMeasure):
    """A measure of every read of known chips that begins after the first host frame has come.

    chip: a name of CHIPS; empty for all.
    """

    needs = "host"
    occurrence = READ
    asked = "reads asked"

    def __init__(self, chip: str = "") -> None:
        super().__init__()
        self.addresses = {c.address for name, c in CHIPS.items() if chip in ("", name)}
        self.first_frame = NO_TIME  # the end of the first frame

    def listen(self, scene: SceneEvents) -> None:
        scene.on_frame(self._frame)
        super().listen(scene)

    def _frame(self, number: int, values: tuple[int, ...], tick: int) -> None:
        if self.first_frame == NO_TIME:
            self.first_frame = tick
        self.frame(tick)

    def phase(self, transfer: Transfer, phase: Phase) -> None:
        if not phase.read or self.first_frame == NO_TIME or phase.address not in self.addresses:
            return
        begin: int = begin_of(transfer, phase)
        if self.first_frame <= begin:
            self.occasion(begin)
            if phase.got:
                self.chip_read(phase)

    def frame(self, tick: int) -> None:
        """A host frame has ended."""

    def chip_read(self, phase: Phase) -> None:
        """A chip was read."""
        raise NotImplementedError


class Age(ReadMeasure):
    """From the end of the host frame whose values a read carries to the read's START.

    A read with values of no frame carries data as old as the last that was a frame's. Until a chip has shown any frame,
    the first one counts. Of several frames with the same values it is the youngest.
    """

    _origins: ReadOrigins

    def listen(self, scene: SceneEvents) -> None:
        self._origins = scene.origins()
        self._shown: dict[int, int] = {}  # by address, the end of the frame that was shown last
        self._unknown = 0  # reads whose age is not known
        super().listen(scene)

    def chip_read(self, phase: Phase) -> None:
        origin = self._origins.of(phase)
        if origin is not None and origin.known:
            self._shown[phase.address] = min(origin.ended, phase.start_at)
        elif origin is not None and origin.frame is None and not origin.judged:
            self._unknown += 1
            self.not_judged = f"{counted(self._unknown, 'read')} may carry frames that were not compared with them"
            return
        self.take(phase.start_at - self._shown.get(phase.address, self.first_frame), phase.start_at)


class ModelAge(ReadMeasure):
    """From the end of the last host frame that was whole when the models began to every read of what they made.

    As `age`, for firmware whose chips do not show the values of frames: when models begin is told by its span "model".
    """

    kinds = frozenset({Kind.SPAN})

    def listen(self, scene: SceneEvents) -> None:
        self._sent = NO_TIME  # the end of the last whole frame,
        self._taken = NO_TIME  # of the one that the models under way work on,
        self._made = NO_TIME  # and of the one that the last models worked on
        super().listen(scene)

    @property
    def silent(self) -> bool:
        return not self.count or self._made == NO_TIME

    def missing(self) -> str:
        if self._made == NO_TIME:
            return f"no span {MODEL!r} was over that began after a host frame had come"
        return "no chip was read after a host frame had come"

    def frame(self, tick: int) -> None:
        self._sent = tick

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        return 0 if what == MODEL else UNHEARD

    def hear(self, tag: int, tick: int, value: int) -> None:
        if value:
            self._taken = self._sent
        elif self._taken != NO_TIME:
            self._made = self._taken

    def chip_read(self, phase: Phase) -> None:
        since = self.first_frame if self._made == NO_TIME else self._made
        self.take(phase.start_at - since, phase.start_at)
