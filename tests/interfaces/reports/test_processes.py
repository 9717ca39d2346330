"""Worker processes: as fresh ones, with folder and environment as they are now, and the package imported already."""

from __future__ import annotations

import os
import sys
from multiprocessing import get_all_start_methods
from pathlib import Path

import pytest

from periph_sim.interfaces.reports import processes as of
from periph_sim.interfaces.reports.processes import processes


def stands() -> tuple[str, str, list[str]]:
    """Folder, a variable, and the firmware modules of the process that calls it."""
    return os.getcwd(), os.environ.get("PERIPH_SIM_TRIED", ""), [name for name in sys.modules if "_firmware_" in name]


def imported() -> set[str]:
    """Of what is to be imported, that which stood in the process before the work was sent."""
    return set(of.IMPORTED) & BEFORE


BEFORE = set(sys.modules)


@pytest.mark.parametrize("start", [one for one in get_all_start_methods() if one != "fork"])
def test_workers_have_folder_and_environment_as_they_are_now(
    start: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(of, "SERVER", start)  # another way to start: where there is no server
    monkeypatch.setattr(of, "get_all_start_methods", lambda: ["spawn"] if start == "spawn" else [start])
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        monkeypatch.chdir(tmp_path / name)
        monkeypatch.setenv("PERIPH_SIM_TRIED", name)
        with processes(1) as pool:
            assert pool.submit(stands).result() == (str(tmp_path / name), name, [])


@pytest.mark.skipif(of.SERVER not in get_all_start_methods(), reason="no server forks here")
def test_workers_find_the_package_imported() -> None:
    with processes(1) as pool:
        assert pool.submit(imported).result() == set(of.IMPORTED)
