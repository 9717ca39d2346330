"""Every measure with a fixed name on a hand-made run: the values that it includes, and the time of the worst."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.bus.i2c.transfer import Phase
from periph_sim.core.records import Kind, Record
from periph_sim.core.time import NO_TIME
from periph_sim.timing.derived.origins import RECENT
from periph_sim.timing.language.scope import BadEvent
from periph_sim.timing.measures.event import EventMeasure
from periph_sim.timing.measures.measure import Tally
from periph_sim.timing.measures.registry import MEASURES
from tests.timing.events_by_hand import feed, make
from tests.timing.measures.hand_made_run import (
    ACCEL,
    GYRO,
    MAGNET,
    OTHER,
    HandMadeRun,
    accel_bytes,
    gyro_bytes,
    magnet_bytes,
    read,
    wrote,
)


def test_response_is_from_the_scl_fall_after_the_ack_to_the_rise_for_the_first_data_bit():
    run = HandMadeRun("response")
    run.transfer(wrote(GYRO), read(GYRO, answer_from=100, answer_at=180))
    run.transfer(read(GYRO, answer_from=500, answer_at=530))
    run.transfer(read(GYRO, answer_from=900, answer_at=NO_TIME))  # never answered
    run.transfer(Phase(GYRO, read=False, answer_from=1000, answer_at=5000))  # a write
    assert run.summary() == (80, 100, 30, 2)


def test_stretch_has_the_longest_value_of_each_acknowledged_phase():
    run = HandMadeRun("stretch")
    run.transfer(read(GYRO, at=10, stretch=7), read(GYRO, at=20, stretch=0))
    run.transfer(Phase(GYRO, read=True, start_at=30, stretch=99))  # not acknowledged
    assert run.summary() == (7, 10, 0, 2)


def test_round_is_from_its_begin_to_its_last_stop():
    run = HandMadeRun("round")
    run.round(1000, 1500)
    run.round(3000, 3700)
    assert run.summary() == (700, 3000, 500, 2)


def test_missed_rounds_are_counted_from_the_first_one():
    run = HandMadeRun("missed rounds")
    assert run.summary() == (0, NO_TIME, 0, 0)
    for due in (9, 29, 49):
        run.misses(due)
    assert run.summary() == (3, 9, 3, 3)


def test_nacked_rounds_counts_rounds_not_requests():
    run = HandMadeRun("nacked rounds")
    run.round(10, 20)
    run.round(30, 40, nacked=3)
    run.round(50, 60, nacked=1)
    assert run.summary() == (2, 30, 2, 2)


def test_nacked_counts_requests_whose_address_was_not_acknowledged():
    run = HandMadeRun("nacked")
    run.transfer(wrote(GYRO), read(GYRO, at=5))
    run.transfer(wrote(GYRO, at=40, acked=False))
    run.transfer(wrote(GYRO, at=70), Phase(GYRO, read=True, start_at=75))
    assert run.summary() == (2, 40, 2, 2)


def test_a_request_that_was_never_sent_is_not_counted_as_nacked():
    run = HandMadeRun("nacked")
    run.transfer(wrote(GYRO, at=NO_TIME, acked=False))
    assert run.measure.count == 0


@pytest.mark.parametrize(
    ("address", "data"), [(GYRO, gyro_bytes(2)), (ACCEL, accel_bytes(2)), (MAGNET, magnet_bytes(2))]
)
def test_bytes_of_a_recent_frame_are_correct_in_the_byte_order_of_each_chip(address: int, data: bytes):
    run = HandMadeRun("wrong bytes")
    run.transfer(read(address, bytes(6)))  # before the first frame every chip shows zeros
    for n in range(4):
        run.frame(n, n * 100)
    run.transfer(read(address, data))
    assert (run.measure.worst, run.measure.count) == (0, 12)


def test_a_byte_that_is_not_in_its_frame_is_counted_and_reported():
    run = HandMadeRun("wrong bytes")
    run.frame(2, 100)
    data = bytearray(gyro_bytes(2))
    data[0] ^= 0x10
    run.transfer(read(GYRO, bytes(data), at=300))
    run.transfer(read(GYRO, bytes(data), at=700))
    assert run.summary() == (2, 300, 2, 12)
    assert run.bytes.wrong_places == {"chip byte 0": 2}


def test_bytes_of_a_frame_that_is_no_longer_recent_are_wrong():
    run = HandMadeRun("wrong bytes")
    for n in range(1, 2 + RECENT):
        run.frame(n, n)
    run.transfer(read(GYRO, gyro_bytes(2)))
    assert run.measure.worst == 0
    run.transfer(read(GYRO, gyro_bytes(1)))
    assert run.measure.worst > 0


def test_mixed_bytes_of_two_frames_are_wrong_where_they_differ_from_the_nearer_frame():
    run = HandMadeRun("wrong bytes")
    run.frame(1, 1)
    run.frame(2, 2)
    run.transfer(read(GYRO, gyro_bytes(1)[:4] + gyro_bytes(2)[4:]))
    differ = sum(a != b for a, b in zip(gyro_bytes(1)[4:], gyro_bytes(2)[4:], strict=True))
    assert run.measure.worst == differ > 0


def test_expected_bytes_of_the_request_take_precedence_over_frames():
    run = HandMadeRun("wrong bytes")
    phase = read(OTHER, b"\x01\x02\x03", at=9)
    phase.expect = b"\x01\xff\x03"
    run.transfer(phase)
    assert run.summary() == (1, 9, 1, 3)


def test_bytes_of_an_unknown_chip_are_not_compared():
    run = HandMadeRun("wrong bytes")
    run.transfer(read(OTHER, b"\x01\x02"))
    assert run.measure.count == 0


def test_known_chips_are_compared_with_frames_only_if_the_case_requires_it():
    run = HandMadeRun("wrong bytes", checks_host=False)
    run.transfer(read(GYRO, b"\x01\x02"))
    assert run.measure.count == 0


def test_fifo_high_water_is_the_highest_number_of_waiting_words():
    run = HandMadeRun("fifo high-water")
    for tick, words in ((10, 1), (20, 2), (30, 0), (40, 5), (50, 4)):
        run.words(tick, words)
    assert run.summary() == (5, 40, 0, 5)


def test_overruns_are_counted():
    run = HandMadeRun("overruns")
    run.words(10, 16)
    run.words(20, 16, overrun=True)
    run.words(30, 15)
    run.words(40, 16, overrun=True)
    assert run.summary() == (2, 20, 2, 2)


def test_stuck_counts_reports():
    run = HandMadeRun("stuck")
    run.recorder.emit(77, Kind.BUS, "bus", "stuck")
    assert run.summary() == (1, 77, 1, 1)


def span(tick: int, what: str, value: int, where: str = "dsp") -> Record:
    return Record(1, tick, Kind.SPAN, where, what, value, "", 0)


def test_a_span_is_measured_from_its_begin_to_its_end_in_each_unit():
    measure = make("span:model")
    assert measure.kinds == {Kind.SPAN}
    of = (
        span(100, "model", 1),
        span(110, "model", 1, "other"),
        span(150, "filter", 1),
        span(160, "filter", 0),
        span(300, "model", 0),
        span(510, "model", 0, "other"),
        span(600, "model", 0),  # an end without a begin
        span(700, "model", 1),  # not over yet
    )
    feed(measure, list(of))
    assert (measure.worst, measure.worst_at, measure.least, measure.count) == (400, 110, 200, 2)


@pytest.mark.parametrize(
    ("spans", "why"),
    [
        ((), "there was no span 'prase'; the run had no span"),
        (("parse", "reply"), "there was no span 'prase'; did you mean parse?"),
        (("reply", "store"), "there was no span 'prase'; the run had spans reply, store"),
        (("prase",), ""),
    ],
)
def test_a_missing_span_is_reported_with_the_spans_of_the_run(spans: tuple[str, ...], why: str):
    measure = make("span:prase")
    feed(measure, [span(number, name, 1) for number, name in enumerate(spans)])
    assert measure.missing() == why


@pytest.mark.parametrize("name", [*MEASURES, "span:model"])
def test_every_measure_is_described_and_begins_empty(name: str):
    run = HandMadeRun(name)
    assert name not in MEASURES or MEASURES[name].about.endswith(".")
    assert run.summary() == (0, NO_TIME, 0, 0)
    assert run.measure.unit in ("time", "count", "words", "bytes")
    assert (isinstance(run.measure, EventMeasure) and run.measure.counts) == (run.measure.unit == "count")


def test_an_unknown_measure_is_rejected():
    with pytest.raises(BadEvent, match="there is no measure 'latency'"):
        make("latency")


CELLS = 16


@given(
    st.lists(st.integers(-40, 40) | st.integers(-(10**6), 10**6), min_size=1, max_size=200),
    st.sampled_from([1, 500, 950, 990, 999, 1000]),
)
def test_a_percentile_is_a_measured_value_near_the_exact_one(values, per_mille: int):
    of = Tally(CELLS)
    for place, value in enumerate(values):
        of.add(value, 10 * place)
        assert len(of) <= CELLS
    exact = min(v for v in values if 1000 * sum(other <= v for other in values) >= per_mille * len(values))
    found, at = of.percentile(per_mille)
    assert at == 10 * values.index(found)
    width = 0 if len(set(values)) <= CELLS else 4 * (max(values) - min(values)) // CELLS
    assert exact <= found <= exact + width


def test_widely_spread_values_do_not_widen_the_cells_each_time():
    of = Tally(CELLS)
    for place in range(20 * CELLS):
        of.add(place, place)
    assert CELLS // 4 < len(of) <= CELLS
    assert of.percentile(500) == (191, 191)  # the largest value in the cell of 160 to 191
