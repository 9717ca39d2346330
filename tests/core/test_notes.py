"""Notes of a chip: a run's summary lists each once, and each occurrence is recorded with its number."""

from __future__ import annotations

from fractions import Fraction

from periph_sim.core.chip import Note
from periph_sim.core.kernel import Kernel
from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.socket import Socket
from periph_sim.core.time import Clock, Timebase
from tests.processor.flag_chip import FlagChip


def test_a_note_is_listed_once_and_recorded_with_its_count_each_time():
    kernel, recorder, seen = Kernel(), Recorder(), list[Record]()
    recorder.subscribe([Kind.NOTE], seen.append)
    chip = FlagChip([])
    clock = Clock(Timebase(), Fraction(10**9))
    socket = Socket(kernel, clock, recorder, "unit.FLAGS", chip, lambda cycle, asked: None)
    lost, duty = Note("lost", "a byte is lost", "T1"), Note("duty", "a byte is lost", "T1")
    for cycle, notes in ((1, [lost]), (2, []), (3, [lost, duty]), (4, [lost])):
        chip.notes += notes
        socket.publish(cycle)
    clock.retune(5, Fraction(10**8))
    assert socket.notes == [
        (1, lost),
        (3, duty),
    ]  # the times are those of the first clock: retuning it does not change them
    assert [(r.tick, r.where, r.what, r.value, r.text) for r in seen] == [
        (1, "unit.FLAGS", "lost", 1, "a byte is lost [T1]"),
        (3, "unit.FLAGS", "lost", 2, "a byte is lost [T1]"),
        (3, "unit.FLAGS", "duty", 1, "a byte is lost [T1]"),
        (4, "unit.FLAGS", "lost", 3, "a byte is lost [T1]"),
    ]
    assert chip.notes == []
