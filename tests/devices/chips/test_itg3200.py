"""ITG-3200 over the bus: start-up, rates, scale, temperature, INT, standby, reset, and the open questions.

Source: InvenSense ITG-3200 Product Specification rev 1.4.
"""

from __future__ import annotations

from fractions import Fraction

import pytest

from periph_sim.bus.i2c.transfer import BusTiming
from periph_sim.devices.chips.itg3200 import Itg3200, Itg3200Options
from tests.devices.bench import MS, SECOND, TIMEBASE, US, Asked, Bench, steady, words

SMPLRT_DIV, DLPF_FS, INT_CFG, INT_STATUS, TEMP, GYRO, PWR_MGM = 0x15, 0x16, 0x17, 0x1A, 0x1B, 0x1D, 0x3E
RAW, RDY = 0x01, 0x04
RAW_EN, RDY_EN, ANY_READ = 0x01, 0x04, 0x10
RESET, SLEEP = 0x80, 0x40


def bench_of(*deg_s: float, begin: int = SECOND, **more: object) -> Bench:
    return Bench(Itg3200(TIMEBASE, steady(*deg_s), **more), begin=begin)


def test_it_does_not_acknowledge_in_the_first_20_ms():
    bench = bench_of(0, 0, 0, begin=0)
    assert bench.chips[0].ready == 20 * MS
    bench.wait(19_950 * US)
    assert not bench.write(0x00)
    bench.kernel.run_until(20 * MS)
    assert bench.write(0x00)


@pytest.mark.parametrize(("address", "who"), [(0x68, 0x68), (0x69, 0x69)])
def test_who_am_i_is_the_address(address: int, who: int):
    assert bench_of(0, 0, 0, address=address).read(0x00)[0] == who


def test_x_y_z_are_sent_high_byte_first_with_14_375_lsb_per_degree_per_second():
    assert words(bench_of(10, -20, 30).read(GYRO, 6)) == [144, -288, 431]  # 143.75, -287.5, 431.25


def test_it_saturates_beyond_full_scale():
    assert words(bench_of(2279, 2280, -2280).read(GYRO, 6)) == [32761, 32767, -32768]


@pytest.mark.parametrize(("celsius", "raw"), [(35, -13200), (25, -16000), (85, 800), (200, 32767)])
def test_temperature_is_280_lsb_per_degree_and_minus_13200_at_35(celsius: float, raw: int):
    bench = bench_of(0, 0, 0, temperature=lambda tick: celsius)
    assert words(bench.read(TEMP, 2)) == [raw]


def test_a_burst_of_eight_bytes_has_temperature_and_axes():
    assert words(bench_of(1, 2, 3).read(TEMP, 8)) == [-16000, 14, 29, 43]


