"""The first, the n-th and the last event of a transfer, a round or a burst; levels at events; jitter of measures."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.core.records import Kind, Record
from periph_sim.timing.language.scope import BadEvent
from periph_sim.timing.measures.factory import measure_named
from tests.scene.runs import run_file
from tests.scene.small import sentence_of
from tests.timing.events_by_hand import ONE, played, records, summary
from tests.timing.measures.hand_made_run import GYRO, HandMadeRun, read

TRANSFERS = """
    10 bus c START 0
    12 bus c byte  2
    14 bus c byte  4
    16 bus c STOP  0
    20 bus c START 0
    22 bus c byte  6
    26 bus c STOP  0
    30 bus c START 0
    36 bus c STOP  0
    40 bus c START 0
    41 bus c byte  8
    43 bus c byte  2
    47 bus c byte  4
"""


def counted(event: str, transfers: int = 1) -> list[int]:
    """The ticks at which the event occurred."""
    made = played(f"level of SCI-A.SCIFFRX.RXFFST at {event}", TRANSFERS, 99, keep=True, transfers=transfers)
    return made.all_kept()[1].tolist()


@pytest.mark.parametrize(
    ("event", "transfers", "ticks"),
    [
        ("bus byte", 1, [12, 14, 22, 41, 43, 47]),
        ("first bus byte of transfer", 1, [12, 22, 41]),
        ("2nd bus byte of transfer", 1, [14, 43]),
        ("3rd bus byte of transfer", 1, [47]),
        ("last bus byte of transfer", 1, [14, 22, 47]),
        ("first bus byte of round", 2, [12, 41]),
        ("last bus byte of round", 2, [22, 47]),
        ("3rd bus byte of round", 2, [22, 47]),
        ("first bus START of round", 3, [10, 40]),
        ("last bus STOP of round", 3, [36]),
    ],
)
def test_the_nth_event_of_a_transfer_or_round(event: str, transfers: int, ticks: list[int]):
    assert counted(event, transfers) == ticks


@given(
    st.lists(st.sampled_from(["START", "byte", "STOP"]), max_size=30),
    st.sampled_from(["first", "last", "2nd"]),
    st.integers(1, 3),
)
def test_the_nth_event_agrees_with_a_loop_over_the_records(whats: list[str], which: str, transfers: int):
    of = [Record(i, i, Kind.BUS, "c", what, 0, "", 0) for i, what in enumerate(whats)]
    made = played(f"count of {which} bus byte of round", of, 99, transfers=transfers)
    rounds: list[list[int]] = []
    starts = 0
    for at, what in enumerate(whats):
        if what == "START":
            if starts % transfers == 0:
                rounds.append([])
            starts += 1
        elif what == "byte" and rounds:
            rounds[-1].append(at)
    wanted = sum(len(one) > 1 if which == "2nd" else bool(one) for one in rounds)
    assert made.worst == wanted


FRAMES = "".join(
    f"{at} frame RX begin 0\n{at + 10} frame RX end {at & 0xFF}\n" for at in (100, 110, 125, 200, 230, 250, 300)
)


@pytest.mark.parametrize(
    ("which", "ticks"),
    [("first", [100, 200, 230, 300]), ("last", [125, 200, 250, 300]), ("2nd", [110, 250])],
)
def test_a_pause_of_two_characters_ends_a_burst(which: str, ticks: list[int]):
    """Characters have ten ticks. Pauses are 0, 5, 65, 20 ticks (here 21, since 20 do not end a burst) and so on."""
    of = sorted(
        records(FRAMES.replace("230 frame", "231 frame")), key=lambda record: (record.tick, record.what == "begin")
    )
    made = played(f"level of SCI-A.SCIFFRX.RXFFST at {which} frame RX of burst", of, 999, keep=True)
    assert [at - (at == 231) for at in made.all_kept()[1].tolist()] == ticks


def test_the_time_from_the_last_byte_of_a_frame_to_the_models():
    """In each period of 20 ms, the frame ends at 3.042 ms and the models begin at 7.624 ms."""
    text = "from last frame RX end of burst to edge MODEL rise"
    (verdict,) = run_file(
        "imu_hil_published", "0.1", f'budget=[{{name="b", measure="{text}", max="5 ms"}}]'
    ).result.budgets
    assert verdict.passed and verdict.count == 5 and verdict.worst == pytest.approx(4580, abs=5)


# Levels at events -------------------------------------------------------------------------------------------------


def test_the_level_at_an_event_is_that_after_the_last_change_before_it():
    of = """
        10 flag dsp.SCI-A SCIFFRX.RXFFST 7
        20 irq  dsp SCIRXINTA 1
        20 flag dsp.SCI-A SCIFFRX.RXFFST 8
        30 irq  dsp SCIRXINTA 0
        40 irq  dsp SCIRXINTA 1
    """
    assert summary(played("level of SCI-A.SCIFFRX.RXFFST at interrupt SCIRXINTA enter", of)) == (8, 40, 7, 2)
    assert summary(played("level of SCI-A.SCIFFRX.RXFFST at bus START", "5 bus c START 0", value=3)) == (3, 5, 3, 1)


def test_the_level_of_the_fifo_at_the_entry_of_its_service_routine():
    text = "level of SCI-A.SCIFFRX.RXFFST at interrupt SCIRXINTA enter"
    (verdict,) = run_file(
        "imu_hil_published", "0.1", f'budget=[{{name="b", measure="{text}", exactly=12}}]'
    ).result.budgets
    assert verdict.passed and verdict.count == 5


# Jitter -----------------------------------------------------------------------------------------------------------


def test_the_jitter_of_a_measure_is_the_difference_of_consecutive_values():
    jitter = measure_named("jitter of response", ONE)
    made = HandMadeRun(jitter)
    jitter.keep()
    for at, length in ((0, 5), (100, 9), (200, 8), (300, 8)):
        made.transfer(read(GYRO, at=at, answer_from=at, answer_at=at + length))
    jitter.finish(999)
    assert jitter.all_kept()[0].tolist() == [4, 1, 0] and (jitter.measured, jitter.occasions) == (3, 3)
    assert (jitter.unit, jitter.needs) == ("time", "I2C-A")


@pytest.mark.parametrize("text", ["response", "round", "age of gyroscope", "stretch", "slack", "fifo high-water"])
def test_every_measure_with_several_values_has_a_jitter(text: str):
    jitter, of = measure_named(f"jitter of {text}", ONE), measure_named(text, ONE)
    assert (jitter.unit, jitter.kinds, jitter.needs, jitter.series) == (of.unit, of.kinds, of.needs, True)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("jitter of nacked rounds", "'jitter of nacked rounds': that is one number a run, so it has no jitter"),
        ("jitter of bus load", "'jitter of bus load': that is one number a run, so it has no jitter"),
        (
            "jitter of jitter of stretch",
            "'jitter of jitter of stretch': a jitter has no jitter; name the measure itself",
        ),
        ("jitter of respons", "there is no measure 'respons'; did you mean response?"),
        ("jitter of", "'jitter of' ends where a measure or an event is expected"),
    ],
)
def test_a_jitter_of_measures_without_one_is_rejected(text: str, sentence: str):
    assert sentence_of(BadEvent, lambda: measure_named(text, ONE)) == sentence


def test_only_accesses_in_the_service_routine_are_counted():
    of = """
        10 access dsp W_I2C-A.I2CDXR 1
        20 irq    dsp SCIRXINTA 1
        30 irq    dsp SCIRXINTA 0
        31 access dsp W_I2C-A.I2CDXR 1
        40 irq    dsp SCIRXINTA 1
        44 access dsp W_I2C-A.I2CDXR 1
        45 access dsp W_I2C-A.I2CDXR 1
    """
    assert summary(played("count of first access W I2C-A.I2CDXR of interrupt dsp:SCIRXINTA", of)) == (1, 44, 1, 1)
    assert summary(played("count of last access by dsp of interrupt SCIRXINTA", of, 99)) == (1, 45, 1, 1)


# Latency to the first access ---------------------------------------------------------------------------------------


def test_the_first_access_of_a_service_routine_ends_its_latency():
    of = """
        10 flag   dsp.PIE PIEIFR9.INTx1 1
        12 access dsp     W_I2C-A.I2CDXR 1
        20 irq    dsp     SCIRXINTA     1
        31 access dsp     R_SCI-A.SCIRXBUF 1
        33 access dsp     R_SCI-A.SCIRXBUF 1
        50 irq    dsp     SCIRXINTA     0
        60 access dsp     W_I2C-A.I2CDXR 1
        70 flag   dsp.PIE PIEIFR9.INTx1 1
        75 irq    dsp     SCIRXINTA     1
    """
    made = played("interrupt latency SCIRXINTA to first access", of)
    assert summary(made) == (21, 10, 21, 1)
    assert made.close(99).startswith("'flag PIE.PIEIFR9.INTx1 rise' still waited for an access") and made.worst == 29
