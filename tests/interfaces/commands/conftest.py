"""Fixtures that run the command line in this process and return its exit status and both outputs."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from periph_sim.cli import run_command as main
from periph_sim.interfaces.reports.trade import trade
from periph_sim.proof import table_proof
from tests.interfaces.reports.baselines.desk import put

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


BESIDES = ("Usage: ", "Try ", "\t", "note: ")  # how lines on standard error begin that are no error message


class CommandResult(NamedTuple):
    status: int
    out: str
    err: str

    @property
    def json_object(self) -> Any:
        """The JSON object on standard output."""
        return json.loads(self.out)


class Run:
    """`periph-sim` in this process, 80 columns wide. A call takes the arguments."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
        self._monkeypatch, self._capsys = monkeypatch, capsys

    def __call__(self, *arguments: str) -> CommandResult:
        self._monkeypatch.setenv("COLUMNS", "80")
        self._monkeypatch.setattr(sys, "argv", ["periph-sim", *arguments])
        with pytest.raises(SystemExit) as ended:
            main()
        assert isinstance(ended.value.code, int)
        return CommandResult(ended.value.code, *self._capsys.readouterr())

    def passes(self, *arguments: str) -> str:
        """Return the output of a command that must exit with status 0 and print nothing on standard error."""
        result = self(*arguments)
        assert (result.status, result.err) == (0, ""), result
        return result.out

    def json(self, *arguments: str) -> tuple[int, Any]:
        """Return the exit status and the JSON object that the command prints with --json."""
        result = self(*arguments, "--json")
        return result.status, result.json_object

    def refused(self, *arguments: str) -> str:
        """Return the error message of a command that must fail with status 2. Notes and usage may precede it."""
        result = self(*arguments)
        (message,) = (line for line in result.err.splitlines() if not line.startswith(BESIDES) and line)
        assert (result.status, result.out, message[:7]) == (2, "", "Error: ")
        return message[7:]


@pytest.fixture
def periph_sim(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    return Run(monkeypatch, capsys)


@pytest.fixture(autouse=True)
def few_trade_repetitions(monkeypatch: pytest.MonkeyPatch) -> None:
    """Measure each row of `trade` the smallest number of times. tests/interfaces/reports/trade tests that number."""
    monkeypatch.setattr(trade, "MOST", trade.FEWEST)


@pytest.fixture(autouse=True)
def few_table_repetitions(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let `prove --table` repeat few entries only. tests/proof tests the real number."""
    monkeypatch.setattr(table_proof, "LEAST_REVISITED", 10)


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder to work in."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def cases(here: Path) -> Path:
    """A folder `timing`, which `check` uses by default, with one case and no baseline."""
    put(Path("timing"))
    return Path("timing")


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder to work in, with a small case and firmware that does nothing."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "still.py").write_text("def main(dsp, settings):\n    pass\n", encoding="utf-8")
    (tmp_path / "small.toml").write_text(CASE.format(firmware="still.py"), encoding="utf-8")
    return tmp_path
