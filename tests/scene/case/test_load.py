"""Loading a case file: its tables, changes as of `--set`, values with units, and paths."""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.core.convert import BadTable
from periph_sim.core.input_files import inputs_of_one_command, is_input
from periph_sim.core.table import Spread, duration, frequency, hex_bytes, spread
from periph_sim.scene.case.load import apply, load
from periph_sim.scene.case.model import Case

TIMING = Path(__file__).parents[3] / "timing"
CASES = sorted(TIMING.glob("*.toml"))


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_every_case_of_the_repository_loads_and_is_named_as_its_file(path: Path):
    assert load(path).name == path.stem


def test_defaults_are_those_of_the_sensor_head_and_the_host():
    case = Case.model_validate({"name": "x", "duration": "1 s", "unit": {}, "controller": {}, "host": {}})
    assert (case.controller.rate, case.controller.period, case.controller.jitter) == (100_000, Fraction(1, 50), 0)
    assert (case.host.baud, case.host.period, case.host.gap) == (115_200, Fraction(1, 50), 0)
    assert (case.start, case.seed, case.disable, case.strict) == (0, 0, (), False)


def test_the_files_of_a_unit_are_below_the_folder_of_the_case(tmp_path: Path):
    text = """\
name = "x"
duration = "1 ms"
unit.file = { firmware = "code/mine.py", modules = ["SCI-A"] }
unit.shipped = { firmware = "responder", modules = ["SCI-B"] }
unit.image = { image = "code/mine.out", modules = [] }
unit.c = { sources = ["a.c", "b.c"], modules = [], compile = { include = ["inc"], defines = { N = 2 } } }
"""
    (tmp_path / "x.toml").write_text(text)
    unit = load(tmp_path / "x.toml").unit
    assert (unit["file"].firmware, unit["shipped"].firmware) == (f"{tmp_path}/code/mine.py", "responder")
    assert unit["image"].image == f"{tmp_path}/code/mine.out"
    assert unit["c"].sources == (f"{tmp_path}/a.c", f"{tmp_path}/b.c")
    assert unit["c"].compile.include == (f"{tmp_path}/inc",) and unit["c"].compile.defines == {"N": 2}


def test_the_files_that_a_case_names_are_inputs_of_the_command_that_loads_it(tmp_path: Path):
    (tmp_path / "mine.out").touch()
    (tmp_path / "other.out").touch()
    file = tmp_path / "x.toml"
    file.write_text('name = "x"\nduration = "1 ms"\nunit.dsp = { image = "mine.out", modules = [] }\n')
    with inputs_of_one_command():
        load(file)
        assert [name for name in ("x.toml", "mine.out", "other.out") if is_input(tmp_path / name)] == [
            "x.toml",
            "mine.out",
        ]


@pytest.mark.parametrize(("period", "fits"), [("1 us", True), ("999.9999 ns", False)])
def test_the_period_of_rounds_is_at_least_a_microsecond(period: str, fits: bool):
    tables = {"name": "x", "duration": "1 s", "rounds": {"period": period}}
    if fits:
        assert Case.model_validate(tables).rounds is not None
        return
    with pytest.raises(BadTable, match="period is shorter than 1 us"):
        Case.model_validate(tables)


