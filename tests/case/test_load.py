"""What a case file says, and what comes of it."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.case.load import load
from periph_sim.case.model import Case
from periph_sim.case.settings import duration, frequency, hex_bytes
from periph_sim.case.source import line_of

TIMING = Path(__file__).parents[2] / "timing"
CASES = sorted(TIMING.glob("*.toml"))


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_every_case_of_the_repository_loads_and_is_named_as_its_file(path: Path):
    assert load(path).name == path.stem


def test_defaults_are_those_of_the_sensor_head_and_the_host():
    case = Case.model_validate({"name": "x", "duration": "1 s", "unit": {}, "controller": {}, "host": {}})
    assert case.controller is not None and case.host is not None
    assert (case.controller.rate, case.controller.period, case.controller.jitter) == (100_000, Fraction(1, 50), 0)
    assert (case.host.baud, case.host.period, case.host.gap) == (115_200, Fraction(1, 50), 0)
    assert (case.start, case.seed, case.fidelity, case.strict) == (0, 0, "edge", False)


def test_changes_reach_tables_lists_and_new_keys():
    case = load(
        TIMING / "imu_hil.toml",
        [
            "controller.period = 10 ms",
            "unit.dsp.settings.model_cost=1.5 ms",
            "unit.dsp.options.i2c.some_question=other",
            "budget.response.max=5 us",
            "budget.0.max=7 us",
            'controller.order=["gyroscope"]',
            "host.lose=[[3, 5]]",
            "seed=7",
        ],
    )
    assert case.controller is not None and case.host is not None
    assert case.controller.period == Fraction(1, 100)
    assert case.controller.order == ("gyroscope",)
    assert case.unit["dsp"].settings == {"model_cost": "1.5 ms"}
    assert case.unit["dsp"].options.i2c == {"some_question": "other"}
    assert [b.max for b in case.budget[:2]] == ["7 us", "5 us"]
    assert case.host.lose == ((3, 5),)
    assert case.seed == 7


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        ("250 us", Fraction(1, 4000)),
        ("250us", Fraction(1, 4000)),
        ("1.5 ms", Fraction(3, 2000)),
        ("1/3 us", Fraction(1, 3_000_000)),
        ("0 ns", Fraction(0)),
        ("30 d", Fraction(30 * 86400)),
        ("1e-3 s", Fraction(1, 1000)),
    ],
)
def test_durations_are_exact(text: str, seconds: Fraction):
    assert duration(text) == seconds


@pytest.mark.parametrize(("text", "hertz"), [("100 kHz", 100_000), ("0.5 MHz", 500_000), ("1/3 Hz", Fraction(1, 3))])
def test_frequencies_are_exact(text: str, hertz: Fraction):
    assert frequency(text) == hertz


@pytest.mark.parametrize(("given", "data"), [("1d 00 FF", b"\x1d\x00\xff"), ([1, 255], b"\x01\xff"), ("", b"")])
def test_bytes_are_hexadecimal_or_numbers(given: object, data: bytes):
    assert hex_bytes(given) == data


@pytest.mark.parametrize("given", ["1", "zz", [256], [-1], [True], 3, None])
def test_what_are_no_bytes_is_refused(given: object):
    with pytest.raises(ValueError, match="are no bytes; write for instance"):
        hex_bytes(given)


TEXT = """\
name = "x"
[unit.dsp] # the first
modules = []
[unit.dsp.options.i2c]
answer = 1
[unit."other one"]
modules = []
[controller]
[[controller.request]]
address = 1
[[controller.request]]
address = 2
[[budget]]
name = "a"
[[budget]]
name = "b"
"""


@pytest.mark.parametrize(
    ("place", "line"),
    [
        (("name",), 1),
        (("unit", "dsp"), 2),
        (("unit", "dsp", "modules"), 3),
        (("unit", "dsp", "modules", 0), 3),
        (("unit", "dsp", "pll"), 2),
        (("unit", "dsp", "options", "i2c", "answer"), 5),
        (("unit", "other one", "modules"), 7),
        (("controller", "rate"), 8),
        (("controller", "request", 0, "address"), 10),
        (("controller", "request", 1, "address"), 12),
        (("budget", 1, "name"), 16),
        (("budget", 0, "max"), 13),
        (("host",), 0),
    ],
)
def test_the_line_of_a_place(place: tuple[str | int, ...], line: int):
    assert line_of(TEXT, place) == line
