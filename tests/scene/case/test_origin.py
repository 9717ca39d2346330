"""Places in a case as users see them: the line of a key, the change that set it, and its name for `--set`."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim.scene.case.origin import Place, Source, key_of, line_of, named_files

TEXT = """\
name = "x"
# duration = "2 s"
"duration" = "1 s"

[unit.dsp]  # the emulator
modules = ["I2C-A"]
settings.byte = 3
[ unit . "left.hand" ]
modules = []
[[budget]]
name = "first"
max = 1
[[budget]]
name = "second"
max = 2
[budget.more]
deep = 1
[[fault]]
kind = "hold"
[unit."other one"]
modules = []
[controller]
[[controller.request]]
address = 1
[[controller.request]]
address = 2
"""


@pytest.mark.parametrize(
    ("place", "line"),
    [
        (("name",), 1),
        (("duration",), 3),
        (("unit",), 5),
        (("unit", "dsp"), 5),
        (("unit", "dsp", "modules"), 6),
        (("unit", "dsp", "modules", 0), 6),
        (("unit", "dsp", "settings"), 5),
        (("unit", "dsp", "settings", "byte"), 7),
        (("unit", "dsp", "settings", "word"), 5),  # a missing key: the line of its table
        (("budget", 0, "max"), 12),
        (("budget", 1, "max"), 15),
        (("budget", 1, "min"), 13),
        (("budget", 2, "max"), 0),
        (("fault", 0, "kind"), 19),
        (("nothing",), 0),
        (("unit", "other one", "modules"), 21),
        (("controller", "rate"), 22),
        (("controller", "request", 0, "address"), 24),
        (("controller", "request", 1, "address"), 26),
    ],
)
def test_the_line_of_a_key_or_of_its_table(place: Place, line: int):
    assert line_of(TEXT, place) == line


@pytest.mark.parametrize(
    ("place", "where"),
    [
        (("name",), "case.toml, line 1"),
        (("nothing",), "case.toml"),
        (("unit", "dsp", "modules"), "case.toml, --set 'unit.dsp.modules=[]'"),
        (("unit", "dsp", "modules", 0), "case.toml, --set 'unit.dsp.modules=[]'"),
        (("unit", "dsp"), "case.toml, line 5 with --set 'unit.dsp.modules=1'"),
        (("more", "deep"), "case.toml, --set 'more.deep=1'"),
        (("more",), "case.toml with --set 'more.deep=1'"),
    ],
)
def test_a_place_is_a_line_or_the_last_change_that_made_it(place: Place, where: str):
    """If several changes are inside a table, the first of them is named."""
    modules = ("unit", "dsp", "modules")
    changes = (
        ("unit.dsp.modules=1", modules),
        ("unit.dsp.modules=[]", modules),
        ("more.deep=1", ("more", "deep")),
    )
    assert Source(Path("case.toml"), TEXT, changes).where(place) == where


@pytest.mark.parametrize(
    ("place", "key"),
    [
        (("duration",), "duration"),
        (("budget", 0, "max"), "budget.first.max"),
        (("budget", 1, "max"), "budget.1.max"),  # two have that name
        (("budget", 3, "max"), "budget.3.max"),
        (("budget", 9, "max"), "budget.9.max"),
        (("unit", "dsp", "modules", 0), "unit.dsp.modules.0"),
    ],
)
def test_the_key_of_a_place_for_set(place: Place, key: str):
    budgets = [{"name": "first"}, {"name": "twice"}, {"name": "twice"}, {}]
    assert key_of(place, {"budget": budgets, "unit": {"dsp": {"modules": ["I2C-A"]}}}) == key


def test_a_change_is_quoted_whole_up_to_120_characters():
    def where(length: int) -> str:
        change = "a=" + "x" * (length - 4)  # its quotes count, too
        return Source(Path("case.toml"), "", ((change, ("a",)),)).where(("a",))

    assert where(120) == f"case.toml, --set 'a={'x' * 116}'"
    assert where(121).endswith("(121 characters)")


@pytest.mark.parametrize(
    ("text", "files"),
    [
        ("main.py", "main.py main.py own.py"),
        ("none.py", "none.py main.py own.py"),
        ("code/main.asm", "code/main.asm code/macros.inc"),
        ("code/main.c", "code/main.c code/main.h"),
        ("code", "code code/main.h"),
        ("steps.csv", "steps.csv"),
        ("x" * 199, "x" * 199),
        ("x" * 200, ""),  # too long for a path
        ("no\0path", ""),
    ],
)
def test_the_files_that_a_text_may_name(text: str, files: str, tmp_path: Path):
    (tmp_path / "code").mkdir()
    for name in ("main.py", "own.py", "steps.csv", "code/main.asm", "code/macros.inc", "code/main.c", "code/main.h"):
        (tmp_path / name).touch()
    found = [file.relative_to(tmp_path).as_posix() for file in named_files(tmp_path, [text])]
    assert found[:1] + sorted(found[1:]) == files.split()
