"""Selection of the test files that a change reaches: by imports, searched folders, fixtures and names of data."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.touched import touched

PAGES = Path("tests/docs/test_pages.py")


def touched_by(*changed: str) -> list[str]:
    return [str(file) for file in touched([Path(name) for name in changed])]


@pytest.mark.parametrize(
    ("changed", "reached"),
    [
        ("periph_sim/core/wire.py", "tests/core/test_wire.py"),
        ("periph_sim/records/lints/i2c.py", "tests/records/test_lint.py"),
        ("periph_sim/interfaces/commands/lint.py", "tests/interfaces/commands/test_cli.py"),
        ("periph_sim/bus/faults/spike.py", "tests/bus/faults/test_faults.py"),
        ("tests/interfaces/reports/baselines/conftest.py", "tests/interfaces/reports/baselines/test_check.py"),
        ("tests/interfaces/commands/test_cli.py", "tests/interfaces/commands/test_cli.py"),
        ("firmware/python/responder.py", "tests/scene/test_responder.py"),
        ("timing/imu_hil_drift.toml", "tests/interfaces/reports/explain/test_explain.py"),
        ("docs/why.md", "tests/docs/test_pages.py"),
    ],
)
def test_a_change_reaches_this_test_file(changed: str, reached: str):
    assert reached in touched_by(changed)


def test_test_files_that_a_change_does_not_reach_are_left_out():
    of_lint = touched_by("periph_sim/records/lints/i2c.py")
    assert "tests/core/test_wire.py" not in of_lint and str(PAGES) not in of_lint
    assert touched_by("tests/waves.py") != [] and "tests/traces/decode/test_uart_guess.py" not in touched_by(
        "tests/waves.py"
    )
    assert touched_by() == []


def test_the_nearest_test_files_are_first_and_each_is_listed_once():
    files = touched_by(
        "periph_sim/timing/measures/margin.py", "periph_sim/timing/measures/margin.py", "tests/core/test_wire.py"
    )
    assert files[0] == "tests/core/test_wire.py" and len(files) == len(set(files)) > 50
