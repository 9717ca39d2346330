"""Plugins: a user's own chip, from `[tool.periph-sim]` or an entry point, and mistakes in plugins."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from periph_sim import BadCase, FirmwareError, Scene, load
from tests.scene.small import sentence_of

PROJECT = '[tool.periph-sim]\nplugins = ["barometer.py"]\n'
BAROMETER = '''\
"""BARO1, a barometer made up for this test: its pressure is in two registers, high byte first."""

from fractions import Fraction

from periph_sim.core.options import Answers
from periph_sim.core.registers import RegisterMap
from periph_sim.devices.chips.register_chip import RegisterChip, byte_register
from periph_sim.devices.sensor_rounds import ChipData


class Baro1Options(Answers):
    pass


class Baro1(RegisterChip):
    MAP = RegisterMap("BARO1", "sheet", tuple(byte_register(at, f"P{at}", "R", 0x27 + at, "sheet") for at in (0, 1)))
    SECTION = "sheet, register access"
    ADDRESSES = (0x77,)
    OPTIONS = Baro1Options
    lsb_per_unit = Fraction(1)

    def __init__(self, timebase, source, address=0x77, options=None, powered=0):
        super().__init__(timebase, source, address, powered, Fraction(0))


CHIP = Baro1
SENSORS = {"barometer": ChipData(0x77, 0x00, count=2)}
'''
CASE = """\
name = "two sensors"
duration = "30 ms"

[chip.turns]
model = "itg3200"
values = { fixed = [0, 0, 0] }

[chip.pressure]
model = "barometer"
values = { fixed = [0, 0, 0] }

[controller]
period = "10 ms"
order = ["gyroscope", "barometer"]

[[budget]]
name = "acknowledged"
measure = "nacked"
max = 0
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    (tmp_path / "pyproject.toml").write_text(PROJECT, "utf-8")
    (tmp_path / "barometer.py").write_text(BAROMETER, "utf-8")
    (tmp_path / "case.toml").write_text(CASE, "utf-8")
    return tmp_path


def refusal(project: Path) -> str:
    return sentence_of(BadCase, lambda: Scene(load(project / "case.toml")))


def read_of(scene: Scene) -> list[tuple[str, bytes]]:
    """Return the name and the data of each read of a run."""
    found: list[tuple[str, bytes]] = []
    scene.on_transfer(lambda over: found.extend((over.name, bytes(one.got)) for one in over.phases if one.read))
    assert scene.run().verdict == "pass"
    return found


def test_a_controller_reads_a_users_own_sensor_by_its_name(project: Path):
    found = read_of(Scene(load(project / "case.toml")))
    assert len(found) == 6 and found[:2] == [("gyroscope", bytes(6)), ("barometer", bytes.fromhex("2728"))]


@pytest.mark.parametrize("folder", ["", "elsewhere"])
def test_the_command_line_finds_the_plugin_from_any_folder(project: Path, tmp_path: Path, folder: str):
    (tmp_path / "elsewhere").mkdir()
    came = subprocess.run(
        [sys.executable, "-m", "periph_sim", "run", str(project / "case.toml")],
        cwd=tmp_path / folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (came.returncode, came.stderr) == (0, "") and came.stdout.startswith("two sensors: PASS")


def test_an_entry_point_of_an_installed_distribution_is_found(project: Path):
    (project / "pyproject.toml").unlink()
    site = project / "site"
    (site / "baro-1.0.dist-info").mkdir(parents=True)
    (site / "baro-1.0.dist-info" / "METADATA").write_text("Metadata-Version: 2.1\nName: baro\nVersion: 1.0\n", "utf-8")
    (site / "baro-1.0.dist-info" / "entry_points.txt").write_text("[periph_sim]\nbarometer = baro\n", "utf-8")
    (project / "barometer.py").rename(site / "baro.py")

    def run() -> subprocess.CompletedProcess[str]:
        code = f"import sys; sys.path.append({str(site)!r}); from periph_sim.cli import run_command; run_command()"
        command = [sys.executable, "-c", code, "run", str(project / "case.toml")]
        return subprocess.run(command, capture_output=True, text=True, check=False)

    came = run()
    assert (came.returncode, came.stderr) == (0, "") and came.stdout.startswith("two sensors: PASS")
    (site / "baro.py").write_text("x = 1\nraise RuntimeError('no driver')\n", "utf-8")
    came = run()
    assert came.returncode == 2 and came.stderr == (
        "Error: entry point 'barometer' of periph_sim, baro: it cannot be loaded: "
        "line 2 of baro.py: RuntimeError: no driver\n"
    )


def test_a_name_that_no_plugin_has_is_refused_with_those_that_are_known(project: Path):
    (project / "case.toml").write_text(CASE.replace('"barometer"]', '"baromter"]'), "utf-8")
    assert "there is no chip 'baromter'; did you mean barometer or " in refusal(project)


@pytest.mark.parametrize(
    ("source", "sentence"),
    [
        ("import nothing_there\n", "barometer.py cannot be loaded: No module named 'nothing_there'"),
        (
            "\n\nx = 1 / 0\n",
            "barometer.py cannot be loaded: line 3 of barometer.py: ZeroDivisionError: division by zero",
        ),
        ("SENSORS = (\n", "barometer.py cannot be loaded: line 1: '(' was never closed"),
    ],
)
def test_a_plugin_that_cannot_be_imported_is_named_with_file_and_line(project: Path, source: str, sentence: str):
    (project / "barometer.py").write_text(source, "utf-8")
    place = f"{project / 'pyproject.toml'}, line 2: plugins: "
    assert refusal(project) == place + sentence


def test_a_chip_that_cannot_be_built_is_named_with_its_line(project: Path):
    (project / "barometer.py").write_text(BAROMETER.replace("powered=0):", "powered=0):\n        assert 0"), "utf-8")
    with pytest.raises(FirmwareError, match=r"^chip pressure: AssertionError at line \d+ of barometer.py: no message$"):
        Scene(load(project / "case.toml"))


def test_two_plugins_of_one_name_are_refused_with_file_and_line(project: Path):
    (project / "barometer.py").write_text(BAROMETER.replace('"barometer":', '"gyroscope":'), "utf-8")
    assert refusal(project) == (
        "line 27 of barometer.py: there is a sensor 'gyroscope' already, in periph_sim; give one of them another name"
    )
    (project / "barometer.py").write_text(BAROMETER, "utf-8")
    (project / "more").mkdir()
    (project / "more" / "barometer.py").write_text(BAROMETER, "utf-8")
    both = PROJECT.replace('"]', '", "more/barometer.py"]')
    (project / "pyproject.toml").write_text(both, "utf-8")
    assert refusal(project).startswith("line 26 of barometer.py: there is a chip 'barometer' already, in line 26 of ")


def test_sensors_of_another_type_and_a_missing_file_are_refused(project: Path):
    (project / "barometer.py").write_text(re.sub("SENSORS = .*", "SENSORS = 3", BAROMETER), "utf-8")
    assert refusal(project).startswith("line 27 of barometer.py: SENSORS is 3; expected a dict of names and their ")
    (project / "barometer.py").write_text(BAROMETER.replace("CHIP = Baro1", "CHIP = 7"), "utf-8")
    assert refusal(project) == "line 26 of barometer.py: CHIP is 7; expected a class derived from RegisterChip"
    (project / "barometer.py").unlink()
    assert refusal(project).endswith("plugins: there is no file 'barometer.py'; its path counts from this file")
