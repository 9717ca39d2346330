"""Table 5.2 on the page: every row as printed, its sum and its shares, and those of the chip's memory."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from periph_sim.imu.at_rest.published import MEMORY, TOTAL

PAGE = (Path(__file__).parents[3] / "docs" / "numerics.md").read_text(encoding="utf-8")
ROW = re.compile(r"^\| ([\w ]+) \| ([\d ]+) \| ([\d.]+) % \| ([\d.]+) % \| ([\d.]+) % \| ([\d.]+) % \|$", re.MULTILINE)
RAM, FLASH = 34 * 1024, 256 * 1024  # words: SPRS439M, SARAM M0, M1 and L0 to L7; flash


def test_the_rows_make_the_total():
    assert sum(row.words for row in MEMORY.values()) == TOTAL.words


@pytest.mark.parametrize("row", [*MEMORY.values(), TOTAL])
def test_the_printed_shares_are_of_34_000_and_256_000_words(row):
    assert 100 * row.words / 34_000 == pytest.approx(row.ram, abs=0.0051)
    assert 100 * row.words / 256_000 == pytest.approx(row.flash, abs=0.0051)


def test_the_page_shows_them_and_the_shares_of_the_chip():
    shown = {name: cells for name, *cells in ROW.findall(PAGE)}
    assert set(shown) == {*MEMORY, "total"}
    for name, row in {**MEMORY, "total": TOTAL}.items():
        words, ram, flash, of_ram, of_flash = shown[name]
        assert (int(words.replace(" ", "")), float(ram), float(flash)) == row
        assert (of_ram, of_flash) == (f"{100 * row.words / RAM:.2f}", f"{100 * row.words / FLASH:.2f}")
