"""HMC5883L over the bus: modes, rates, gain, overflow, averages, RDY, LOCK, the pointer, and the open questions.

Source: Honeywell HMC5883L data sheet.
"""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.devices.chips.hmc5883l import Hmc5883l, Hmc5883lOptions
from tests.devices.bench import MS, SECOND, TIMEBASE, US, Asked, Bench, steady, words

CRA, CRB, MODE, DATA, STATUS, ID = 0x00, 0x01, 0x02, 0x03, 0x09, 0x0A
CONTINUOUS, SINGLE, IDLE = 0, 1, 2
RDY, LOCK = 0x01, 0x02
PERIOD = Fraction(SECOND, 15)  # at power-on


def continuous(*gauss: float, **more: object) -> Bench:
    """A chip that has measured continuously for a second."""
    chip = Hmc5883l(TIMEBASE, steady(*gauss), **more)
    chip.write(0, MODE, CONTINUOUS)
    return Bench(chip)


def tick(periods: int | Fraction, begin: int = 0) -> int:
    """The tick at which a measurement ends, `periods` periods after `begin` or after the analog part's first 50 ms."""
    return max(begin, 50 * MS) + -(-2 * PERIOD // 1) + int((periods - 2) * PERIOD)


def test_it_acknowledges_200_us_after_power():
    bench = Bench(Hmc5883l(TIMEBASE, steady(0, 0, 0)), begin=0)
    assert bench.chips[0].ready == 200 * US
    bench.wait(150 * US)
    assert not bench.write(CRA)
    bench.kernel.run_until(200 * US)
    assert bench.write(CRA)


def test_the_identification_registers_read_h43():
    assert continuous(0, 0, 0).read(ID, 3) == b"H43"


def test_six_bytes_are_x_z_y_high_byte_first_with_1090_lsb_per_gauss():
    assert words(continuous(0.1, 0.2, -0.3).read(DATA, 6)) == [109, -327, 218]


@pytest.mark.parametrize(
    ("code", "lsb"), [(0, 1370), (1, 1090), (2, 820), (3, 660), (4, 440), (5, 390), (6, 330), (7, 230)]
)
def test_gain_and_overflow(code: int, lsb: int):
    chip = Hmc5883l(TIMEBASE, steady(0.5, Fraction(2047, lsb), Fraction(2048, lsb)))
    chip.write(0, CRB, code << 5)
    chip.write(0, MODE, CONTINUOUS)
    bench = Bench(chip)
    assert words(bench.read(DATA, 6)) == [round(lsb * Fraction(1, 2)), -4096, 2047]
    chip.source = steady(Fraction(-2048, lsb), Fraction(-2049, lsb), 0)
    bench.wait(SECOND)
    assert words(bench.read(DATA, 6)) == [-2048, 0, -4096]


def test_a_new_gain_applies_from_the_second_measurement():
    chip = Hmc5883l(TIMEBASE, steady(1, 0, 0))
    chip.write(0, MODE, CONTINUOUS)
    assert [chip.read(tick(3), n) for n in range(3, 9)][:2] == [0x04, 0x42]  # 1090
    chip.write(tick(3) + 1, CRB, 3 << 5)
    shown = [words(bytes(chip.read(tick(n), r) for r in range(3, 9)))[0] for n in (4, 5, 6)]
    assert shown == [1090, 660, 660]


def test_a_new_gain_applies_when_several_measurements_are_not_read():
    chip = Hmc5883l(TIMEBASE, steady(1, 0, 0))
    chip.write(0, MODE, CONTINUOUS)
    chip.write(tick(3) + 1, CRB, 3 << 5)
    assert words(bytes(chip.read(tick(5), r) for r in range(3, 9)))[0] == 660


@pytest.mark.parametrize(("code", "hertz"), [(0, 0.75), (1, 1.5), (2, 3), (3, 7.5), (4, 15), (5, 30), (6, 75)])
def test_continuous_measurements_end_two_periods_after_the_mode_and_then_every_period(code: int, hertz: float):
    source = Asked(Fraction(1090))
    chip = Hmc5883l(TIMEBASE, source)
    chip.write(SECOND, CRA, code << 2)
    chip.write(SECOND, MODE, CONTINUOUS)
    period = SECOND / Fraction(hertz)
    first = SECOND + -(-2 * period // 1)
    chip.read(first - 1, CRB)
    assert source.at == []
    for number in range(4):
        chip.read(first + int(number * period), CRB)
    assert source.at == [first + int(number * period) for number in range(4)]


def test_nothing_is_measured_before_the_analog_part_is_ready():
    source = Asked(Fraction(1090))
    chip = Hmc5883l(TIMEBASE, source)
    chip.write(MS, MODE, SINGLE)
    chip.read(56 * MS - 1, CRB)
    assert source.at == []
    chip.read(56 * MS, CRB)
    assert source.at == [56 * MS]


def test_a_single_measurement_takes_6_ms_and_leaves_the_chip_idle():
    bench = Bench(Hmc5883l(TIMEBASE, steady(0.1, 0.2, 0.3)))
    bench.write(MODE, SINGLE)
    bench.wait(5_400 * US)
    assert bench.read(STATUS)[0] == 0 and words(bench.read(DATA, 6)) == [0, 0, 0]
    bench.wait(MS)
    assert bench.read(STATUS)[0] == RDY
    assert words(bench.read(DATA, 6)) == [109, 327, 218]
    assert bench.read(STATUS)[0] == 0
    assert bench.read(MODE)[0] == IDLE
    bench.chips[0].source = steady(1, 1, 1)
    bench.wait(SECOND)
    assert words(bench.read(DATA, 6)) == [109, 327, 218], "an idle chip makes no new measurement"


def test_a_single_measurement_that_ends_while_data_are_being_read_is_lost():
    bench = Bench(Hmc5883l(TIMEBASE, steady(0.1, 0.2, 0.3)))
    bench.write(MODE, SINGLE)
    bench.read(DATA, 5)
    bench.wait(7 * MS)
    assert bench.read(MODE)[0] == IDLE
    assert words(bench.read(DATA, 6)) == [0, 0, 0]


def test_rdy_is_0_for_250_us_while_data_are_placed_and_after_they_are_read():
    chip = Hmc5883l(TIMEBASE, steady(0, 0, 0))
    chip.write(0, MODE, CONTINUOUS)
    status = [chip.read(tick(2) + t, STATUS) for t in (-1, 0, 250 * US - 1, 250 * US)]
    assert status == [0, 0, 0, RDY]
    assert [chip.read(tick(3) + t, STATUS) for t in (-1, 0, 250 * US)] == [RDY, 0, RDY]
    for number in range(3, 9):
        chip.read(tick(3) + 300 * US, number)
    assert [chip.read(tick(t), STATUS) for t in (Fraction(7, 2), 4)] == [0, 0]
    assert chip.read(tick(4) + 250 * US, STATUS) == RDY


@pytest.mark.parametrize("how", ["some data read", "mode read"])
@pytest.mark.parametrize("release", ["all six read", "mode written", "CRA written"])
def test_lock_keeps_new_data_out_of_the_registers(how: str, release: str):
    source = Asked(Fraction(1090))
    chip = Hmc5883l(TIMEBASE, source)
    chip.write(0, MODE, CONTINUOUS)
    now = tick(2)
    before = chip.read(now, DATA + 1) if how == "some data read" else (chip.read(now, MODE), 1)[1]
    assert before == 1 and chip.read(now, STATUS) & LOCK
    chip.advance_to(tick(10))
    assert chip.stored[DATA + 1] == 1 and chip.read(tick(10), STATUS) & LOCK
    if release == "all six read":
        numbers = range(DATA, DATA + 6)
        assert [chip.read(tick(10), n) for n in numbers] == [0, 1, 0, 1, 0, 1]
    else:
        chip.write(tick(10), MODE if release == "mode written" else CRA, 0 if release == "mode written" else 0x10)
    assert not chip.read(tick(10), STATUS) & LOCK
    chip.advance_to(tick(20))
    assert chip.stored[DATA + 1] > 1


def test_lock_needs_all_six_reads_again_after_it_was_cleared():
    chip = Hmc5883l(TIMEBASE, steady(0, 0, 0))
    chip.write(0, MODE, CONTINUOUS)
    locked = []
    for number in [*range(DATA, DATA + 6)] * 2:
        chip.read(tick(2), number)
        locked.append(chip.read(tick(2), STATUS) & LOCK)
    assert locked == ([LOCK] * 5 + [0]) * 2


@pytest.mark.parametrize(
    ("mode", "cra", "end"),
    [
        (CONTINUOUS, 0x30, 2 * PERIOD),  # more samples in an average: the rate does not change
        (CONTINUOUS, 0x14, 5 * MS + Fraction(2 * SECOND, 30)),  # a change to 30 Hz: a new measurement begins
        (SINGLE, 0x14, 6 * MS),
    ],
)
def test_only_a_new_rate_in_continuous_mode_restarts_a_measurement(mode: int, cra: int, end: Fraction):
    """CRA is written 5 ms after the mode."""
    source = Asked(Fraction(1090))
    chip = Hmc5883l(TIMEBASE, source)
    chip.write(SECOND, MODE, mode)
    chip.write(SECOND + 5 * MS, CRA, cra)
    chip.advance_to(SECOND - (-end // 1) - 1)
    assert source.at == []
    chip.advance_to(SECOND - (-end // 1))
    assert source.at[0] == SECOND - (-end // 1)


@pytest.mark.parametrize(("ma", "number"), [(0, 1), (1, 2), (2, 4), (3, 8)])
def test_averages_are_spread_over_the_period(ma: int, number: int):
    source = Asked(Fraction(1090))
    chip = Hmc5883l(TIMEBASE, source)
    chip.write(0, CRA, 0x10 | ma << 5)
    chip.write(0, MODE, CONTINUOUS)
    data = words(bytes(chip.read(tick(2), n) for n in range(3, 9)))
    step = int(PERIOD) // number
    assert sorted(source.at) == [tick(2) - step * n for n in reversed(range(number))]
    assert data[0] == round(Fraction(sum(range(1, number + 1)), number))


@pytest.mark.parametrize(("ms", "sign"), [(1, 1), (2, -1)])
def test_the_self_test_bias(ms: int, sign: int):
    bench = continuous(0, 0, 0)
    bench.write(CRB, 5 << 5)  # 390 LSB per gauss
    bench.write(CRA, 0x10 | ms)
    bench.wait(SECOND)
    assert words(bench.read(DATA, 6)) == [sign * 452, sign * 421, sign * 452]  # 1.16, 1.08, 1.16 gauss


def test_the_pointer_wraps_from_08_to_03_and_from_0c_to_00():
    bench = continuous(0.1, 0.2, 0.3)
    first = bench.read(DATA, 6)
    assert bench.read_on(6) == first and bench.read_on(7) == first + first[:1]
    assert bench.read(ID, 5) == b"H43\x10\x20"
    assert bench.read(STATUS, 5)[1:] == b"H43\x10"


def test_the_pointer_can_be_set_in_a_separate_transfer():
    bench = continuous(0.1, 0.2, 0.3)
    assert bench.read(ID, 3, by_stop=True) == b"H43"


@pytest.mark.parametrize(
    ("number", "value", "code", "what"),
    [
        (CRA, 0x1C, "duty", "DO = 7"),
        (CRA, 0x13, "duty", "MS = 3"),
        (CRB, 0x21, "duty", "bits 4 to 0 must be 0"),
        (MODE, 0x80, "unknown", "3.4 MHz"),
        (0x0A, 0x00, "duty", "read-only"),
        (0x20, 0x00, "duty", "reserved"),
    ],
)
def test_settings_that_are_not_modelled_or_allowed_leave_a_note(number: int, value: int, code: str, what: str):
    bench = continuous(0, 0, 0)
    bench.write(number, value)
    (note,) = bench.chips[0].notes
    assert note.code == code and what in note.text


# Open questions of the data sheet -----------------------------------------------------------


@pytest.mark.parametrize("code", [2, 3])
def test_open_idle_code(code: int):
    bench = Bench(Hmc5883l(TIMEBASE, steady(0, 0, 0), options=Hmc5883lOptions(idle_code=code)))
    bench.write(MODE, SINGLE)
    bench.wait(7 * MS)
    assert bench.read(MODE)[0] == code
    assert "idle_code" in bench.chips[0].touched


@pytest.mark.parametrize("measures", [False, True])
def test_open_power_on_measures(measures: bool):
    bench = Bench(Hmc5883l(TIMEBASE, steady(0.1, 0, 0), options=Hmc5883lOptions(power_on_measures=measures)))
    assert words(bench.read(DATA, 2)) == [109 if measures else 0]
    assert bench.read(MODE)[0] == (IDLE if measures else SINGLE)
    assert "power_on_measures" in bench.chips[0].touched


@pytest.mark.parametrize(("answer", "status"), [("all_six", RDY | LOCK), ("any", LOCK)])
def test_open_rdy_clears(answer: str, status: int):
    chip = Hmc5883l(TIMEBASE, steady(0, 0, 0), options=Hmc5883lOptions(rdy_clears=answer))
    chip.write(0, MODE, CONTINUOUS)
    now = tick(2) + MS
    chip.read(now, DATA)
    assert chip.read(now, STATUS) == status
    assert "rdy_clears" in chip.touched
