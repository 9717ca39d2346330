"""The two observations from silicon hold under the defaults, and docs/slave_transmitter.md shows the current table."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from tests.scene.copy_points import DATA, POINTS, read, table

PAGE = Path(__file__).parents[2] / "docs" / "slave_transmitter.md"
BEGIN, END = "<!-- copy points -->\n", "<!-- end -->"
SHIFTED = "22 33 44 55 66 00"


def test_under_the_defaults_the_wait_makes_every_byte_right_and_its_absence_shifts_them():
    assert read("any_ack_fall9", wait=True, pointer_by="repeated START") == [DATA] * 4
    assert read("any_ack_fall9", wait=False, pointer_by="repeated START") == [SHIFTED] * 4


@pytest.mark.parametrize("point", POINTS)
def test_open_dxr_to_xsr_copy_point_in_the_emulator(point):
    both_observations = point in ("any_ack_fall9", "eager_reloaded_at_address")
    assert read(point, wait=True, pointer_by="repeated START") == [DATA] * 4
    assert (read(point, wait=False, pointer_by="repeated START") == [SHIFTED] * 4) is both_observations


@pytest.mark.parametrize(("point", "symptom"), [("fall8", True), ("rise9", True), ("fall9", False)])
def test_open_rrdy_point_decides_whether_the_first_write_is_early_enough(point, symptom):
    rounds = read("any_ack_fall9", wait=False, pointer_by="repeated START", others={"rrdy_point": point})
    assert (rounds == [SHIFTED] * 4) is symptom


def test_the_page_shows_the_current_table():
    assert PAGE.read_text(encoding="utf-8").partition(BEGIN)[2].partition(END)[0].strip() == table()


if __name__ == "__main__":  # rewrites the page's table
    text = PAGE.read_text(encoding="utf-8")
    head, _, rest = text.partition(BEGIN)
    PAGE.write_text(f"{head}{BEGIN}{table()}\n{END}{rest.partition(END)[2]}", encoding="utf-8")
    sys.exit(0)
