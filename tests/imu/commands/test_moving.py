"""Output and errors of the command `periph-sim moving`."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from periph_sim.imu.moving import experiment as direct
from tests.interfaces.commands.conftest import Run
from tests.scene.runs import TIMING

CASE = str(TIMING / "imu_moving.toml")
QUICK = (CASE, "--direct", "--seconds", "1")


def test_one_json_object(desk: Path, periph_sim: Run):
    found = json.loads(periph_sim("moving", *QUICK, "--json").out)
    assert (found["rounds"], found["wires"], found["bytes"]) == (50, False, None)


def test_different_bytes_give_status_1(desk: Path, periph_sim: Run, monkeypatch: pytest.MonkeyPatch):
    right = direct.computed_emulator

    def wrong(*given: object) -> object:
        readings = right(*given)
        readings.codes["magnetometer"][5, 2] ^= 0x0101
        return readings

    monkeypatch.setattr("periph_sim.imu.moving.experiment.computed_emulator", wrong)
    came = periph_sim("moving", CASE, "--seconds", "0.2")
    assert came.status == 1
    assert came.out.endswith("\n356 of 360 bytes read from the emulator equal those computed without wires\n")


def test_both_pictures_are_written_to_a_new_folder_and_reproducible(desk: Path, periph_sim: Run):
    names = ["attitudes.svg", "rates.svg"]
    for folder in ("one", "two"):
        assert periph_sim("moving", *QUICK, "--plots", folder).status == 0
        assert sorted(path.name for path in Path(folder).iterdir()) == names
    for name in names:
        one, two = (Path(folder, name).read_bytes() for folder in ("one", "two"))
        assert one == two and len(one) < 150_000
        text = "".join(ElementTree.fromstring(one).itertext())
        assert "time, s" in text and ("emulator, degrees" if name == names[0] else "as built, deg/s") in text


def test_both_pictures_are_written_or_none(desk: Path, periph_sim: Run, monkeypatch: pytest.MonkeyPatch):
    Path("there").mkdir()
    Path("there/attitudes.svg").write_text("before")

    def fails(*given: object) -> None:
        raise np.linalg.LinAlgError("no")

    monkeypatch.setattr("periph_sim.imu.moving.plot.rates", fails)
    for folder in ("there", "new"):
        assert periph_sim("moving", *QUICK, "--plots", folder).status == 3
    assert [path.name for path in Path("there").iterdir()] == ["attitudes.svg"]
    assert Path("there/attitudes.svg").read_text() == "before"
    assert not Path("new").exists()


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("nothing.toml",), "Error: nothing.toml: cannot be read (No such file or directory); give the path of a case"),
        ((str(TIMING / "imu_hil_published.toml"),), "host: a moving experiment needs a motion; give host.motion"),
        ((*QUICK, "--plots", "a/b"), "Error: --plots a/b: no such file or directory"),
        ((*QUICK, "--plots", CASE), "--plots "),
        ((CASE, "--seconds", "x"), "--seconds"),
        ((*QUICK, "--set", "host.motion.kind=srvo"), "there is no motion 'srvo'"),
        (
            (*QUICK, "--set", "host.motion.roll=200 deg"),
            "frame 202, due at 4.044 s: phi is 3.32517, which is 33252 counts of 0.0001",
        ),
        ((*QUICK, "--set", "unit.dsp.settings.arithmetic=q12 saturating x"), "there is no arithmetic"),
    ],
)
def test_impossible_arguments_give_one_sentence_and_status_2(
    desk: Path, periph_sim: Run, arguments: tuple[str, ...], sentence: str
):
    came = periph_sim("moving", *arguments, *(("--seconds", "6") if "host.motion.roll=200 deg" in arguments else ()))
    assert (came.status, came.out) == (2, "")
    assert sentence in came.err and came.err.count("\n") == 1 and "Traceback" not in came.err


def test_a_run_without_rounds_is_refused(desk: Path, periph_sim: Run):
    came = periph_sim("moving", CASE, "--direct", "--seconds", "0")
    assert came.status == 2 and "no round is due before the end" in came.err
    came = periph_sim("moving", CASE, "--seconds", "7 ms")
    assert (came.status, came.err) == (
        2,
        "Error: no round of the three chips was complete before the end; run longer\n",
    )


def test_without_matplotlib_the_error_names_the_package(desk: Path, periph_sim: Run, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    came = periph_sim("moving", *QUICK, "--plots", "new")
    assert (came.status, came.err) == (2, "Error: --plots needs matplotlib: pip install 'periph-sim[sensors]'\n")
    assert not Path("new").exists()
