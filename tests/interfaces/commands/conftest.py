"""The command line as a user meets it: arguments go in, exit status and both outputs come out."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from periph_sim.cli import run_command as main
from periph_sim.interfaces.reports.trade import trade

CASE = """\
name = "small"
duration = "30 ms"

[unit.dsp]
firmware = "{firmware}"
modules = ["I2C-A"]

[controller]
order = ["gyroscope"]

[[budget]]
name = "rounds in time"
measure = "round"
max = "5 ms"
"""


class Came(NamedTuple):
    status: int
    out: str
    err: str


Run = Callable[..., Came]


@pytest.fixture
def periph_sim(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Runs `periph-sim` with the given arguments in this process, 80 columns wide."""

    def run(*arguments: str) -> Came:
        monkeypatch.setenv("COLUMNS", "80")
        monkeypatch.setattr(sys, "argv", ["periph-sim", *arguments])
        with pytest.raises(SystemExit) as ended:
            main()
        out, err = capsys.readouterr()
        assert isinstance(ended.value.code, int)
        return Came(ended.value.code, out, err)

    return run


@pytest.fixture(autouse=True)
def trade_repeats_seldom(monkeypatch: pytest.MonkeyPatch) -> None:
    """`trade` measures each row as few times as it may; tests/interfaces/reports/trade has how often, and why."""
    monkeypatch.setattr(trade, "MOST", trade.FEWEST)


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder to work in, with a small case and firmware that does nothing."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "still.py").write_text("def main(dsp, settings):\n    pass\n", encoding="utf-8")
    (tmp_path / "small.toml").write_text(CASE.format(firmware="still.py"), encoding="utf-8")
    return tmp_path