@pytest.mark.parametrize(("cfg", "div", "hertz"), [(0, 0, 8000), (0, 7, 1000), (3, 0, 1000), (6, 19, 50), (1, 255, 0)])
def test_the_sample_rate_follows_from_filter_and_divider(cfg: int, div: int, hertz: int):
    source = Asked(Fraction(115, 8))
    chip = Itg3200(TIMEBASE, source)
    chip.write(0, DLPF_FS, 0x18 | cfg)
    chip.write(0, SMPLRT_DIV, div)
    rate = Fraction(hertz) or Fraction(1000, 256)
    first = 50 * MS + -(-(SECOND / rate) // 1)
    chip.read(first - 1, INT_STATUS)
    assert source.at == []
    for number in range(4):
        chip.read(first + int(number * SECOND / rate), INT_STATUS)
    assert source.at == [first + int(number * SECOND / rate) for number in range(4)]


def test_samples_begin_50_ms_after_power():
    bench = bench_of(10, 10, 10, begin=30 * MS)
    assert words(bench.read(GYRO, 2)) == [0]
    assert bench.chips[0].touched == set(), "zeros before the first sample depend on no open question"
    bench.kernel.run_until(50 * MS + 125 * US)
    assert words(bench.read(GYRO, 2)) == [144]


def test_raw_data_rdy_is_set_only_if_enabled_and_cleared_by_reading_the_status():
    bench = bench_of(0, 0, 0)
    bench.write(SMPLRT_DIV, 79)  # 100 Hz
    bench.wait(30 * MS)
    assert bench.read(INT_STATUS)[0] == 0
    bench.write(INT_CFG, RAW_EN)
    assert bench.read(INT_STATUS)[0] == 0
    bench.wait(10 * MS)
    assert bench.read(0x00)[0] == 0x68 and bench.read(GYRO, 6)
    assert bench.read(INT_STATUS)[0] == RAW
    assert bench.read(INT_STATUS)[0] == 0


def test_with_int_anyrd_2clear_any_read_clears_raw_data_rdy():
    bench = bench_of(0, 0, 0)
    bench.write(SMPLRT_DIV, 79)
    bench.write(INT_CFG, RAW_EN | ANY_READ)
    bench.wait(10 * MS)
    assert bench.read(0x00)[0] == 0x68
    assert bench.read(INT_STATUS)[0] == 0


def test_itg_rdy_is_set_1_ms_after_the_clock_source_was_chosen():
    bench = bench_of(0, 0, 0)
    bench.write(INT_CFG, RDY_EN)
    assert bench.read(INT_STATUS)[0] == RDY, "the clock source of power-on has settled"
    bench.write(PWR_MGM, 0x01)
    assert bench.read(INT_STATUS)[0] == 0
    bench.wait(1 * MS)
    assert bench.read(INT_STATUS)[0] == RDY
    assert bench.read(INT_STATUS)[0] == 0


def test_the_settling_of_the_clock_source_ends_at_the_exact_tick():
    chip = Itg3200(TIMEBASE, steady(0, 0, 0))
    chip.write(SECOND, INT_CFG, RDY_EN)
    chip.write(SECOND, PWR_MGM, 0x01)
    chip.read(SECOND, INT_STATUS)  # clears RDY of the source before
    assert [chip.read(SECOND + MS + t, INT_STATUS) for t in (-1, 0, 1)] == [0, RDY, 0]


def test_a_write_of_pwr_mgm_that_keeps_the_clock_source_does_not_make_it_settle():
    chip = Itg3200(TIMEBASE, steady(0, 0, 0))
    chip.write(SECOND, INT_CFG, RDY_EN)
    assert chip.read(SECOND, INT_STATUS) == RDY
    chip.write(SECOND, PWR_MGM, 0x08)  # STBY_ZG
    assert chip.read(SECOND + 2 * MS, INT_STATUS) == 0


def test_sleep_keeps_the_last_sample_and_waking_takes_50_ms():
    source = Asked(Fraction(115, 8))
    bench = Bench(Itg3200(TIMEBASE, source))
    last = words(bench.read(GYRO, 2))
    bench.write(PWR_MGM, SLEEP)
    asleep = len(source.at)
    bench.wait(100 * MS)
    assert words(bench.read(GYRO, 2)) == [asleep] and asleep >= last[0]
    bench.write(PWR_MGM, 0)
    bench.wait(49 * MS)
    bench.read(GYRO, 2)
    assert len(source.at) == asleep
    bench.wait(2 * MS)
    assert words(bench.read(GYRO, 2)) == [asleep + 1]


def test_h_reset_resets_every_register_and_clears_itself():
    bench = bench_of(10, 10, 10)
    bench.write(SMPLRT_DIV, 9, 0x1B, RAW_EN)
    bench.write(PWR_MGM, RESET | 0x03)
    assert [bench.read(n)[0] for n in (SMPLRT_DIV, DLPF_FS, INT_CFG, PWR_MGM, 0x00)] == [0, 0, 0, 0, 0x68]
    for wait, shown in ((0, 0), (48, 0), (3, 144)):
        bench.wait(wait * MS)
        assert words(bench.read(GYRO, 6)) == [shown] * 3


def test_a_burst_write_fills_consecutive_registers():
    bench = bench_of(0, 0, 0)
    bench.write(SMPLRT_DIV, 7, 0x1B, RAW_EN)
    assert bench.read(SMPLRT_DIV, 3).hex(" ") == "07 1b 01"


@pytest.mark.parametrize(
    ("number", "value", "what"),
    [(DLPF_FS, 0x00, "FS_SEL = 0"), (DLPF_FS, 0x1F, "DLPF_CFG = 7"), (PWR_MGM, 0x06, "CLK_SEL = 6")],
)
def test_reserved_settings_leave_a_note(number: int, value: int, what: str):
    bench = bench_of(0, 0, 0)
    bench.write(number, value)
    (note,) = bench.chips[0].notes
    assert note.code == "duty" and what in note.text


@pytest.mark.parametrize(("clk_sel", "codes"), [(0, []), (3, []), (4, ["unknown"]), (5, ["unknown"]), (7, ["duty"])])
def test_an_external_clock_leaves_a_note_because_it_is_not_modelled(clk_sel: int, codes: list[str]):
    bench = bench_of(0, 0, 0)
    bench.write(PWR_MGM, clk_sel)
    assert [note.code for note in bench.chips[0].notes] == codes
    assert all(f"CLK_SEL = {clk_sel} " in note.text for note in bench.chips[0].notes)


# Open questions of the specification -----------------------------------------------------


@pytest.mark.parametrize(("answer", "who"), [("ad0", 0x69), ("zero", 0x68)])
def test_open_who_am_i_bit_0(answer: str, who: int):
    bench = bench_of(0, 0, 0, address=0x69, options=Itg3200Options(who_am_i_bit_0=answer))
    assert bench.read(0x00)[0] == who
    assert "who_am_i_bit_0" in bench.chips[0].touched


@pytest.mark.parametrize("answer", ["stored", "changes_address"])
def test_open_who_am_i_write(answer: str):
    bench = bench_of(0, 0, 0, options=Itg3200Options(who_am_i_write=answer))
    bench.write(0x00, 0x52)
    assert bench.address == (0x68 if answer == "stored" else 0x52)
    assert bench.read(0x00)[0] == 0x52
    bench.write(PWR_MGM, RESET)
    assert (bench.address, bench.read(0x00)[0]) == (0x68, 0x68)
    assert "who_am_i_write" in bench.chips[0].touched


@pytest.mark.parametrize(
    ("answer", "tail", "pointer"), [("first_reserved", "00 00", 0x23), ("last_before", "af af", 0x22)]
)
def test_open_pointer_stops(answer: str, tail: str, pointer: int):
    bench = bench_of(10, -20, 30, options=Itg3200Options(pointer_stops=answer))
    assert bench.read(GYRO, 8).hex(" ") == f"00 90 fe e0 01 af {tail}"
    assert bench.pointers[0].pointer == pointer
    assert "pointer_stops" in bench.chips[0].touched


@pytest.mark.parametrize(("answer", "x"), [("as_3", 144), ("halves_each_step", 1150)])
def test_open_fs_sel_other(answer: str, x: int):
    """FS_SEL is 0 after power-on."""
    bench = bench_of(10, 0, 0, options=Itg3200Options(fs_sel_other=answer))
    assert words(bench.read(GYRO, 2)) == [x]
    assert "fs_sel_other" in bench.chips[0].touched


def test_with_fs_sel_3_no_read_depends_on_the_open_question_of_other_values():
    bench = bench_of(10, 0, 0)
    bench.write(DLPF_FS, 0x18)
    bench.wait(MS)
    assert words(bench.read(GYRO, 2)) == [144]
    assert bench.chips[0].touched == set()


def test_a_reserved_register_reads_0_and_leaves_a_note():
    bench = bench_of(0, 0, 0)
    assert bench.read(0x01) == b"\0"
    assert [note.text for note in bench.chips[0].notes] == ["register 0x01 is reserved, but was read; it reads 0 here"]


@pytest.mark.parametrize("answer", ["coherent", "live"])
def test_open_burst(answer: str):
    """With 8 kHz samples and SCL at 10 kHz, each byte is of another sample unless the burst keeps the first one."""
    slow = BusTiming(50 * US, 50 * US, 300, 50 * US, 50 * US, 50 * US, 50 * US)
    bench = Bench(Itg3200(TIMEBASE, Asked(Fraction(115, 8)), options=Itg3200Options(burst=answer)), timing=slow)
    bench.read(GYRO, 1)
    x, y, z = words(bench.read(GYRO, 6))
    assert (x == y == z) if answer == "coherent" else (x < y < z)
    assert "burst" in bench.chips[0].touched


@pytest.mark.parametrize(("answer", "y"), [("holds", 144), ("zero", 0)])
def test_open_standby_axis(answer: str, y: int):
    bench = bench_of(10, 10, 10, options=Itg3200Options(standby_axis=answer))
    bench.write(PWR_MGM, 0x10)
    bench.wait(MS)
    assert words(bench.read(GYRO, 6)) == [144, y, 144]
    assert "standby_axis" in bench.chips[0].touched


@pytest.mark.parametrize("blocks", [False, True])
def test_open_reset_blocks_bus(blocks: bool):
    bench = bench_of(0, 0, 0, options=Itg3200Options(reset_blocks_bus=blocks))
    bench.write(PWR_MGM, RESET)
    assert bench.write(0x00) is not blocks
    bench.wait(20 * MS)
    assert bench.write(0x00)
    assert "reset_blocks_bus" in bench.chips[0].touched
