"""Output and errors of the commands `periph-sim imu-table` and `periph-sim identify`."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from periph_sim.imu.models.parameters import ImuParameters
from periph_sim.imu.parameter_sets import load
from tests.interfaces.commands.conftest import Run


@pytest.fixture
def rest(desk: Path, periph_sim: Run) -> Path:
    """Write 2000 samples of the models at rest; return the path."""
    came = periph_sim("imu-table", "--samples", "2000", "--write", "rest.csv")
    assert (came.status, came.err) == (0, "")
    return Path("rest.csv")


def test_the_table_shows_simulated_beside_published_values(periph_sim: Run):
    came = periph_sim("imu-table")
    assert came.status == 0
    assert " gyroscope y, deg/s      3.5997    3.5380   3.5375    3.5385      -1.2      -0.6\n" in came.out
    assert periph_sim("imu-table", "--seed", "2").out != came.out


def test_the_turn_of_figure_5_1_with_its_field(periph_sim: Run):
    came = periph_sim("imu-table", "--turn")
    assert came.status == 0
    assert "result: d = 0, H = (0.3239, -0.0447, 0.0060) gauss" in came.out
    assert "\n 180  -0.4835   0.2137  -0.0145           0.0437\n" in came.out


@pytest.mark.parametrize("more", [("--write", "t.csv"), ("--json",)])
def test_the_turn_is_text_only(desk: Path, periph_sim: Run, more: tuple[str, ...]):
    came = periph_sim("imu-table", "--turn", *more)
    assert (came.status, came.out) == (2, "")
    assert f"Error: {more[0]} with --turn: a turn is shown as text only; remove one of them" in came.err
    assert not Path("t.csv").exists()


def test_the_table_as_json(periph_sim: Run):
    found = json.loads(periph_sim("imu-table", "--samples", "500", "--json").out)
    assert (found["samples"], found["seed"], len(found["rows"])) == (500, 1, 9)
    assert found["rows"][0]["mean"]["emulator"] == -0.0301
    assert [len(reading["emulator_mean_off_se"]["gyroscope"]) for reading in found["readings"]] == [3] * 5


def test_identify_reads_written_samples_and_the_models_read_the_identified_set(rest: Path, periph_sim: Run):
    came = periph_sim("identify", "rest.csv", "--expect", "accelerometer_z=-1", "--write-parameters", "set.toml")
    assert (came.status, came.err) == (0, "")
    assert came.out.startswith("rest.csv: 2000 samples, one every 0.02 s\n")
    imu = load(Path("set.toml"))
    assert imu.gyroscope.bias == pytest.approx(ImuParameters().gyroscope.bias, abs=0.01)
    assert imu.accelerometer.noise_density == pytest.approx(ImuParameters().accelerometer.noise_density, rel=0.15)
    again = periph_sim("imu-table", "--samples", "500", "--parameters", "set.toml")
    assert again.status == 0


def test_identified_parameters_as_json(rest: Path, periph_sim: Run):
    found = json.loads(periph_sim("identify", "rest.csv", "--json", "--slow-terms").out)
    y = found["columns"][4]
    assert (y["column"], y["unit"], y["samples"], y["period_s"]) == ("gyroscope_y", "deg/s", 2000, pytest.approx(0.02))
    assert y["lsb"] == pytest.approx(1 / 14.375)
    low, high = y["noise_density"]["interval_95 %"]
    assert low < y["noise_density"]["value"] < high
    assert y["bias_instability"]["told_from_0"] is False
    assert len(y["allan"]["tau_s"]) == len(y["allan"]["deviation"]) == 10


def test_slow_terms_are_shown_with_their_intervals(rest: Path, periph_sim: Run):
    out = periph_sim("identify", "rest.csv", "--slow-terms").out
    assert "gyroscope_z      bias instability  -" in out and "not significant" in out


@pytest.mark.parametrize(
    ("samples", "density"),
    [
        (np.cumsum(np.random.default_rng(3).normal(size=5000)), "4.731e-04 to 3.068e-02"),
        (np.arange(5000.0), "0.000e+00 to 1.877e-02"),  # a ramp, for which the fitted density of white noise is 0
    ],
)
def test_slow_terms_of_a_recording_without_a_region_of_white_noise(
    desk: Path, periph_sim: Run, samples: np.ndarray, density: str
):
    rows = "".join(f"{value!r}\n" for value in samples.tolist())
    Path("walk.csv").write_text(f"x [g]\n{rows}", encoding="utf-8")
    came = periph_sim("identify", "walk.csv", "--rate", "50 Hz", "--slow-terms", "--plot", "walk.svg")
    assert (came.status, came.err) == (0, "")
    (known,) = [line for line in came.out.splitlines() if density in line]
    assert known.split()[-2:] == ["-", "-"], "no rounding and no fitted part is shown"
    assert Path("walk.svg").read_bytes().startswith(b"<?xml")
    found = json.loads(periph_sim("identify", "walk.csv", "--rate", "50 Hz", "--slow-terms", "--json").out)
    assert found["columns"][0]["noise_density"]["fitted_taus_s"] == []


@pytest.mark.parametrize("more", [(), ("--slow-terms",)])
def test_samples_that_alternate_have_no_noise(desk: Path, periph_sim: Run, more: tuple[str, ...]):
    Path("f.csv").write_text("x [g]\n" + "0\n1\n" * 100, encoding="utf-8")
    came = periph_sim("identify", "f.csv", "--rate", "50 Hz", *more)
    assert (came.status, came.out) == (2, "")
    assert came.err.startswith("Error: x: an Allan variance is 0, so there is no noise to be found")


@pytest.mark.parametrize(("name", "begins"), [("allan.svg", b"<?xml"), ("allan.png", b"\x89PNG")])
def test_the_plot_is_complete_and_reproducible(rest: Path, periph_sim: Run, name: str, begins: bytes):
    lines = rest.read_text(encoding="utf-8").splitlines()
    Path("one.csv").write_text("\n".join(",".join(line.split(",")[:2]) for line in lines), encoding="utf-8")
    assert periph_sim("identify", "one.csv", "--plot", name).status == 0
    first = Path(name).read_bytes()
    assert first.startswith(begins)
    periph_sim("identify", "one.csv", "--plot", name)
    assert Path(name).read_bytes() == first
    assert sorted(path.name for path in Path().iterdir() if path.suffix == Path(name).suffix) == [name]


def test_hard_iron_is_the_difference_of_two_recordings(desk: Path, periph_sim: Run):
    chance = np.random.default_rng(1)
    for name, mean in (("with.csv", 0.5), ("without.csv", 0.2)):
        rows = "".join(f"{value!r}\n" for value in (mean + 0.01 * chance.normal(size=1000)).tolist())
        Path(name).write_text(f"field [gauss]\n{rows}", encoding="utf-8")
    came = periph_sim("identify", "with.csv", "--rate", "50 Hz", "--undisturbed", "without.csv", "--json")
    bias = json.loads(came.out)["columns"][0]["bias"]
    assert abs(bias["value"] - 0.3) < 4 * bias["standard_error"] < 0.003


def rows(times: list[float]) -> str:
    return "time [s],x [g]\n" + "".join(f"{time!r},{number % 7}\n" for number, time in enumerate(times))


EVEN = [n * 0.02 for n in range(100)]


@pytest.mark.parametrize(
    ("text", "arguments", "sentence"),
    [
        ("x [g]\n1\n2\n", (), "f.csv: there is no column 'time [s]'; state the rate with --rate: '50 Hz'"),
        ("x [g]\n1\n2\n", ("--rate", "50 Hz"), "x: 2 samples; expected 32 or more"),
        ("time [s]\n1\n2\n", (), "f.csv: the only column is time; expected a sensor's, with its unit"),
        ("time [s],x [g]\n1,1\n", (), "f.csv: there is only one row, so no rate; state it with --rate"),
        (
            "x [g]\n1\nnan\n",
            ("--rate", "50 Hz"),
            "f.csv, line 3: found 'nan', expected a finite number; correct the file",
        ),
        (
            rows(EVEN[:50] + EVEN[51:]),
            (),
            "f.csv, line 52: 0.04 s after the sample before, but usually 0.02 s; give a recording without",
        ),
        (rows(EVEN[::-1]), (), "f.csv, line 3: -0.02 s after the sample before, but usually -0.02 s; give a "),
        (rows(EVEN), ("--expect", "y=1"), "--expect 'y=1': there is no column 'y'; it has x"),
        (rows(EVEN), ("--expect", "x"), "--expect 'x': expected NAME=VALUE"),
        (rows(EVEN), ("--expect", "x=nan"), "--expect 'x=nan': expected a finite number"),
        (rows(EVEN), ("--expect", "x=one"), "--expect 'x=one': 'one' is not a number"),
        (rows(EVEN), ("--plot", "p.gif"), "--plot p.gif: its suffix is '.gif'; expected .svg or .png"),
        (
            rows(EVEN),
            ("--plot", "none/p.svg"),
            "none/p.svg, its place: found no such file or directory, expected a place",
        ),
        (
            rows(EVEN),
            ("--write-parameters", "p.toml"),
            "x: it is not a column of a sensor model; expected accelerometer_x, ",
        ),
        (rows(EVEN), ("--undisturbed", "g.csv"), "g.csv: a sample every 0.04 s; expected every 0.02 s, as in f.csv"),
    ],
)
def test_unusable_recordings_and_arguments_are_refused_and_write_nothing(
    desk: Path, periph_sim: Run, text: str, arguments: tuple[str, ...], sentence: str
):
    Path("f.csv").write_text(text, encoding="utf-8")
    Path("g.csv").write_text(rows([n * 0.04 for n in range(100)]), encoding="utf-8")
    before = sorted(desk.iterdir())
    came = periph_sim("identify", "f.csv", *arguments)
    assert came.status == 2 and came.out == ""
    assert came.err.startswith(f"Error: {sentence}")
    assert sorted(desk.iterdir()) == before


def test_without_scipy_the_error_names_the_package(rest: Path, periph_sim: Run, monkeypatch: pytest.MonkeyPatch):
    import sys

    for name in [name for name in sys.modules if name.startswith(("scipy", "periph_sim.imu.identification"))]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "scipy.special", None)
    monkeypatch.setitem(sys.modules, "scipy", None)
    came = periph_sim("identify", "rest.csv")
    assert came.status == 2
    assert came.err.startswith("Error: identify needs scipy") and "pip install 'periph-sim[sensors]'" in came.err
