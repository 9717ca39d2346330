"""Measures of transfers, rounds and values on hand-made runs: where they begin, end and count."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.bus.i2c.transfer import Phase, Transfer
from periph_sim.core.records import Kind, Record, Recorder
from periph_sim.core.time import NO_TIME
from periph_sim.imu.sensors import SENSORS as CHIPS
from periph_sim.timing.derived.error_records import RECENT, ErrorRecords
from periph_sim.timing.derived.transfer_records import begin_of
from periph_sim.timing.measures.factory import measure_named
from periph_sim.timing.measures.measure import MILLIONTHS
from tests.timing.events_by_hand import ONE, feed, make, played, records, scene_of
from tests.timing.measures.hand_made_run import GYRO, OTHER, HandMadeRun, read, wrote

# Transfers ------------------------------------------------------------------------------------------------------------


def test_a_phase_that_never_began_has_the_begin_of_its_transfer():
    refused, asked = wrote(GYRO, at=40, acked=False), Phase(GYRO, read=True)
    transfer = Transfer("chip", [refused, asked])
    assert (begin_of(transfer, refused), begin_of(transfer, asked)) == (40, 40)
    assert begin_of(Transfer("chip", [refused, read(GYRO, at=55)]), read(GYRO, at=55)) == 55


@pytest.mark.parametrize(
    ("since", "said", "worst"),
    [(NO_TIME, "", (7, 10)), (50, "SCL was still held low when the run ended", (30, 50)), (73, "", (7, 10))],
)
def test_scl_held_at_the_end_of_the_run_counts_with_its_time_so_far(since: int, said: str, worst: tuple[int, int]):
    run = HandMadeRun("stretch")
    run.transfer(read(GYRO, at=10, stretch=7))
    run.finish(80, held_since=since)
    assert run.measure.close(80) == said and (run.measure.worst, run.measure.worst_at) == worst


def test_a_refused_request_counts_even_without_a_stop():
    run = HandMadeRun("nacked")
    run.transfer(wrote(GYRO, at=10, acked=False))
    run.finish(80, Transfer("chip", [wrote(GYRO, at=40, acked=False)]))
    assert run.summary() == (2, 10, 2, 2)
    answered = HandMadeRun("nacked")
    answered.finish(80, Transfer("chip", [wrote(GYRO, at=40)]))
    assert answered.measure.count == 0


def test_the_first_wrong_read_is_reported_and_wrong_bytes_are_counted():
    run = HandMadeRun("wrong bytes")
    for got, expected in ((b"\x01\x02", b"\x01\x02"), (b"\x01\x09\x05", b"\x01\x02\x07"), (b"\x08\x09", b"\x01\x09")):
        phase = read(OTHER, got, at=100 + got[0])
        phase.expect = expected
        run.transfer(phase)
    assert run.bytes.first_wrong == "chip read 01 09 05 where 01 02 07 was expected"
    assert run.bytes.wrong_places == {"chip byte 1": 1, "chip byte 2": 1, "chip byte 0": 1}
    assert run.summary() == (3, 101, 3, 7)


@pytest.mark.parametrize(
    ("got", "expected", "asked", "wrong", "compared", "occasions"),
    [
        (b"\x01", b"\x01\x02", 2, 0, 1, 2),  # incomplete: one of two bytes is compared
        (b"\x01\x02\x03", b"\x01\x02", 2, 0, 2, 3),
        (b"", b"\x01", 1, 0, 0, 1),
        (b"\x02", b"", 1, 0, 0, 1),
    ],
)
def test_bytes_are_compared_up_to_the_shorter_length(
    got: bytes, expected: bytes, asked: int, wrong: int, compared: int, occasions: int
):
    run = HandMadeRun("wrong bytes")
    phase = Phase(OTHER, read=True, count=asked, acked=True, got=bytearray(got), start_at=5)
    phase.expect = expected
    run.transfer(phase)
    assert (run.measure.worst, run.measure.count, run.measure.occasions) == (wrong, compared, occasions)


# Rounds ---------------------------------------------------------------------------------------------------------------


def test_a_round_is_measured_from_its_begin_and_slack_from_its_end():
    run = HandMadeRun("round")
    run.round(1000, 1500, start=1100)
    assert run.summary() == (400, 1100, 400, 1)
    run = HandMadeRun(measure_named("slack", ONE), period=2000)
    run.round(1000, 1500)
    run.round(3000, 5001)
    slack = run.measure
    assert (slack.worst, slack.worst_at, slack.least, slack.least_at) == (1500, 1500, -1, 5001)


@pytest.mark.parametrize(("not_before", "measured", "occasions"), [(0, 3, 3), (10, 3, 3), (11, 2, 2), (51, 0, 0)])
def test_rounds_are_counted_from_not_before(not_before: int, measured: int, occasions: int):
    run = HandMadeRun("nacked rounds")
    run.measure.not_before = not_before
    for due in (10, 30, 50):
        run.round(due, due + 5)
    run.finish(60)
    assert (run.measure.measured, run.measure.occasions) == (measured, occasions)


# Spans and states -----------------------------------------------------------------------------------------------------


def test_an_unfinished_span_counts_with_its_time_so_far_in_each_unit():
    measure = make("span:model")
    feed(measure, records("10 span dsp model 1\n15 span dsp model 0\n20 span imu model 1\n30 span dsp model 1"))
    assert sorted(measure.unfinished(100)) == [(70, 30), (80, 20)]
    assert measure.close(100) == "span 'model' still lasted when the run ended"
    assert (measure.worst, measure.worst_at, measure.least, measure.count) == (80, 20, 5, 3)


@pytest.mark.parametrize(
    ("text", "there", "holds"),
    [
        ("wire SCL high", {"level": 1}, True),
        ("wire SCL high", {"level": 0}, False),
        ("wire SCL low", {"level": 0}, True),
        ("flag I2C-A.I2CSTR.AAS = 1", {"value": 1}, True),
        ("flag I2C-A.I2CSTR.AAS = 1", {"value": 0}, False),
        ("bus busy", {}, False),
        ("bus free", {}, True),
        ("interrupt SCIRXINTA", {}, False),
        ("model", {}, False),
    ],
)
def test_states_at_the_begin_of_the_run(text: str, there: dict[str, object], holds: bool):
    assert measure_named(f"time in {text}", ONE).state.holds(scene_of(**there)) == holds


def test_a_sum_is_one_number_with_the_time_of_the_first_begin():
    measure = played("time in wire SCL low", "10 edge SCL level 0\n16 edge SCL level 1\n20 edge SCL level 0", 25)
    measure.finish(90)  # a second finish has no effect
    assert not measure.series
    assert (measure.worst, measure.worst_at, measure.least, measure.least_at, measure.count) == (11, 10, 11, 10, 2)


# Pairs ----------------------------------------------------------------------------------------------------------------


def test_ambiguous_pairs_are_reported_with_times_from_the_begin_of_the_run():
    of = "100 edge SCL level 1\n350 edge SCL level 1\n360 edge SCL level 1\n400 edge SDA level 1"
    measure = played("from edge SCL rise to edge SDA rise", of, began=50, ticks_per_second=1000)
    assert measure.missing() == (
        "'edge SCL rise' came at 0.050000 s and again at 0.300000 s before 'edge SDA rise'; "
        "add after a comma which belong together: in order, next or last"
    )


@pytest.mark.parametrize(("not_before", "measured", "occasions"), [(0, 2, 3), (11, 2, 3), (12, 1, 2), (52, 0, 0)])
def test_transfers_are_counted_from_not_before(not_before: int, measured: int, occasions: int):
    measure = measure_named("from edge SCL rise to edge SDA rise, same transfer", ONE)
    measure.listen(scene_of())
    measure.not_before = not_before
    of = "10 bus c START 0\n11 edge SCL level 1\n12 edge SDA level 1\n15 bus c STOP 0\n"
    of += "30 bus c START 0\n31 edge SCL level 1\n35 bus c STOP 0\n"
    of += "50 bus c START 0\n51 edge SCL level 1\n52 edge SDA level 1\n55 bus c STOP 0\n"
    feed(measure, records(of))
    measure.finish(60)
    assert (measure.measured, measure.occasions) == (measured, occasions)
    assert measure.asked == "transfers with 'edge SCL rise'"


# Values ---------------------------------------------------------------------------------------------------------------


class Samples:
    """Reads after `frames` host frames, and the measure of their errors.

    The truth of the gyroscope at tick t is (t, -t, 0) hundredths of an LSB; frame n was due at 100 n.
    """

    def __init__(self, text: str, frames: int = 1) -> None:
        recorder = Recorder()
        self.measure = measure_named(text, ONE)
        self.measure.subscribe(recorder)
        self.measure.keep()
        self.errors = ErrorRecords(
            recorder,
            lambda tick: dict.fromkeys(CHIPS, (tick / 100, -tick / 100, 0.0)),
            lambda number: 100 * number,
        )
        for number in range(frames):
            self.errors.frame(number + 1, (0,) * 6, 0)

    def read(self, *phases: Phase) -> None:
        self.errors.transfer(Transfer("gyroscope", list(phases)))

    def values(self) -> list[int]:
        return self.measure.all_kept()[0].tolist()


def sample(*values: int) -> bytes:
    return b"".join(value.to_bytes(2, "big", signed=True) for value in values)


def test_the_error_of_a_value_is_that_of_its_worst_axis_at_the_first_data_bit():
    samples = Samples("value error")
    for answer_at, values in ((200, (2, -2, 0)), (350, (3, -3, 0)), (400, (4, -1, 0)), (500, (5, -5, -7))):
        samples.read(read(GYRO, sample(*values), at=answer_at - 20, answer_at=answer_at))
    measure = samples.measure
    assert samples.values() == [0, MILLIONTHS // 2, 3 * MILLIONTHS, 7 * MILLIONTHS]
    assert measure.all_kept()[1].tolist() == [180, 330, 380, 480] and measure.occasions == 4


@given(st.integers(1, 12), st.integers(0, 14))
def test_the_error_at_the_frame_is_the_smallest_over_recent_frames_and_those_since_the_last_read(
    frames: int, carried: int
):
    samples = Samples("value error at frame", frames)
    for at in (2000, 2100):  # at the second read, the best frame of the first one is known
        samples.read(read(GYRO, sample(carried, -carried, 0), at=at, answer_at=at + 20))
        assert samples.measure.worst == min(abs(carried - number) for number in range(1, frames + 1)) * MILLIONTHS
    samples.read(read(GYRO, sample(1, -1, 0), at=2200, answer_at=2220))
    fitted = min(range(1, frames + 1), key=lambda number: (abs(carried - number), -number))
    oldest = min(fitted, max(frames - RECENT, 0) + 1)
    assert samples.values()[-1] == (oldest - 1) * MILLIONTHS


def test_reads_that_have_a_value():
    samples = Samples("value error of gyroscope")
    bytes_ = sample(2, -2, 0)
    transfers = (
        [read(GYRO, bytes_, at=180, answer_at=200)],
        [read(0x53, bytes_, at=280, answer_at=300)],  # another chip
        [read(GYRO, bytes_[:4], at=380, answer_at=400)],  # incomplete: an occasion without a value
        [wrote(GYRO, at=480)],
        [wrote(GYRO, at=580, acked=False), Phase(GYRO, read=True, count=6)],
    )
    for phases in transfers:
        samples.read(*phases)
    measure = samples.measure
    assert (measure.count, measure.occasions) == (1, 3)
    before = Samples("value error", frames=0)
    before.read(*transfers[0])
    early = before.measure
    assert (early.count, early.occasions) == (0, 0)
    assert (
        early.missing()
        == "no sample of gyroscope or accelerometer or magnetometer was read after a host frame had come"
    )
    assert measure.missing() == "no sample of gyroscope was read after a host frame had come"


def test_records_of_another_unit_do_not_affect_the_load_of_a_cpu():
    events = [(10, "imu", Kind.WAIT, 1), (20, "dsp", Kind.WAIT, 1), (30, "imu", Kind.IRQ, 1), (40, "dsp", Kind.WAIT, 0)]
    of = [Record(0, tick, kind, where, "x", value, "", 0) for tick, where, kind, value in events]
    assert played("cpu load of dsp", of, 100).worst == 80 * MILLIONTHS // 100
