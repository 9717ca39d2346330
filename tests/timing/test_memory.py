"""The state of each measure consists of plain values, which are not older than `looks_back` states."""

from __future__ import annotations

from random import Random

import pytest

from periph_sim.core.records import Kind
from periph_sim.core.snapshot import Foreign, Module, take_snapshot
from periph_sim.core.time import NO_TIME
from periph_sim.timing.measures.factory import measure_named
from periph_sim.timing.measures.measure import LOOKS_BACK, Measure
from periph_sim.timing.measures.registry import MEASURES, PHRASES
from tests.timing.events_by_hand import ONE
from tests.timing.measures.hand_made_run import GYRO, HandMadeRun, gyro_bytes, read, wrote
from tests.timing.measures.test_event import EXAMPLES, IMAGE

NOT_PLAIN = ("margin", "race")  # they have an object that reads the wires, or keep records


def memory(measure: Measure, now: int) -> dict[str, object]:
    return dict(take_snapshot({"m": Module(measure)}, now, 0, ()).values)


@pytest.mark.parametrize("text", [*MEASURES, *EXAMPLES, "from frame to frame TX, in order, same round", "reply:x"])
def test_each_measure_states_how_far_it_looks_back_and_has_plain_values(text: str):
    made = measure_named(text, ONE if "RX" in text else IMAGE)
    assert made.looks_back in LOOKS_BACK
    foreign = [name for name, value in memory(made, 0).items() if isinstance(value, Foreign)]
    assert not foreign or text.startswith(NOT_PLAIN), foreign


def test_each_row_of_the_tables_states_how_far_it_looks_back():
    rows = {**MEASURES, **PHRASES}
    assert {row.looks_back for row in rows.values()} <= set(LOOKS_BACK)
    assert {measure_named(name, ONE).looks_back == row.looks_back for name, row in MEASURES.items()} == {True}


def some_round(run: HandMadeRun, at: int, random: Random) -> None:
    """Add a random round at this tick: frames, reads that are answered, late or refused, and characters."""
    run.frame(random.randrange(1, 9), at)
    for begin in range(at + 10, at + 10 + 100 * random.randrange(1, 4), 100):
        answered = begin + random.randrange(1, 9) if random.random() < 0.8 else NO_TIME
        data = bytearray(gyro_bytes(random.randrange(1, 9)))
        data[random.randrange(6)] ^= random.randrange(2)
        run.transfer(read(GYRO, bytes(data), at=begin, answer_from=begin + 1, answer_at=answered, stretch=7))
    run.transfer(wrote(GYRO, at=at + 500, acked=random.random() < 0.5))
    run.character(at + 600, random.random() < 0.5)
    run.words(at + 601, random.randrange(16), random.random() < 0.5)
    run.span(at + 610, 1)
    run.span(at + 650, 0)
    if random.random() < 0.3:
        run.misses(at)
    else:
        run.round(at, at + random.randrange(700, 1200), nacked=random.randrange(2))


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("name", [*MEASURES, "slack", "age of gyroscope", "value error at frame", "span:model"])
def test_after_complete_rounds_the_state_depends_only_on_what_is_stated(name: str, seed: int):
    """Both runs end with the same round, but only one has rounds before it. These must not affect the state."""
    memories, counts = [], []
    for past in (0, 7):
        run, random = HandMadeRun(measure_named(name, ONE)), Random(seed)
        for number in range(past):
            some_round(run, 2000 * number, random)
        begin = 2000 * past
        some_round(run, begin, Random(99))
        memories.append(memory(run.measure, begin + 1999))
        counts.append(run.measure.count)
    assert memories[0] == memories[1]
    if run.measure.looks_back in ("this occurrence", "this transfer", "this round"):
        fresh = HandMadeRun(measure_named(name, ONE))
        fresh.recorder.topic(Kind.SPAN, "dsp", "model")  # the topics give the units that have spans
        assert memories[0] == memory(fresh.measure, 1999)
    assert counts[0] < counts[1] or name in ("stuck", "value error at frame")
