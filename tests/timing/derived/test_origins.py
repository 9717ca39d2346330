"""The frame that the bytes of a read come from, for models run on random frames and for bytes of no frame.


frames  0   1   2   3        pin  _|~|___|~|__     a run of the models can skip frames, or use the last one again
runs      0   2   2 3
"""

from __future__ import annotations

from random import Random
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.bus.i2c.transfer import Phase, Transfer
from periph_sim.core.time import NO_TIME
from periph_sim.devices.host_frames import host_frames
from periph_sim.devices.sensor_rounds import register_bytes
from periph_sim.imu.host_frames import ramp, shown
from periph_sim.imu.model_codes import ModelCodes
from periph_sim.imu.models.parameters import AccelerometerParameters, ImuParameters
from periph_sim.imu.sensors import SENSORS as CHIP_DATA
from periph_sim.timing.derived.origins import BEFORE_ANY, KEPT, RECENT, FrameOrigins, ModelOrigins, Origin, Origins

GYROSCOPE, ACCELEROMETER, MAGNETOMETER = 0x68, 0x53, 0x1E
CHIPS = (GYROSCOPE, ACCELEROMETER, MAGNETOMETER)
PARAMETERS = ImuParameters(accelerometer=AccelerometerParameters(lever_arm=(0.1, 0.0, 0.2)))


def computed() -> ModelCodes:
    return ModelCodes(PARAMETERS, "float64", noise_seed=7)


class Bus:
    """Passes frames and reads to `origins`."""

    def __init__(self, origins: Origins) -> None:
        self.origins = origins

    def frame(self, number: int, values: tuple[int, ...]) -> None:
        self.origins.frame(number, values, 100 * number)

    def read(self, address: int, data: bytes) -> Origin | None:
        phase = Phase(address, read=True, count=len(data), acked=True, got=bytearray(data))
        self.origins.transfer(Transfer("chip", [phase]))
        return self.origins.of(phase)


class Models:
    """Firmware that runs its models on frames chosen by the test."""

    def __init__(self, origins: ModelOrigins) -> None:
        self._codes, self._pin = computed(), origins.model_pin
        self._shown, self._runs = self._codes.at_rest, 0
        self._pin(0, 0)  # high until the pin becomes an output
        self.data = dict.fromkeys(CHIPS, bytes(6))

    def run(self, values: tuple[int, ...] | None) -> None:
        """Run the models on the values of a frame; None if there was no frame, which leaves the models at rest."""
        self._pin(0, 1)
        shown = self._codes.run(self._runs, values or (0,) * 6, self._shown)
        self.data = {address: shown.data(address) for address in CHIPS}
        if values is not None:
            self._shown = shown
        self._runs += 1
        self._pin(0, 0)


def computing_unit() -> tuple[Bus, Models]:
    """The bus and the firmware of a unit that computes models, both observed by the same `ModelOrigins`."""
    origins = ModelOrigins(computed())
    return Bus(origins), Models(origins)


def moved(number: int) -> tuple[int, ...]:
    """Values of a frame, so different that no two frames and no two steps between frames give a chip the same codes."""
    n = number + 1
    return tuple(n * step + 3 * n * n for step in (60, 40, -150, 20, -90, 15))


def test_a_frame_is_recognized_by_its_values_in_the_byte_order_of_each_chip():
    bus = Bus(FrameOrigins(host_frames()))
    assert bus.read(GYROSCOPE, bytes(6)) == Origin(BEFORE_ANY, NO_TIME, bytes(6))
    bus.frame(4, (1, 2, 3, 4, 5, 6))
    assert bus.read(GYROSCOPE, bytes.fromhex("0001 0002 0003")) == Origin(4, 400, bytes.fromhex("000100020003"))
    assert bus.read(ACCELEROMETER, bytes.fromhex("0400 0500 0600")) == Origin(4, 400, bytes.fromhex("040005000600"))
    assert bus.read(MAGNETOMETER, bytes.fromhex("0001 0003 0002")) == Origin(4, 400, bytes.fromhex("000100030002"))
    assert bus.read(GYROSCOPE, bytes.fromhex("0001 0102 0003")) == Origin(None, NO_TIME, bytes.fromhex("000100020003"))
    assert bus.read(0x50, bytes(6)) is None


