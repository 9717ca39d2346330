"""Commands print to pipes whose encoding lacks some of their characters, such as cp1252 on Windows."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from itertools import zip_longest
from pathlib import Path

import pytest

from tests.scene.runs import TIMING

CASE = str(TIMING / "imu_hil.toml")
COMMANDS = {
    "run": ("run", CASE, "--seconds", "0.1"),
    "worst": ("worst", CASE, "--budget", "data age"),
    "error": ("run", "timing/─.toml"),
}
SAME = {"─": "-", "┌": "+", "┐": "+", "└": "+", "┘": "+", "░": ":"}  # the characters of tables and diagrams


def printed(encoding: str, arguments: tuple[str, ...]) -> tuple[int, str, str]:
    """Return exit status, standard output and standard error of a command whose streams have this encoding."""
    given = {**os.environ, "PYTHONIOENCODING": encoding, "COLUMNS": "80"}
    came = subprocess.run(
        [sys.executable, "-m", "periph_sim", *arguments], env=given, capture_output=True, cwd=TIMING.parent
    )
    return came.returncode, came.stdout.decode(encoding), came.stderr.decode(encoding)


@pytest.mark.parametrize("name", COMMANDS)
def test_a_character_that_the_encoding_lacks_is_printed_as_one_ascii_character(name: str) -> None:
    status, out, error = printed("utf-8", COMMANDS[name])
    plain_status, plain_out, plain_error = printed("cp1252", COMMANDS[name])
    assert plain_status == status and "Traceback" not in plain_error
    assert bool(plain_error) == bool(error)
    for drawn, plain in zip_longest(out, plain_out):
        assert plain == drawn or plain == SAME[drawn]


def test_json_escapes_all_characters_beyond_ascii(tmp_path: Path) -> None:
    text = (TIMING / "imu_hil.toml").read_text(encoding="utf-8").replace('"data age"', '"age ─ µ"')
    case = tmp_path / "case.toml"
    case.write_text(text, encoding="utf-8")
    assert "─" in text, "the case has no budget 'data age' any more"
    _, out, _ = printed("cp1252", ("run", str(case), "--seconds", "0.1", "--json"))
    assert "age ─ µ" in [budget["name"] for budget in json.loads(out)["budgets"]]
