"""Records of reads of known chips: the age of the data, and how many of the bytes are right.

    frame 1 ends        frame 2 ends
        |-------- age -----|--------> read of frame 1's values
        |------------------ age ----------------> read of frame 1's values again, or of values of no frame
                           |------------- age ----------------> read of frame 2's values

    thing         tick                        value
    chip read     START of the read           chip's address; for each read that begins after the first frame ended
    age           START of the read           ticks since the end of the frame whose values the read returned
    unknown age   START of the read           chip's address; made instead of `age` if no compared frame has these
                                              bytes, and not all possible frames were compared
    model age     START of the read           ticks since the end of the frame that the last model run used; before the
                                              first model run, since the end of the first frame
    model run     end of the span "model"     0; for each model run that began after the first frame ended

A chip shows a frame while its registers contain values of the frame.

Every read that returns bytes, and begins after the first frame ended, has an age or an unknown age. If the values are
of no frame, the age counts from the frame that the chip showed last. Until a chip has shown a frame, the age counts
from the first frame. If several frames have the same values, the age counts from the last of them.

The model age is for firmware that computes the values of its chips from frames with sensor models. The firmware's span
"model" marks each model run. A model run is assumed to use the last frame that ended before the run began.

    thing            tick               value
    bytes asked      START of the read  number of bytes requested or read, whichever is larger
    bytes compared   START of the read  number of bytes whose right values are known; when a chip first returns values
                                        of a frame, also the number of its earlier zeros, which are right then
    wrong bytes      START of the read  number of these bytes that are wrong
    expected byte    START of the read  256 * index of the byte in the read + right value; for each wrong byte
    zeros            end of the run     number of bytes read as 0 from chips that never returned a host frame's values
    unknown bytes    end of the run     number of bytes of reads whose right values are not known, because not all
                                        possible frames were compared
"""

# core: compiled

from __future__ import annotations

from typing import TYPE_CHECKING

from ...bus.i2c.transfer import Phase, Transfer
from ...core.records import UNWANTED, Kind, Listener, Recorder
from ...core.time import NO_TIME
from ...devices.sensor_rounds import known_sensors
from .transfer_records import I2C, begin_of

if TYPE_CHECKING:
    from ...core.records import Topic
    from . import origins as read_origins  # the module, because compiled code would import its classes at run time


MODEL = "model"  # the name of the span in which firmware computes its sensor models


class ChipTopics:
    """The topics of the records of one chip.

    shown: the end, in ticks, of the frame whose values a read of the chip last returned; NO_TIME if there is none.
    """

    __slots__ = ("age", "model_age", "read", "shown", "unknown")

    def __init__(self, recorder: Recorder, name: str) -> None:
        self.read: Topic = recorder.topic(Kind.DATA, name, "chip read")
        self.age: Topic = recorder.topic(Kind.DATA, name, "age")
        self.unknown: Topic = recorder.topic(Kind.DATA, name, "unknown age")
        self.model_age: Topic = recorder.topic(Kind.DATA, name, "model age")
        self.shown = NO_TIME


class AgeRecords(Listener):
    """Makes the records of the ages of the data that chips returned, and of model runs.

    origins: the object that finds the frame whose values a read returned; None if only model ages are needed.
    """

    def __init__(self, recorder: Recorder, origins: read_origins.Origins | None = None) -> None:
        self.origins: read_origins.Origins | None = origins
        self._chips = {chip.address: ChipTopics(recorder, name) for name, chip in known_sensors().items()}
        self._model_run: Topic = recorder.topic(Kind.DATA, MODEL, "model run")
        self._first_ended = NO_TIME  # the end of the first frame, in ticks
        self._last_ended = NO_TIME  # the end of the last frame, in ticks
        self._taken = NO_TIME  # the end of the frame that the present model run uses, in ticks
        self._made = NO_TIME  # the end of the frame that the last complete model run used, in ticks

    def frame(self, number: int, values: tuple[int, ...], tick: int) -> None:
        """Store the end of a host frame. tick: the tick of this end."""
        if self._first_ended == NO_TIME:
            self._first_ended = tick
        self._last_ended = tick

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        return 0 if what == MODEL else UNWANTED

    def on_record(self, tag: int, tick: int, value: int) -> None:
        """Handle the start (value 1) or the end (value 0) of a model run."""
        if value:
            self._taken = self._last_ended
        elif self._taken != NO_TIME:
            self._made = self._taken
            self._model_run.emit(tick, 0)

    def transfer(self, transfer: Transfer) -> None:
        """Record the ages of the values that the reads of a complete transfer returned."""
        if self._first_ended == NO_TIME:
            return
        phase: Phase
        for phase in transfer.phases:
            chip: ChipTopics | None = self._chips.get(phase.address) if phase.read else None
            if chip is not None:
                begin = begin_of(transfer, phase)
                if self._first_ended <= begin:
                    chip.read.emit(begin, phase.address)
                    if phase.got:
                        self._record_ages(chip, phase)

    def _record_ages(self, chip: ChipTopics, phase: Phase) -> None:
        since = self._first_ended if self._made == NO_TIME else self._made
        chip.model_age.emit(phase.start_at, phase.start_at - since)
        if self.origins is None:
            return
        origin = self.origins.of(phase)
        if origin is not None and origin.known:
            chip.shown = min(origin.ended, phase.start_at)
        elif origin is not None and origin.frame is None and not origin.judged:
            chip.unknown.emit(phase.start_at, phase.address)
            return
        since = self._first_ended if chip.shown == NO_TIME else chip.shown
        chip.age.emit(phase.start_at, phase.start_at - since)


