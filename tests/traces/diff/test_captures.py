"""Real captures and their conversions to other formats have the same events at the same times."""

from __future__ import annotations

import pytest

from periph_sim.traces import formats
from periph_sim.traces.decode.uart import Line
from periph_sim.traces.diff import diff_i2c, diff_uart
from tests.captures.where import capture_of, needs_captures

pytestmark = needs_captures


def capture(name: str) -> formats.Capture:
    return formats.read(capture_of(name))


@pytest.mark.parametrize(
    ("a", "b"),
    [
        ("i2c_ds3231_ex2", "i2c_ds3231_ex2_vcd"),
        ("i2c_ad5258_eeprom_busy_nack", "i2c_ad5258_busy_pvcsv"),
        ("i2c_nunchuk_init", "i2c_nunchuk_init_simvcd"),
    ],
)
def test_the_same_bus_in_two_files(a, b):
    one, other = capture(a), capture(b)
    lines = [(one.channel(0).name, one.channel(1).name)]
    lines.append(("scl", "sda") if b.endswith("simvcd") else lines[0])
    found = diff_i2c(one, other, *lines)
    assert found.equal and found.entries and found.offset == 0


def test_the_same_uart_in_two_files():
    one, other = capture("uart_hello_8n1_115200"), capture("uart_hello_8n1_115200_vcd")
    found = diff_uart(one, other, Line(115200), "TX")
    assert found.equal and len(found.entries) == 42


def test_a_stop_and_a_start_instead_of_a_repeated_start():
    """The captures have the same read, once with a repeated START and once with STOP and START."""
    found = diff_i2c(capture("i2c_ad5258_read_once"), capture("i2c_ad5258_stop_norestart"))
    assert [entry.b.word for entry in found.inserted] == ["STOP"] and not found.missing
    assert [(entry.a.word, entry.b.word) for entry in found.changed] == [("repeated START", "START")]
    assert [point.entry for point in found.change_points] == found.changed, "only this event is later"


def test_a_snippet_is_found_in_the_capture_that_it_was_cut_from():
    found = diff_i2c(capture("i2c_cat24c256_ackpoll"), capture("i2c_cat24c256_flash_1M_edges"))
    assert not found.missing and not found.changed and not found.change_points
    assert found.offset == 349_056 and len(found.entries) - len(found.inserted) == 1_225
