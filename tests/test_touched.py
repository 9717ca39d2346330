"""Which test files a change reaches: by imports, by folders that are searched, by fixtures, by names of data."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.touched import touched

PAGES = Path("tests/docs/test_pages.py")


def of(*changed: str) -> list[str]:
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
def test_a_change_reaches(changed: str, reached: str):
    assert reached in of(changed)


def test_what_a_change_does_not_reach_is_left_out():
    of_lint = of("periph_sim/records/lints/i2c.py")
    assert "tests/core/test_wire.py" not in of_lint and str(PAGES) not in of_lint
    assert of("tests/waves.py") != [] and "tests/traces/decode/test_uart_guess.py" not in of("tests/waves.py")
    assert of() == []


def test_the_nearest_come_first_and_each_once():
    files = of(
        "periph_sim/timing/measures/margin.py", "periph_sim/timing/measures/margin.py", "tests/core/test_wire.py"
    )
    assert files[0] == "tests/core/test_wire.py" and len(files) == len(set(files)) > 50