class ByteRecords:
    """Compares the bytes of reads with `Phase.expect`, or with the values of host frames.

    origins: the object that finds the frame whose values a read returned; None if no bytes are compared with frames.
    wrong_places: the number of wrong bytes at each place, such as "gyroscope byte 0".
    first_wrong: a sentence about the first wrong read.
    """

    def __init__(self, recorder: Recorder, origins: read_origins.Origins | None) -> None:
        self.wrong_places: dict[str, int] = {}
        self.first_wrong = ""
        self._origins: read_origins.Origins | None = origins
        self._asked: Topic = recorder.topic(Kind.DATA, I2C, "bytes asked")
        self._compared: Topic = recorder.topic(Kind.DATA, I2C, "bytes compared")
        self._wrong: Topic = recorder.topic(Kind.DATA, I2C, "wrong bytes")
        self._expected: Topic = recorder.topic(Kind.DATA, I2C, "expected byte")
        self._never_shown: Topic = recorder.topic(Kind.DATA, I2C, "zeros")
        self._not_known: Topic = recorder.topic(Kind.DATA, I2C, "unknown bytes")
        # `_zeros` maps a chip's address to the number of bytes that were read as 0 before the chip returned values of a
        # frame. These zeros are right if a later read of the chip returns the values of a frame.
        self._zeros: dict[int, int] = {}
        self._unknown = 0

    def transfer(self, transfer: Transfer) -> None:
        """Compare the bytes that the reads of a complete transfer returned with the right bytes."""
        phase: Phase
        for phase in transfer.phases:
            if phase.read:
                self._read(transfer, phase)

    def finish(self, now: int) -> None:
        """Make the records "zeros" and "unknown bytes", which count bytes that could not be judged.

        now: the tick at which the run ends.
        """
        zeros: int = sum(self._zeros.values())
        if zeros:
            self._never_shown.emit(now, zeros)
        if self._unknown:
            self._not_known.emit(now, self._unknown)

    def _read(self, transfer: Transfer, phase: Phase) -> None:
        got = phase.got
        begin = begin_of(transfer, phase)
        if phase.expect is not None or (self._origins is not None and phase.address in self._origins.addresses):
            self._asked.emit(begin, max(phase.count, len(got)))
        if not got:
            return
        wanted = self._wanted(phase)
        compared: int = min(len(got), len(wanted))
        if phase.expect is None and self._origins is not None and not self._is_judged(phase, compared):
            return
        self._compared.emit(begin, compared)
        if got[:compared] != wanted[:compared]:
            self._record_wrong(transfer, phase, wanted)

    def _is_judged(self, phase: Phase, compared: int) -> bool:
        """Return True if the right bytes of a read are known. Otherwise, count its bytes for `finish`."""
        origin = None if self._origins is None else self._origins.of(phase)
        if origin is None:
            return True
        if origin.known:
            shown_before: int = self._zeros.pop(phase.address, 0)
            self._compared.emit(phase.start_at, shown_before)
        elif not origin.judged and origin.frame is None:
            self._unknown += compared
        elif not origin.judged:
            self._zeros[phase.address] = self._zeros.get(phase.address, 0) + compared
        return origin.judged

    def _record_wrong(self, transfer: Transfer, phase: Phase, wanted: bytes) -> None:
        wrong = [i for i, (a, b) in enumerate(zip(phase.got, wanted, strict=False)) if a != b]
        if not self.first_wrong:
            self.first_wrong = f"{transfer.name} read {phase.got.hex(' ')} where {wanted.hex(' ')} was expected"
        self._wrong.emit(phase.start_at, len(wrong))
        for i in wrong:
            self._expected.emit(phase.start_at, i << 8 | wanted[i])
            place = f"{transfer.name} byte {i}"
            self.wrong_places[place] = self.wrong_places.get(place, 0) + 1

    def _wanted(self, phase: Phase) -> bytes:
        if phase.expect is not None:
            return phase.expect
        origin = None if self._origins is None else self._origins.of(phase)
        return b"" if origin is None else origin.wanted
