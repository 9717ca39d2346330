"""docs/reproduce.md: published figures are as printed there, and own figures are in the output of their commands."""

from __future__ import annotations

import re

import pytest

from periph_sim.imu.at_rest.static_table import EMULATOR
from periph_sim.processor.image_files.inspection import inspect
from periph_sim.processor.image_files.program_file import program_in
from tests.docs.pages import CONSOLE, PAGES, ROOT, commands

PAGE = (ROOT / "docs" / "reproduce.md").read_text(encoding="utf-8")
SHOWN = {
    command: out
    for page in PAGES
    for block in CONSOLE.findall(page.read_text("utf-8"))
    for command, out in commands(block)
}
ROWS = re.findall(r"^\| ([^|]+) \| [^|]+ \| ([^|]+) \| `(periph-sim .+)` \|$", PAGE, re.MULTILINE)
NUMBER = re.compile(r"(?<![\w.])-?\d+\.\d+(?:e-\d+)?")


@pytest.mark.parametrize(("what", "here", "command"), ROWS)
def test_a_result_is_printed_by_its_command(what: str, here: str, command: str):
    found = NUMBER.findall(here)
    assert found, f"{what}: no figure"
    assert set(found) <= set(NUMBER.findall(SHOWN[command.replace(r"\|", "|")]))


@pytest.mark.parametrize("chip", EMULATOR)
def test_the_table_at_rest_has_the_published_figures(chip: str):
    shown = [text for command, text in SHOWN.items() if command.startswith("periph-sim imu-table | ")]
    lines = "".join(shown).splitlines()
    row = EMULATOR[chip]
    for axis, published in zip("xyz", zip(row.mean, row.three_sigma, row.variance, strict=True), strict=True):
        printed = [line.split() for line in lines if line.startswith(f" {chip} {axis}, ")]
        assert [float(cells[4]) for cells in printed] == list(published)


def test_the_sizes_of_the_image_equal_those_of_its_functions():
    told = SHOWN["periph-sim image firmware/c28x/imu_hil.asm | sed -n 4,9p"]
    section = {cells[0]: int(cells[-2]) for line in told.splitlines()[2:] if (cells := line.split())}
    image = program_in(ROOT / "firmware" / "c28x" / "imu_hil.asm")
    words = {one.name.lstrip("_"): one.size for one in inspect(image).functions}
    parts = [
        ("model", "six_bytes"),
        ("c_int00", "main", "sci_received"),
        ("start_pin", "start_sci", "start_pie", "start_chip", "start_i2c"),
        ("serve",),
    ]
    ours = [int(cell) for cell in re.findall(r"^\| [^|]+ \| [\d +]+ \| (\d+)", PAGE, re.MULTILINE)]
    sums = [sum(words[name] for name in part) for part in parts]
    assert ours == [*sums, section[".text"]] and sum(sums) == section[".text"]
    assert f"{section['.ebss'] + section['.econst']} of data" in PAGE


def test_every_table_and_figure_of_the_chapter_has_a_row():
    items = re.findall(r"^\| (?:appendix B, )?((?:Figure|Table) [\dB]\.\d) \|", PAGE, re.MULTILINE)
    assert sorted(items) == [*(f"Figure 5.{n}" for n in range(1, 8)), "Figure B.1", "Table 5.1", "Table 5.2"]
