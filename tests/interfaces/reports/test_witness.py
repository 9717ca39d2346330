"""Witnesses: cases that show the worst value of a coverage in an ordinary run, from any folder."""

from __future__ import annotations

import json
import shutil
from collections.abc import Sequence
from pathlib import Path

import pytest

from periph_sim import Scene, load
from periph_sim.proof.cover import Worst
from tests.interfaces.commands.conftest import Run, periph_sim
from tests.processor import host_code
from tests.proof.scenes import listener, node, settings_of
from tests.scene.runs import TIMING

__all__ = ["periph_sim"]
LATE = settings_of(begin=9000, busy=420)


def witnesses(periph_sim: Run, case: Path, folder: Path, only: str, changes: Sequence[str] = (), step: int = 1) -> None:
    """Write the witnesses of a coverage, and compare the results of their runs with those that prove printed."""
    folder.mkdir(exist_ok=True)
    sets = [word for change in changes for word in ("--set", change)]
    arguments = ["--phases", only, "--step", str(step), "--jobs", "1", "--witness", str(folder), "--json"]
    result = periph_sim("prove", str(case), "--rounds", "3", *sets, *arguments)
    message = json.loads(result.out)
    judged = {name: one for name, one in message["budgets"].items() if one["verdict"] != "not judged"}
    files = [Path(file) for file in message["written"]]
    assert len({*files}) == len(files) == len(judged) > 0, result
    for file, (name, one) in zip(files, judged.items(), strict=True):
        shown = json.loads(periph_sim("run", str(file), "--json").out)
        (budget,) = (each for each in shown["budgets"] if each["name"] == name)
        assert (budget["worst"], budget["margin"], budget["limit"]) == (one["worst"], one["margin"], one["limit"])


def test_witnesses_of_python_firmware_run_from_any_folder(
    periph_sim: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The case, the witnesses and the current folder are in three different places, with relative paths."""
    (tmp_path / "cases").mkdir()
    listener(tmp_path / "cases")
    monkeypatch.chdir(tmp_path)
    witnesses(periph_sim, Path("cases/listener.toml"), Path("out"), "8 us to 9 us", LATE)
    monkeypatch.chdir("/")
    case = load(tmp_path / "out" / "listener_late.toml")
    assert Scene(case).run().budgets[0].worst > 1  # type: ignore[operator]


@pytest.mark.parametrize(
    ("case", "only", "changes"),
    [
        ("imu_hil_published", "0.0226 ms to 0.0233 ms", ['unit.dsp.settings.frame_cost="200 us"']),
        # `module off` has p50 and max; the value of the coverage is that of max.
        ("imu_hil_image", "0 us to 0.03 us", []),
    ],
)
def test_witnesses_of_package_firmware_and_of_an_image_with_percentiles(
    periph_sim: Run, tmp_path: Path, case: str, only: str, changes: list[str]
) -> None:
    witnesses(periph_sim, TIMING / f"{case}.toml", tmp_path, only, changes)


ECHO = """\
name = "echo"
duration = "7 ms"
[unit.dsp]
sources = ["src/echo.c"]
modules = ["SCI-A", "GPIO"]
compile = { include = ["headers"] }
[[serial.send]]
name = "greeting"
to = "dsp.SCI-A"
text = "h"
at = "6 ms"
[[serial.expect]]
name = "echo"
from = "dsp.SCI-A"
text = "h"
after_send = "greeting"
within = "100 us"
"""


@pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc, which compiles C sources, is not installed")
def test_witnesses_of_c_sources_with_a_folder_of_headers(periph_sim: Run, tmp_path: Path) -> None:
    shipped = Path(host_code.__file__).parent
    for file, folder in (("echo.c", "src"), ("device.h", "headers")):
        (tmp_path / folder).mkdir()
        shutil.copy(shipped / file, tmp_path / folder)
    (tmp_path / "echo.toml").write_text(ECHO, encoding="utf-8")
    witnesses(periph_sim, tmp_path / "echo.toml", tmp_path / "out", "0 us to 0.01 us")


def test_witnesses_of_sends_of_a_serial_protocol(periph_sim: Run, tmp_path: Path) -> None:
    witnesses(periph_sim, node(tmp_path), tmp_path / "out", "0.5 us to 0.6 us")


def test_budgets_with_similar_names_have_separate_files(periph_sim: Run, tmp_path: Path) -> None:
    case = listener(tmp_path)
    text = case.read_text(encoding="utf-8")
    for number, name in enumerate(("la te", "la_te", "ü", "ö")):
        text += (
            f'[[budget]]\nname = "{name}"\nmeasure = "from frame RX end to edge SEEN rise"\nmax = "{9 + number} us"\n'
        )
    case.write_text(text, encoding="utf-8")
    witnesses(periph_sim, case, tmp_path / "out", "8 us to 8.1 us")


def test_witnesses_with_a_tick_shorter_than_a_picosecond(periph_sim: Run, tmp_path: Path) -> None:
    changes = ["unit.dsp.oscclk=29.4912 MHz", *LATE]
    witnesses(periph_sim, listener(tmp_path), tmp_path / "out", "8 us to 8.5 us", changes)


def test_a_worst_value_has_its_seed_and_phases() -> None:
    assert Worst.__struct_fields__ == ("verdict", "phases", "seed")
