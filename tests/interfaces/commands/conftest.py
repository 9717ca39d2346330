"""The command line as a user meets it: arguments go in, exit status and both outputs come out."""

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


BESIDES = ("Usage: ", "Try ", "\t", "note: ")  # beginnings of lines on standard error beside the sentence of an error


class Came(NamedTuple):
    status: int
    out: str
    err: str

    @property
    def told(self) -> Any:
        """The JSON object on standard output."""
        return json.loads(self.out)


class Run:
    """`periph-sim` in this process, 80 columns wide. A call takes the arguments."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
        self._monkeypatch, self._capsys = monkeypatch, capsys

    def __call__(self, *arguments: str) -> Came:
        self._monkeypatch.setenv("COLUMNS", "80")
        self._monkeypatch.setattr(sys, "argv", ["periph-sim", *arguments])
        with pytest.raises(SystemExit) as ended:
            main()
        assert isinstance(ended.value.code, int)
        return Came(ended.value.code, *self._capsys.readouterr())

    def passes(self, *arguments: str) -> str:
        """The output of these arguments, for which the exit status is 0 and standard error is empty."""
        came = self(*arguments)
        assert (came.status, came.err) == (0, ""), came
        return came.out

    def json(self, *arguments: str) -> tuple[int, Any]:
        """The exit status and the JSON object of these arguments and --json."""
        came = self(*arguments, "--json")
        return came.status, came.told

    def refused(self, *arguments: str) -> str:
        """The sentence with which these arguments are refused. Only notes and click's usage may be beside it."""
        came = self(*arguments)
        (said,) = (line for line in came.err.splitlines() if not line.startswith(BESIDES) and line)
        assert (came.status, came.out, said[:7]) == (2, "", "Error: ")
        return said[7:]


@pytest.fixture
def periph_sim(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    return Run(monkeypatch, capsys)


@pytest.fixture(autouse=True)
def trade_repeats_seldom(monkeypatch: pytest.MonkeyPatch) -> None:
    """`trade` measures each row as few times as it may; tests/interfaces/reports/trade has how often, and why."""
    monkeypatch.setattr(trade, "MOST", trade.FEWEST)


@pytest.fixture(autouse=True)
def tables_repeat_seldom(monkeypatch: pytest.MonkeyPatch) -> None:
    """`prove --table` runs few entries again; tests/proof has the number."""
    monkeypatch.setattr(table_proof, "LEAST_REVISITED", 10)


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder to work in."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def cases(here: Path) -> Path:
    """A folder `timing`, which is what `check` takes by itself, with one case and no baseline."""
    put(Path("timing"))
    return Path("timing")


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder to work in, with a small case and firmware that does nothing."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "still.py").write_text("def main(dsp, settings):\n    pass\n", encoding="utf-8")
    (tmp_path / "small.toml").write_text(CASE.format(firmware="still.py"), encoding="utf-8")
    return tmp_path