def test_equal_values_belong_to_the_newest_frame():
    bus = Bus(FrameOrigins(host_frames()))
    for number in (1, 2, 3):
        bus.frame(number, (7,) * 6)
    found = bus.read(ACCELEROMETER, bytes.fromhex("0700 0700 0700"))
    assert (found.frame, found.ended) == (3, 300)


def test_the_bytes_of_a_frame_are_computed_once_for_each_chip():
    """Each read is compared with all recent frames, but the bytes of a frame are computed only once."""
    made, kind = [], host_frames()
    counting = SimpleNamespace(ADDRESSES=kind.ADDRESSES, data=lambda *of: made.append(of) or kind.data(*of))
    bus = Bus(FrameOrigins(counting))
    for number in range(2 * RECENT):
        bus.frame(number, moved(number))
        for address in CHIPS:
            assert bus.read(address, b"no frame's") == bus.read(address, b"no frame's")
    assert len(made) == len(CHIPS) * 2 * RECENT


@given(st.lists(st.tuples(st.integers(1, 3), st.integers(0, 3)), min_size=1, max_size=12), st.integers(0, 6))
def test_every_read_of_computed_sensors_has_the_frame_that_the_models_used(turns: list[tuple[int, int]], choice: int):
    """turns: number of frames, and number of frames that the next run skips. After each run, some chips are read."""
    origins = ModelOrigins(computed())
    bus = Bus(origins)
    models, random = Models(origins), Random(choice)
    sent, taken = BEFORE_ANY, BEFORE_ANY
    for come, skipped in turns:
        for _ in range(come):
            sent += 1
            bus.frame(sent, moved(sent))
        is_first = taken == BEFORE_ANY  # all rates are 0 for any frame: only the attitude identifies it
        taken = max(taken, sent - skipped)
        models.run(moved(taken) if taken != BEFORE_ANY else None)
        for address in [MAGNETOMETER] if is_first else random.sample(CHIPS, random.randrange(1, 4)):
            found = bus.read(address, models.data[address])
            assert (found.frame, found.wanted) == (taken, models.data[address])


@pytest.mark.parametrize("address", CHIPS)
def test_models_run_on_values_of_no_frame_are_detected_and_later_frames_are_found_again(address: int):
    bus, models = computing_unit()
    for number in range(20):
        bus.frame(number, moved(number))
        models.run((9000, number, -9000, 800, number, 600) if 5 <= number < 9 else moved(number))
        found = bus.read(address, models.data[address])
        if 5 <= number < 9:
            assert found.frame is None and found.wanted != models.data[address]
        elif number >= 9 + 2:  # rates depend on two attitudes, accelerations on three
            assert (found.frame, found.ended) == (number, 100 * number)


def test_a_read_that_began_before_the_models_ended_can_have_the_values_of_the_run_before():
    bus, models = computing_unit()
    for number in range(3):
        bus.frame(number, moved(number))
        models.run(moved(number))
        before = models.data[GYROSCOPE]
        assert bus.read(GYROSCOPE, before) is not None
    bus.frame(3, moved(3))
    models.run(moved(3))
    for data, frame in ((before, 2), (models.data[GYROSCOPE], 3)):
        found = bus.read(GYROSCOPE, data)
        assert found.frame == frame


def test_after_a_reset_the_models_are_at_rest_and_noise_begins_with_its_first_sample():
    origins = ModelOrigins(computed())
    bus = Bus(origins)
    for _ in range(2):
        origins.reset()
        models = Models(origins)
        for number in range(5):
            bus.frame(number, moved(number))
            models.run(moved(number))
            found = bus.read(MAGNETOMETER, models.data[MAGNETOMETER])
            assert found.frame == number


@pytest.mark.parametrize(("frames", "taken"), [(4, 0), (5, 0), (40, 0), (40, 39), (KEPT, 0)])
def test_a_run_can_skip_any_number_of_frames_that_are_kept(frames: int, taken: int):
    bus, models = computing_unit()
    for number in range(frames):
        bus.frame(number, moved(number))
    models.run(moved(taken))
    found = bus.read(MAGNETOMETER, models.data[MAGNETOMETER])
    assert (found.frame, found.known, found.judged) == (taken, True, True)


