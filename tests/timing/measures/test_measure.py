"""Every measure with happenings made by hand: what it takes, what it leaves, when the worst was."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from periph_sim.bus.i2c.transfer import Phase, Transfer
from periph_sim.bus.receiver_listener import ReceiverListener
from periph_sim.core.records import Kind, Record
from periph_sim.core.time import NO_TIME
from periph_sim.devices.host_pc import ramp
from periph_sim.devices.sensor_rounds import Round
from periph_sim.timing.measures.bus import WrongBytes
from periph_sim.timing.measures.measure import Counter, Measure
from periph_sim.timing.measures.origins import RECENT, FrameOrigins, Origins
from periph_sim.timing.measures.registry import MEASURES, make
from tests.timing.events_by_hand import tell

GYRO, ACCEL, MAGNET, OTHER = 0x68, 0x53, 0x1E, 0x10


class Told:
    """What a scene is to a measure: who listens to what."""

    def __init__(self, name: str) -> None:
        self.transfers: list[Callable[[Transfer], None]] = []
        self.rounds: list[Callable[[Round], None]] = []
        self.frames: list[Callable[[int, tuple[int, ...], int], None]] = []
        self.stuck: list[Callable[[int], None]] = []
        self.sci: list[ReceiverListener] = []
        self.characters: list[Callable[[int], None]] = []
        self.due: list[Callable[[int], None]] = []
        self.missed: list[Callable[[int], None]] = []
        self.checked = True
        self.measure: Measure = make(name)
        self.measure.listen(self)

    def on_transfer(self, told: Callable[[Transfer], None]) -> None:
        self.transfers.append(told)

    def on_round(self, told: Callable[[Round], None]) -> None:
        self.rounds.append(told)

    def on_frame(self, told: Callable[[int, tuple[int, ...], int], None]) -> None:
        self.frames.append(told)

    def on_stuck(self, told: Callable[[int], None]) -> None:
        self.stuck.append(told)

    def on_sci(self, listener: ReceiverListener) -> None:
        self.sci.append(listener)

    def on_character(self, told: Callable[[int], None]) -> None:
        self.characters.append(told)

    def origins(self) -> Origins:
        return FrameOrigins(self)

    def checks_host(self) -> bool:
        return self.checked

    def on_round_due(self, told: Callable[[int], None]) -> None:
        self.due.append(told)

    def on_missed_round(self, told: Callable[[int], None]) -> None:
        self.missed.append(told)

    def host_values(self, number: int) -> tuple[int, ...]:
        return ramp(number)

    def transfer(self, *phases: Phase) -> None:
        for told in self.transfers:
            told(Transfer("chip", list(phases)))

    def is_due(self, due: int) -> None:
        for told in self.due:
            told(due)

    def misses(self, due: int) -> None:
        self.is_due(due)
        for told in self.missed:
            told(due)

    def round(self, due: int, end: int, nacked: int = 0) -> None:
        self.is_due(due)
        for told in self.rounds:
            told(Round(1, due, due, end, nacked))

    def character(self, tick: int, received: bool = True) -> None:
        for told in self.characters:
            told(tick)
        for listener in self.sci if received else []:
            listener.received(tick)

    def frame(self, number: int, tick: int) -> None:
        for told in self.frames:
            told(number, ramp(number), tick)

    def look(self, tick: int, words: int, overrun: bool = False) -> None:
        for listener in self.sci:
            listener.changed(tick, words, overrun)

    def came(self) -> tuple[int, int, int, int]:
        """worst, when, least, count"""
        m = self.measure
        return m.worst, m.worst_at, m.least, m.count


def read(address: int, got: bytes = b"", at: int = 0, **more: int) -> Phase:
    phase = Phase(address, read=True, count=len(got), acked=True, got=bytearray(got), start_at=at)
    for name, value in more.items():
        setattr(phase, name, value)
    return phase


def wrote(address: int, at: int = 0, acked: bool = True) -> Phase:
    return Phase(address, read=False, start_at=at, acked=acked)


def test_response_is_from_the_scl_fall_after_the_ack_to_the_rise_for_the_first_data_bit():
    told = Told("response")
    told.transfer(wrote(GYRO), read(GYRO, answer_from=100, answer_at=180))
    told.transfer(read(GYRO, answer_from=500, answer_at=530))
    told.transfer(read(GYRO, answer_from=900, answer_at=NO_TIME))  # never answered
    told.transfer(Phase(GYRO, read=False, answer_from=1000, answer_at=5000))  # a write
    assert told.came() == (80, 100, 30, 2)


def test_stretch_is_the_longest_of_each_acknowledged_phase():
    told = Told("stretch")
    told.transfer(read(GYRO, at=10, stretch=7), read(GYRO, at=20, stretch=0))
    told.transfer(Phase(GYRO, read=True, start_at=30, stretch=99))  # not acknowledged
    assert told.came() == (7, 10, 0, 2)


def test_round_is_from_when_it_was_due_to_its_last_stop():
    told = Told("round")
    told.round(1000, 1500)
    told.round(3000, 3700)
    assert told.came() == (700, 3000, 500, 2)


def test_missed_rounds_are_counted_from_the_first_one_on():
    told = Told("missed rounds")
    assert told.came() == (0, NO_TIME, 0, 0)
    for due in (9, 29, 49):
        told.misses(due)
    assert told.came() == (3, 9, 3, 3)


def test_nacked_rounds_counts_rounds_not_requests():
    told = Told("nacked rounds")
    told.round(10, 20)
    told.round(30, 40, nacked=3)
    told.round(50, 60, nacked=1)
    assert told.came() == (2, 30, 2, 2)


def test_nacked_counts_requests_whose_address_nobody_acknowledged():
    told = Told("nacked")
    told.transfer(wrote(GYRO), read(GYRO, at=5))
    told.transfer(wrote(GYRO, at=40, acked=False))
    told.transfer(wrote(GYRO, at=70), Phase(GYRO, read=True, start_at=75))
    assert told.came() == (2, 40, 2, 2)


def test_a_request_that_never_reached_the_wire_is_not_counted_as_nacked():
    told = Told("nacked")
    told.transfer(wrote(GYRO, at=NO_TIME, acked=False))
    assert told.measure.count == 0


def gyro_bytes(number: int) -> bytes:
    return b"".join(v.to_bytes(2, "big", signed=True) for v in ramp(number)[0:3])


def magnet_bytes(number: int) -> bytes:
    x, y, z = ramp(number)[0:3]
    return b"".join(v.to_bytes(2, "big", signed=True) for v in (x, z, y))


def accel_bytes(number: int) -> bytes:
    return b"".join(v.to_bytes(2, "little", signed=True) for v in ramp(number)[3:6])


@pytest.mark.parametrize(
    ("address", "data"), [(GYRO, gyro_bytes(2)), (ACCEL, accel_bytes(2)), (MAGNET, magnet_bytes(2))]
)
def test_bytes_of_a_recent_frame_are_right_in_each_chips_own_order(address: int, data: bytes):
    told = Told("wrong bytes")
    told.transfer(read(address, bytes(6)))  # before the first frame every chip shows zeros
    for n in range(4):
        told.frame(n, n * 100)
    told.transfer(read(address, data))
    assert (told.measure.worst, told.measure.count) == (0, 12)


def test_a_byte_that_is_not_in_its_frame_is_counted_and_named():
    told = Told("wrong bytes")
    told.frame(2, 100)
    data = bytearray(gyro_bytes(2))
    data[0] ^= 0x10
    told.transfer(read(GYRO, bytes(data), at=300))
    told.transfer(read(GYRO, bytes(data), at=700))
    assert told.came() == (2, 300, 2, 12)
    assert isinstance(told.measure, WrongBytes) and told.measure.where == {"chip byte 0": 2}


def test_a_frame_long_gone_does_not_excuse_old_bytes():
    told = Told("wrong bytes")
    for n in range(1, 2 + RECENT):
        told.frame(n, n)
    told.transfer(read(GYRO, gyro_bytes(2)))
    assert told.measure.worst == 0
    told.transfer(read(GYRO, gyro_bytes(1)))
    assert told.measure.worst > 0


def test_bytes_mixed_from_two_frames_are_wrong_where_they_differ_from_the_nearest():
    told = Told("wrong bytes")
    told.frame(1, 1)
    told.frame(2, 2)
    told.transfer(read(GYRO, gyro_bytes(1)[:4] + gyro_bytes(2)[4:]))
    differ = sum(a != b for a, b in zip(gyro_bytes(1)[4:], gyro_bytes(2)[4:], strict=True))
    assert told.measure.worst == differ > 0


def test_expected_bytes_of_the_request_go_before_frames():
    told = Told("wrong bytes")
    phase = read(OTHER, b"\x01\x02\x03", at=9)
    phase.expect = b"\x01\xff\x03"
    told.transfer(phase)
    assert told.came() == (1, 9, 1, 3)


def test_of_a_chip_nobody_knows_nothing_is_expected_and_nothing_compared():
    told = Told("wrong bytes")
    told.transfer(read(OTHER, b"\x01\x02"))
    assert told.measure.count == 0


def test_known_chips_are_compared_with_frames_only_where_the_case_says_so():
    told = Told("wrong bytes")
    told.checked = False
    told.measure.listen(told)
    del told.transfers[:-1]
    told.transfer(read(GYRO, b"\x01\x02"))
    assert told.measure.count == 0


def test_fifo_high_water_is_the_most_words_that_waited():
    told = Told("fifo high-water")
    for tick, words in ((10, 1), (20, 2), (30, 0), (40, 5), (50, 4)):
        told.look(tick, words)
    assert told.came() == (5, 40, 0, 5)


def test_overruns_are_counted_as_they_happen():
    told = Told("overruns")
    told.look(10, 16)
    told.look(20, 16, overrun=True)
    told.look(30, 15)
    told.look(40, 16, overrun=True)
    assert told.came() == (2, 20, 2, 2)


def test_stuck_counts_reports():
    told = Told("stuck")
    for heard in told.stuck:
        heard(77)
    assert told.came() == (1, 77, 1, 1)


def span(tick: int, what: str, value: int, where: str = "dsp") -> Record:
    return Record(1, tick, Kind.SPAN, where, what, value, "", 0)


def test_span_is_from_its_begin_to_its_end_unit_by_unit():
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
    tell(measure, list(of))
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
def test_a_span_that_never_was_is_told_with_those_that_were(spans: tuple[str, ...], why: str):
    measure = make("span:prase")
    tell(measure, [span(number, name, 1) for number, name in enumerate(spans)])
    assert measure.missing() == why


@pytest.mark.parametrize("name", [*MEASURES, "span:model"])
def test_every_measure_says_what_it_measures_and_begins_empty(name: str):
    told = Told(name)
    assert (told.measure.__doc__ or "").strip()
    assert told.came() == (0, NO_TIME, 0, 0)
    assert told.measure.unit in ("time", "count", "words", "bytes")
    assert isinstance(told.measure, Counter) == (told.measure.unit == "count")


def test_an_unknown_measure_is_a_key_error():
    with pytest.raises(KeyError):
        make("latency")
