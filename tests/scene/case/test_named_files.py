"""Files that a case may read, by the texts that it has: sources with their neighbours, folders with their headers."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim.scene.case.named_files import named_files


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
