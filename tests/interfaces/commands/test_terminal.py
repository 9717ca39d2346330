"""`periph-sim terminal` on a pseudo-terminal, from the first line to the verdict, and rejected options."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.interfaces.commands.conftest import Run
from tests.outside.live.echo import written

pytest.importorskip("serial", reason="pyserial is not installed: the extra live has it")


class TerminalSession:
    """The command on a pseudo-terminal, whose user's end is `file`."""

    def __init__(self, case: Path, *options: str) -> None:
        self.file, its = os.openpty()
        command = [sys.executable, "-m", "periph_sim", "terminal", str(case), *options]
        self._process = subprocess.Popen(command, stdin=its, stdout=its, stderr=its)
        os.close(its)
        self._output = ""  # text read after that for which `until` waited last

    def until(self, end: str) -> str:
        """Wait until the further output contains this text, and return the output up to it."""
        while end not in self._output:
            self._output += os.read(self.file, 1000).decode()
        shown, _, self._output = self._output.partition(end)
        return shown + end

    def ended(self) -> int:
        status = self._process.wait(60)
        os.close(self.file)
        return status


@pytest.mark.posix("pseudo-terminals")
def test_the_sci_answers_typed_characters(tmp_path: Path) -> None:
    log = tmp_path / "live.jsonl"
    typed = TerminalSession(written(tmp_path), "--log", str(log))
    assert "scia of " in typed.until("115200 8n1; Ctrl-] ends it, Ctrl-T Ctrl-H helps")
    for key, answer in ((b"a", "b"), (b"x", "y")):
        os.write(typed.file, key)
        assert key.decode() not in typed.until(answer)
    os.write(typed.file, b"\x1d")
    shown = typed.until("lateness: 99 % of")
    assert typed.ended() == 0
    assert "echo: NOT JUDGED" in shown and "2 SCI bytes" in shown
    assert log.stat().st_size > 200


@pytest.mark.posix("pseudo-terminals")
def test_a_session_that_ends_with_an_error_shows_it(tmp_path: Path) -> None:
    case = written(tmp_path)
    (tmp_path / "echo_firmware.py").write_text("def main(dsp, settings):\n    dsp.compute(1000)\n    1 / 0\n")
    typed = TerminalSession(case)
    typed.until("the session has ended; press a key")
    os.write(typed.file, b"a")
    typed.until("ZeroDivisionError")
    assert typed.ended() == 2


@pytest.mark.parametrize(
    ("more", "sentence"),
    [
        ((), "standard input is no terminal; a script opens f28335://{case}?port=scia&pace=1 with pyserial"),
        (("--pace", "0"), "--pace 0: typing needs real time"),
        (("--pace", "x"), "--pace 'x': expected a number"),
    ],
)
def test_wrong_options_are_one_error_message(
    periph_sim: Run, tmp_path: Path, more: tuple[str, ...], sentence: str
) -> None:
    case = written(tmp_path)
    assert sentence.format(case=case) in periph_sim.refused("terminal", str(case), *more)