def test_changes_reach_tables_lists_and_new_keys():
    case = load(
        TIMING / "imu_hil_published.toml",
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
    assert case.controller.period == Fraction(1, 100)
    assert case.controller.order == ("gyroscope",)
    assert case.unit["dsp"].settings == {"model_cost": "1.5 ms"}
    assert case.unit["dsp"].options["i2c"] == {"some_question": "other"}
    assert [b.max for b in case.budget[:2]] == ["7 us", "5 us"]
    assert case.host.lose == ((3, 5),)
    assert case.seed == 7
    assert case.changes[-2:] == ("host.lose=[[3, 5]]", "seed=7") and len(case.changes) == 8


def test_a_case_without_a_file_has_none_and_no_changes():
    case = Case.model_validate({"name": "x", "duration": "1 s"})
    assert (case.file, case.folder, case.changes, [*case.files()]) == (None, Path(), (), [])


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


@pytest.mark.parametrize(
    ("text", "least", "most"),
    [("240 us to 260 us", 240, 260), ("250 us", 250, 250), ("0.1ms to 250 us", 100, 250), ("0 us to 0 us", 0, 0)],
)
def test_a_spread_is_two_durations_or_one(text: str, least: int, most: int):
    assert spread(text) == Spread(Fraction(least, 10**6), Fraction(most, 10**6))


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("260 us to 240 us", "'260 us to 240 us': 240 us is shorter than 260 us; write the least first"),
        ("240 to 260 us", "'240' has no unit; write for instance 240 ms"),
        ("240 us to ", "'' has no unit"),
        (250, "250 has no unit"),
        ("-1 us to 2 us", "'-1 us' is negative"),
    ],
)
def test_a_wrong_spread_is_refused_with_its_correction(text: object, sentence: str):
    with pytest.raises(ValueError, match=re.escape(sentence)):
        spread(text)


def test_a_fixed_cost_shifts_a_spread():
    assert spread("240 us to 260 us") + Fraction(12, 10**6) == spread("252 us to 272 us")


@pytest.mark.parametrize(("text", "hertz"), [("100 kHz", 100_000), ("0.5 MHz", 500_000), ("1/3 Hz", Fraction(1, 3))])
def test_frequencies_are_exact(text: str, hertz: Fraction):
    assert frequency(text) == hertz


@pytest.mark.parametrize(("given", "data"), [("1d 00 FF", b"\x1d\x00\xff"), ([1, 255], b"\x01\xff"), ("", b"")])
def test_bytes_are_hexadecimal_or_numbers(given: object, data: bytes):
    assert hex_bytes(given) == data


@pytest.mark.parametrize("given", ["1", "zz", [256], [-1], [True], 3, None])
def test_other_values_than_bytes_are_refused(given: object):
    with pytest.raises(ValueError, match="is not a sequence of bytes; write for instance"):
        hex_bytes(given)


@pytest.mark.parametrize("text", ["20 us", "20 \u00b5s", "20 \u03bcs", "20\u00b5s", "20\u03bcs", " 20 us "])
def test_microseconds_are_written_with_u_micro_sign_or_mu(text: str):
    assert duration(text) == Fraction(20, 1_000_000)


@pytest.mark.parametrize("text", ["_1 us", "1__0 us", "1_ us"])
def test_underscores_are_allowed_between_digits_only(text: str):
    assert duration("1_000 us") == Fraction(1, 1000)
    with pytest.raises(ValueError, match="is not a number"):
        duration(text)


@pytest.mark.parametrize(
    ("text", "value"), [("3_4_5", "3_4_5"), ("1_000", "1_000"), ("1_0.5", "1_0.5"), ("345", 345), ("true", True)]
)
def test_set_keeps_the_underscores_of_a_value(text: str, value: object):
    tree: dict[str, object] = {}
    apply(tree, f"unit.dsp.options.sci.stop_vote_samples={text}")
    assert tree == {"unit": {"dsp": {"options": {"sci": {"stop_vote_samples": value}}}}}


def test_an_answer_of_digits_and_underscores_can_be_set():
    path = Path(__file__).parents[3] / "timing" / "uart_logger.toml"
    loaded = load(path, ["unit.dsp.options.sci.stop_vote_samples=3_4_5", "seed=1_000"])
    assert loaded.unit["dsp"].options["sci"] == {"stop_vote_samples": "3_4_5"}
    assert loaded.seed == 1000


def test_a_byte_order_mark_is_ignored(tmp_path: Path):
    (tmp_path / "marked.toml").write_text('name = "marked"\nduration = "1 ms"\n', encoding="utf-8-sig")
    assert load(tmp_path / "marked.toml").name == "marked"
