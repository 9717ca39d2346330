"""ADXL345 over the bus: formats, rates, DATA_READY, Overrun, the FIFO's four modes, and the open questions.

Source: ADXL345 data sheet Rev 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import pytest

from periph_sim.bus.i2c.transfer import BusTiming
from periph_sim.devices.chips.adxl345 import Adxl345, Adxl345Options, Fifo
from tests.devices.bench import MS, SECOND, TIMEBASE, US, Bench, steady

BW_RATE, POWER_CTL, INT_ENABLE, INT_SOURCE, DATA_FORMAT, DATA = 0x2C, 0x2D, 0x2E, 0x30, 0x31, 0x32
FIFO_CTL, FIFO_STATUS = 0x38, 0x39
READY, WATERMARK, OVERRUN = 0x80, 0x02, 0x01
MEASURE, SLEEP = 0x08, 0x04
FIRST = 11_100 * US  # the first sample at 100 Hz: one period and 1.1 ms
PERIOD = 10 * MS


class Counter:
    """A source that gives 1, 2, 3 ... LSB on x, one more at each call. asked: the tick of each call."""

    def __init__(self) -> None:
        self.asked: list[int] = []

    def __call__(self, tick: int) -> Sequence[Fraction]:
        self.asked.append(tick)
        return Fraction(len(self.asked), 256), Fraction(0), Fraction(-1)


def words(data: bytes) -> list[int]:
    return [int.from_bytes(data[i : i + 2], "little", signed=True) for i in range(0, len(data), 2)]


def measuring(*g: float, data_format: int = 0x08, **more: object) -> Bench:
    bench = Bench(Adxl345(TIMEBASE, steady(*g), **more))
    bench.write(DATA_FORMAT, data_format)
    bench.write(POWER_CTL, MEASURE)
    bench.wait(20 * MS)
    return bench


def counting(fifo_ctl: int, **options: object) -> tuple[Bench, Adxl345]:
    """A chip that measures at 100 Hz from the start of the test, with the number of samples so far as its value."""
    chip = Adxl345(TIMEBASE, Counter(), options=Adxl345Options(**options))
    bench = Bench(chip)
    chip.write(SECOND, DATA_FORMAT, 0x0B)
    chip.write(SECOND, FIFO_CTL, fifo_ctl)
    chip.write(SECOND, POWER_CTL, MEASURE)
    return bench, chip


def after(samples: int) -> int:
    """A tick between sample `samples` and the next one."""
    return SECOND + FIRST + (samples - 1) * PERIOD + PERIOD // 2


@pytest.mark.parametrize(("address", "other"), [(0x53, 0x1D), (0x1D, 0x53)])
def test_it_acknowledges_its_address_and_no_other(address: int, other: int):
    chip = Adxl345(TIMEBASE, steady(0, 0, 0), address)
    bench = Bench(chip)
    assert bench.read(0x00) == b"\xe5"
    chip.address = other
    assert bench.write(0x1D) is True
    chip.address = address
    # Bench addresses this chip, which is not on the bus.
    bench.chips = (Adxl345(TIMEBASE, steady(0, 0, 0), other),)
    assert bench.write(0x00) is False


def test_in_standby_nothing_is_measured():
    bench = Bench(Adxl345(TIMEBASE, steady(1, 1, 1)))
    assert bench.read(DATA, 6) == bytes(6)
    assert not bench.read(INT_SOURCE)[0] & READY


def test_x_y_z_are_sent_low_byte_first_with_256_lsb_per_g():
    assert measuring(0.25, -0.5, 1).read(DATA, 6).hex(" ") == "40 00 80 ff 00 01"


@pytest.mark.parametrize("span", [0, 1, 2, 3])
@pytest.mark.parametrize("full", [False, True])
def test_scale_bits_and_saturation_of_every_range(span: int, full: bool):
    """At full resolution 256 LSB/g and 10 to 13 bits, otherwise 10 bits and 256, 128, 64 or 32 LSB/g."""
    most = 512 << span if full else 512
    per_g = 256 if full else 256 >> span
    bench = measuring(1.5, 100, -100, data_format=span | full << 3)
    assert words(bench.read(DATA, 6)) == [per_g * 3 // 2, most - 1, -most]


@pytest.mark.parametrize(("data_format", "x"), [(0x04, 0x4000), (0x0C, 0x4000), (0x0F, 0x0800), (0x07, 0x0800)])
def test_justify_shifts_the_bits_to_the_left(data_format: int, x: int):
    """1 g is 256 << 6 with 10 bits at 2 g, 256 << 3 with 13 bits at 16 g, and 32 << 6 with 10 bits at 16 g."""
    assert words(measuring(1, 0, 0, data_format=data_format).read(DATA, 2)) == [x]


def test_offsets_are_added_in_steps_of_4_lsb_at_full_resolution():
    bench = measuring(0, 0, 0)
    bench.write(0x1E, 0x01, 0xFF, 0x7F)
    bench.wait(20 * MS)
    assert words(bench.read(DATA, 6)) == [4, -4, 508]


def test_halves_are_rounded_to_the_even_number():
    assert words(measuring(0.5 / 256, 1.5 / 256, -0.5 / 256).read(DATA, 6)) == [0, 2, 0]


@pytest.mark.parametrize(
    ("code", "hertz"),
    [(0xF, 3200), (0xE, 1600), (0xD, 800), (0xC, 400), (0xB, 200), (0xA, 100), (9, 50), (8, 25), (7, 12.5), (6, 6.25)],
)
def test_the_first_sample_is_a_period_and_1100_us_after_measure_and_then_one_each_period(code: int, hertz: float):
    source = Counter()
    chip = Adxl345(TIMEBASE, source)
    chip.write(0, BW_RATE, code)
    chip.write(0, POWER_CTL, MEASURE)
    period = Fraction(SECOND) / Fraction(hertz)
    first = -(-(period + 1100 * US) // 1)
    chip.read(first - 1, INT_SOURCE)
    assert source.asked == []
    for number in range(5):
        chip.read(first + int(number * period), INT_SOURCE)
    assert source.asked == [first + int(number * period) for number in range(5)]


def test_rates_do_not_drift():
    source = Counter()
    chip = Adxl345(TIMEBASE, source)
    chip.write(0, BW_RATE, 0xF)
    chip.write(0, POWER_CTL, MEASURE)
    month = 30 * 24 * 3600 * SECOND
    chip.read(month, INT_SOURCE)
    assert (source.asked[-1] - source.asked[0]) % 312_500 == 0
    assert month - source.asked[-1] < 312_500 and len(source.asked) < 100, "unobservable samples are skipped"


def test_data_ready_is_set_by_a_sample_and_cleared_by_reading_it():
    bench, _ = counting(0)
    bench.kernel.run_until(SECOND + FIRST - 100 * US)
    assert bench.read(INT_SOURCE)[0] == WATERMARK
    bench.kernel.run_until(after(1))
    assert bench.read(INT_SOURCE)[0] == READY | WATERMARK
    assert words(bench.read(DATA, 6)) == [1, 0, -256]
    assert bench.read(INT_SOURCE)[0] == WATERMARK
    assert words(bench.read(DATA, 2)) == [1], "the last sample is still in the registers"


def test_overrun_is_set_when_an_unread_sample_is_replaced():
    bench, _ = counting(0)
    bench.kernel.run_until(after(2))
    assert bench.read(INT_SOURCE)[0] == READY | WATERMARK | OVERRUN
    assert words(bench.read(DATA, 2)) == [2]
    assert bench.read(INT_SOURCE)[0] == WATERMARK


def test_the_six_bytes_of_a_burst_belong_to_one_sample():
    """At 3200 Hz and 10 kHz SCL a burst lasts 20 samples."""
    chip = Adxl345(TIMEBASE, lambda tick: (Fraction(tick // 1000 % 512, 256),) * 3)
    chip.write(0, DATA_FORMAT, 0x0B)
    chip.write(0, BW_RATE, 0xF)
    chip.write(0, POWER_CTL, MEASURE)
    slow = Bench(chip, timing=BusTiming(50 * US, 50 * US, 300, 50 * US, 50 * US, 50 * US, 50 * US))
    x, y, z = words(slow.read(DATA, 6))
    assert x == y == z
    assert words(slow.read(DATA, 6))[0] != x


def test_the_pointer_is_kept_over_a_stop_and_a_repeated_start():
    bench = measuring(0.25, -0.5, 1)
    assert bench.read(DATA, 6, by_stop=True) == bench.read(DATA, 6)
    bench.write(DATA)
    assert bench.read_on(2) + bench.read_on(2) == bench.read(DATA, 4), "a read continues where the last one ended"


# FIFO ------------------------------------------------------------------------------


def test_an_empty_fifo_gives_six_zeros():
    assert Fifo(overrun_when_filled=True).latch() == bytes(6)


def test_fifo_mode_keeps_the_first_33_and_stops():
    bench, chip = counting(0x40 | 10)
    bench.kernel.run_until(after(9))
    assert bench.read(INT_SOURCE)[0] == READY
    bench.kernel.run_until(after(10))
    assert bench.read(INT_SOURCE)[0] == READY | WATERMARK and bench.read(FIFO_STATUS)[0] == 10
    bench.kernel.run_until(after(60))
    assert bench.read(FIFO_STATUS)[0] == 32
    assert bench.read(INT_SOURCE)[0] == READY | WATERMARK | OVERRUN
    chip.write(bench.kernel.now, POWER_CTL, 0)  # standby does not empty the FIFO
    assert [words(bench.read(DATA, 6))[0] for _ in range(34)] == [*range(1, 34), 33]
    assert bench.read(FIFO_STATUS)[0] == 0 and not bench.read(INT_SOURCE)[0] & READY


@pytest.mark.parametrize("mode", [0x80, 0xC0])  # in trigger mode, no trigger occurs
def test_stream_and_trigger_mode_keep_the_last_33(mode: int):
    bench, chip = counting(mode | 10)
    bench.kernel.run_until(after(50))
    chip.read(bench.kernel.now, INT_SOURCE)
    chip.write(bench.kernel.now, POWER_CTL, 0)
    assert [words(bench.read(DATA, 6))[0] for _ in range(33)] == [*range(18, 51)]


def test_bypass_empties_the_fifo():
    bench, _ = counting(0x40)
    bench.kernel.run_until(after(5))
    assert bench.read(FIFO_STATUS)[0] == 5
    bench.write(FIFO_CTL, 0x00)
    assert bench.read(FIFO_STATUS)[0] == 0


@pytest.mark.parametrize("mode", [0x00, 0x40, 0x80, 0xC0])
def test_overrun_is_cleared_only_by_a_change_of_the_mode(mode: int):
    for written, kept in ((mode | 9, True), (mode ^ 0x40, False)):
        _, chip = counting(mode | 4)
        assert chip.read(after(60), INT_SOURCE) & OVERRUN
        chip.write(after(60), FIFO_CTL, written)
        assert chip.read(after(60), INT_SOURCE) & OVERRUN == kept


def test_a_burst_of_fewer_bytes_loses_the_rest_of_its_sample():
    bench, _ = counting(0x40)
    bench.kernel.run_until(after(3))
    assert words(bench.read(DATA, 2)) == [1]
    assert bench.read(FIFO_STATUS)[0] == 2
    assert words(bench.read(DATA, 6)) == [2, 0, -256]


def test_sleep_stops_the_samples():
    bench, _ = counting(0x40)
    bench.kernel.run_until(after(3))
    bench.write(POWER_CTL, MEASURE | SLEEP)
    bench.kernel.run_until(after(30))
    assert bench.read(FIFO_STATUS)[0] == 3


@pytest.mark.parametrize(
    ("number", "value", "code", "what"),
    [
        (BW_RATE, 0x1F, "duty", "LOW_POWER is set with rate code 0xf"),
        (INT_ENABLE, 0x40, "unknown", "taps, activity, inactivity and free fall are not detected"),
        (DATA_FORMAT, 0x80, "unknown", "SELF_TEST"),
        (POWER_CTL, 0x10, "unknown", "AUTO_SLEEP"),
    ],
)
def test_settings_that_are_not_modelled_or_allowed_leave_a_note(number: int, value: int, code: str, what: str):
    bench = Bench(Adxl345(TIMEBASE, steady(0, 0, 0)))
    bench.write(number, value)
    (note,) = bench.chips[0].notes
    assert note.code == code and what in note.text and note.source.startswith("ADXL345 Rev 0")


def test_modelled_settings_leave_no_note():
    """Measure, sleep and each wake-up rate; low power at the ends of its rates."""
    bench = Bench(Adxl345(TIMEBASE, steady(0, 0, 0)))
    for number, value in ((POWER_CTL, 0x0F), (POWER_CTL, 0x08), (BW_RATE, 0x0F), (BW_RATE, 0x17), (BW_RATE, 0x1C)):
        bench.write(number, value)
    assert not bench.chips[0].notes


def test_a_source_that_gives_nan_is_rejected():
    with pytest.raises(ValueError, match="source gave nan"):
        Adxl345(TIMEBASE, lambda tick: (float("nan"), 0, 0)).formatted((float("nan"), 0, 0))


# Open questions of the data sheet -----------------------------------------------------------


@pytest.mark.parametrize(("answer", "following"), [("goes_on", 0x3A), ("wraps_to_0", 0x00), ("stays", 0x39)])
def test_open_pointer_past_end(answer: str, following: int):
    bench = Bench(Adxl345(TIMEBASE, steady(0, 0, 0), options=Adxl345Options(pointer_past_end=answer)))
    bench.write(FIFO_CTL, 0x05)
    expected = {"goes_on": "05 00 00 00", "wraps_to_0": "05 00 e5 00", "stays": "05 00 00 00"}[answer]
    assert bench.read(FIFO_CTL, 2).hex(" ") == "05 00" and bench.pointers[0].pointer == following
    assert bench.read(FIFO_CTL, 4).hex(" ") == expected
    assert "pointer_past_end" in bench.chips[0].touched


@pytest.mark.parametrize(("answer", "next_sample"), [("restarts", 5 * MS), ("after_next_sample", 10 * MS - 1)])
def test_open_rate_change(answer: str, next_sample: int):
    source = Counter()
    chip = Adxl345(TIMEBASE, source, options=Adxl345Options(rate_change=answer))
    chip.write(0, POWER_CTL, MEASURE)
    changed = FIRST + 1
    chip.write(changed, BW_RATE, 0xB)  # 200 Hz
    chip.read(60 * MS, INT_SOURCE)
    assert source.asked[1] == changed + next_sample
    assert source.asked[2] - source.asked[1] == 5 * MS
    assert "rate_change" in chip.touched


@pytest.mark.parametrize(("answer", "at"), [("when_filled", 32), ("when_lost", 34)])
def test_open_overrun_in_fifo(answer: str, at: int):
    _, chip = counting(0x40, overrun_in_fifo=answer)
    assert not chip.read(after(at - 1), INT_SOURCE) & OVERRUN
    assert chip.read(after(at), INT_SOURCE) & OVERRUN
    assert "overrun_in_fifo" in chip.touched


@pytest.mark.parametrize("most", [32, 33])
def test_open_entries_most(most: int):
    _, chip = counting(0x40, entries_most=most)
    assert chip.read(after(40), FIFO_STATUS) == most
    assert "entries_most" in chip.touched
