"""Recorded flights: contents of a file, values between its rows, and refused files with the line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.imu.motion import BadMotion
from periph_sim.imu.motion.flight import Settings, motion
from periph_sim.traces.formats import BadCapture
from tests.imu.motion import at_times

HEAD = "time [s],phi [deg],theta [deg],psi [deg],ax [g],ay [m/s^2],az [mg]\n"
GOOD = HEAD + "10,0,0,170,0,0,0\n11,10,-5,-170,1,9.81,100\n\n12.5,10,-5,-170,1,9.81,100\n"


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return Path("flight.csv")


def written(file: Path, text: str) -> Settings:
    file.write_text(text, encoding="utf-8")
    return Settings(file)


def test_values_are_interpolated_linearly_and_yaw_in_the_shorter_direction(file: Path):
    flight = motion(written(file, GOOD))
    times = np.array([0, 0.25, 0.75, 1, 2.5, 100])
    assert np.degrees(at_times.attitudes(flight, times)[:, 2]) == pytest.approx([170, 175, -175, -170, -170, -170])
    assert np.degrees(at_times.attitudes(flight, times)[1]) == pytest.approx([2.5, -1.25, 175])
    assert at_times.accelerations(flight, times)[3] == pytest.approx([1, 1, 0.1])
    assert np.degrees(at_times.rates(flight, np.array([0.5, 1.5]))) == pytest.approx(
        np.array([[10, -5, 20], [0, 0, 0]])
    )
    assert flight.ends == 2.5


def test_columns_may_have_any_order_further_columns_are_ignored_and_yaw_may_be_0_to_360(file: Path):
    text = "az [g],height [m],time [ms],psi [deg],theta [rad],phi [mrad],ax [g],ay [g]\r\n"
    text += "1,99,0,350,0.5,100,0,0\r\n2,98,500,10,0.5,100,0,0\r\n"
    flight = motion(written(file, "\ufeff" + text))
    assert np.degrees(at_times.attitudes(flight, np.array([0.0, 0.25, 0.5]))[:, 2]) == pytest.approx(
        [-10, 0, 10], abs=1e-9
    )
    assert at_times.attitudes(flight, np.array([0.1]))[0, :2] == pytest.approx([0.1, 0.5])


@settings(deadline=None, max_examples=30)
@given(st.lists(st.floats(-180, 180), min_size=1, max_size=12))
def test_a_flight_has_the_angles_of_its_rows_up_to_whole_turns(tmp_path_factory, yaws: list[float]):
    path = tmp_path_factory.mktemp("flight") / "f.csv"
    rows = "".join(f"{n},0,0,{yaw!r},0,0,0\n" for n, yaw in enumerate(yaws))
    flight = motion(written(path, HEAD + rows))
    came = np.degrees(at_times.attitudes(flight, np.arange(len(yaws), dtype=float))[:, 2])
    turns = (came - yaws) / 360
    assert turns == pytest.approx(np.rint(turns), abs=1e-9)
    assert (np.abs(came) <= 180 + 1e-9).all()


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "flight.csv, line 1: found nothing, expected a title such as 'time [s]' or 'phi [deg]' for every column"),
        (HEAD, "flight.csv, line 2: found nothing, expected a row of numbers; correct the file"),
        (GOOD.replace("phi [deg]", "phi"), "flight.csv, line 1: found 'phi', expected a title such as"),
        (GOOD.replace("phi [deg]", "fi [deg]"), "flight.csv, line 1: there is no column 'phi' among 7; "),
        (GOOD.replace("phi [deg]", "ax [deg]"), "flight.csv, line 1: found two columns named 'ax', expected a name of"),
        (
            GOOD.replace("phi [deg]", "phi [g]"),
            "flight.csv, line 1: the unit of phi is 'g'; expected rad or deg or mrad",
        ),
        (
            GOOD.replace("11,10", "10,10"),
            "flight.csv, line 3: time is 10 s; expected more than 10 s, the row before",
        ),
        (
            GOOD.replace("12.5,10", "1,10"),
            "flight.csv, line 5: time is 1 s; expected more than 11 s, the row before",
        ),
        (GOOD.replace("-5,-170,1", "nan,-170,1"), "flight.csv, line 3: found 'nan', expected a finite number; correct"),
        (GOOD.replace("-5,-170,1", "up,-170,1"), "flight.csv, line 3: found 'up', expected a finite number; correct"),
        (GOOD.replace(",100\n\n", "\n\n"), "flight.csv, line 3: found 6 cells, expected 7, as there are titles"),
        (GOOD.replace("-170,1,", "-170,101,"), "flight.csv, line 3: ax is 101 g; expected -100 to 100 g"),
        (GOOD.replace("-170,1,", "-361,1,"), "flight.csv, line 3: psi is -361 deg; expected -360 to 360 deg"),
    ],
)
def test_a_malformed_flight_is_refused_with_its_line(file: Path, text: str, sentence: str):
    with pytest.raises((BadMotion, BadCapture)) as caught:
        motion(written(file, text))
    assert str(caught.value).startswith(sentence)
    assert "\n" not in str(caught.value)


def test_a_missing_file_and_one_that_is_not_text_are_refused(file: Path):
    with pytest.raises(BadCapture, match=r"^flight.csv, the file: found no such file or directory, expected a file"):
        motion(Settings(file))
    file.write_bytes(HEAD.encode() + b"\xff\xfe,1,2,3,4,5,6\n")
    with pytest.raises(BadCapture, match=r"^flight.csv, line 2: found bytes that are not UTF-8"):
        motion(Settings(file))
