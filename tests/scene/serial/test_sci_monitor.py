"""Records of an SCI receiver: words waiting in the FIFO, characters received, and characters lost.

RX    --|---1---|---2---|---3---|
records     received    received and lost
"""

from __future__ import annotations

import pytest

from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.time import Timebase
from periph_sim.firmware import start_sci
from periph_sim.processor.dsp import Dsp
from tests.scene.serial.programs import scene
from tests.scene.small import unit


class ReceiverRecords:
    """Counts of the records of a receiver."""

    def __init__(self) -> None:
        self.words: list[tuple[int, bool]] = []  # words waiting, and True if one was lost
        self.characters = 0
        self.lost = 0

    def subscribe(self, recorder: Recorder, timebase: Timebase) -> None:
        names = {(Kind.RECEIVER, what) for what in ("words", "lost", "received")}
        recorder.subscribe([Kind.RECEIVER], self._record, things=names)

    def _record(self, record: Record) -> None:
        if record.what == "received":
            self.characters += 1
        elif record.what == "words":
            self.words.append((record.value, False))
        else:
            self.lost += 1
            self.words[-1] = (self.words[-1][0], True)


def monitored(characters: int, fifo: bool, reads_after: tuple[int, ...] = (), **options: str) -> ReceiverRecords:
    """Monitor an SCI whose firmware reads SCIRXBUF once after each of these pauses, in us, and then never again."""

    def main(dsp: Dsp) -> None:
        sci = start_sci(dsp, "SCI-A")
        if not fifo:
            sci.SCIFFTX.SCIFFENA = 0
        for pause in reads_after:
            dsp.compute(pause * 150)
            assert sci.SCIRXBUF.all == 0x55
        while True:
            dsp.compute(1000)

    serial = {"send": [{"to": "dsp.SCI-A", "at": "100 us", "bytes": "55 " * characters}]}
    found, table = ReceiverRecords(), unit("SCI-A", options={"sci": options})
    made = scene({"dsp": main}, None, (), found.subscribe, unit={"dsp": table}, serial=serial, duration="3 ms")
    made.run()
    return found


@pytest.mark.parametrize(
    ("characters", "fifo", "words"),
    [
        (1, False, []),
        (2, False, [(0, True)]),
        (1, True, [(1, False)]),
        (16, True, [(n, False) for n in range(1, 17)]),
        (17, True, [*((n, False) for n in range(1, 17)), (16, True)]),
    ],
)
def test_each_character_is_recorded_whether_lost_or_not(characters: int, fifo: bool, words: list[tuple[int, bool]]):
    found = monitored(characters, fifo)
    assert (found.characters, found.words) == (characters, words)


@pytest.mark.parametrize("drops", ["oldest", "newest"])
@pytest.mark.parametrize(("characters", "fifo", "lost"), [(12, False, 11), (16, True, 0), (17, True, 1), (20, True, 4)])
def test_every_lost_character_counts_though_its_flag_stays_set(characters: int, fifo: bool, lost: int, drops: str):
    assert monitored(characters, fifo, fifo_overflow_drops=drops).lost == lost


def test_characters_that_are_read_in_between_are_not_lost():
    """Each lost character is recorded, although the flag of an overrun stays set.

    RX       |-1-|-2-|-3-|-4-|-5-|-6-|------
    reads                 ^   ^
    lost             1   2           5
    OE       ________|~~~~~~~~~~~~~~~~~~~~~~
    """
    found = monitored(6, False, (400, 90))
    assert (found.lost, found.words) == (3, [(0, True)])