def test_bytes_of_no_frame_are_not_judged_after_frames_or_chains_were_left_out():
    """They are wrong if nothing was left out."""
    for frames, runs, judged in ((KEPT - 1, 1, True), (2 * KEPT, 1, False), (20, 3, False)):
        bus, models = computing_unit()
        for number in range(frames):
            bus.frame(number, moved(number))
        for _ in range(runs):
            models.run(moved(frames - 1))
        found = bus.read(MAGNETOMETER, b"no one")
        assert (found.frame, found.judged) == (None, judged)
        found = bus.read(MAGNETOMETER, models.data[MAGNETOMETER])
        assert (found.frame, found.judged) == (frames - 1, True)
        found = bus.read(MAGNETOMETER, b"no one")
        assert found.judged  # the read before has determined the chain


def test_a_model_that_uses_a_frame_again_that_is_no_longer_kept_is_followed():
    bus, models = computing_unit()
    for number in range(3 * KEPT):
        bus.frame(number, moved(number))
        if number % KEPT == 0:
            models.run(moved(0))
            found = bus.read(MAGNETOMETER, models.data[MAGNETOMETER])
            assert found.frame == 0


def test_two_runs_without_a_read_between_them_can_each_use_any_frame():
    """The values of the second run depend on the frames of three runs, not of two."""
    for second in range(4):
        for third in range(second, 4):
            bus, models = computing_unit()
            for number in range(4):
                bus.frame(number, moved(number))
            for taken in (0, second, third):
                models.run(moved(taken))
            found = bus.read(ACCELEROMETER, models.data[ACCELEROMETER])
            assert (found.frame, found.judged) == (third, True)


@pytest.mark.parametrize("passed", [RECENT, 40, 700])
def test_a_chip_can_show_a_frame_after_any_number_of_others_but_not_an_older_one_afterwards(passed: int):
    bus = Bus(FrameOrigins(host_frames()))
    for number in range(passed + 2):
        bus.frame(number, ramp(number))
    first, second = (register_bytes(CHIP_DATA["gyroscope"], shown(ramp(n))["gyroscope"]) for n in range(2))
    for got in (second, second[:5]):
        assert bus.read(GYROSCOPE, got) == Origin(1, 100, second)
    gone_back = bus.read(GYROSCOPE, first)
    assert (gone_back.frame, gone_back.judged) == (None, True)


def test_zeros_of_a_chip_that_has_shown_no_frame_are_correct_at_first_and_later_not_judged():
    bus = Bus(FrameOrigins(host_frames()))
    for number in range(RECENT - 1):
        bus.frame(number, moved(number))
    assert bus.read(GYROSCOPE, bytes(6)) == Origin(BEFORE_ANY, NO_TIME, bytes(6))
    bus.frame(RECENT, moved(RECENT))
    assert bus.read(GYROSCOPE, bytes(6)) == Origin(BEFORE_ANY, NO_TIME, bytes(6), judged=False)
    assert bus.read(GYROSCOPE, register_bytes(CHIP_DATA["gyroscope"], shown(moved(1))["gyroscope"]))
    wrong = bus.read(GYROSCOPE, bytes(6))
    assert (wrong.frame, wrong.judged) == (None, True)


def test_a_chain_never_goes_back_to_an_older_frame():
    bus, models = computing_unit()
    for number in range(3):
        bus.frame(number, moved(number))
        models.run(moved(number))
        assert bus.read(GYROSCOPE, models.data[GYROSCOPE]) is not None
    models.run(moved(1))
    found = bus.read(GYROSCOPE, models.data[GYROSCOPE])
    assert found.frame is None


def test_the_expected_bytes_are_those_of_the_frame_with_most_equal_bytes():
    bus = Bus(FrameOrigins(host_frames()))
    bus.frame(1, (1, 2, 3, 4, 5, 6))
    bus.frame(2, (0x101, 0x202, 0x303, 4, 5, 6))
    for got, wanted in (
        ("0101 0202 0309", "0101 0202 0303"),
        ("0001 0002 0309", "0001 0002 0003"),
        ("0101 0002 0009", "0001 0002 0003"),
        ("0101 0002 0909", "0101 0202 0303"),  # three of each: the newer frame, which is compared first
        ("0909 0909 0909", "0101 0202 0303"),
    ):
        found = bus.read(GYROSCOPE, bytes.fromhex(got))
        assert found == Origin(None, NO_TIME, bytes.fromhex(wanted)), got
    part = bus.read(GYROSCOPE, bytes.fromhex("0001 0002"))  # an incomplete read
    assert (part.frame, part.wanted) == (1, bytes.fromhex("000100020003"))
