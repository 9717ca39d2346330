"""Clients of a file as reported by inotify: only the first to open and the last to close are reported."""

from __future__ import annotations

import ctypes
import sys
from pathlib import Path

import pytest

from periph_sim.outside.live.pty_door import Openings


@pytest.mark.skipif(sys.platform != "linux", reason="inotify is a service of Linux")
def test_the_first_to_open_and_the_last_to_close_are_reported(tmp_path: Path) -> None:
    """
    first   ____/~~~~~~~~~\\___________/~\\__
    second  ________/~~~~~~~~~\\_/~\\_______
            0   1   2     3   4       5
    """
    path = tmp_path / "port"
    path.write_bytes(b"abc")
    openings = Openings(str(path))
    assert openings.passed() == (False, False)
    first = path.open("rb")
    assert openings.passed() == (False, True)
    assert first.read() == b"abc"  # reading is not reported
    assert openings.passed() == (False, False)
    second = path.open("rb")
    assert openings.passed() == (False, False)
    first.close()
    assert openings.passed() == (False, False)
    second.close()
    assert openings.passed() == (True, False)
    for _ in range(2):
        path.open("rb").close()
    assert openings.passed() == (True, True)
    openings.close()
    path.open("rb").close()
    assert openings.passed() == (False, False)
    openings.close()


def test_without_inotify_no_client_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ctypes, "CDLL", lambda *_, **__: object())
    path = tmp_path / "port"
    path.touch()
    openings = Openings(str(path))
    path.open("rb").close()
    assert openings.passed() == (False, False)
    openings.close()
