"""CSV export of Saleae Logic 2 and Logic 1.x."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.traces.formats import BadCapture, Capture, Span, saleae_csv
from tests.profiles import examples
from tests.refusals import refusal
from tests.traces.formats.looks import edges, facts


def read(tmp_path: Path, text: str, rate: int | None = None) -> Capture:
    path = tmp_path / "x.csv"
    path.write_bytes(text.encode())
    return saleae_csv.read(path, None if rate is None else Fraction(rate))


LOGIC2 = """Time [s],SDA,SCL
0.000000000,1,1
0.000000120,0,1
0.000000200,1,0
0.000001000,1,0
"""


def test_logic_2_in_nanoseconds(tmp_path: Path):
    capture = read(tmp_path, LOGIC2)
    assert edges(capture) == {"SDA": [1, 120, 200], "SCL": [1, 200]}
    assert (*facts(capture), capture.notes) == (10**9, 1001, False, ())


def test_logic_2_on_the_grid_of_its_rate(tmp_path: Path):
    capture = read(tmp_path, LOGIC2, 125_000_000)
    assert edges(capture) == {"SDA": [1, 15, 25], "SCL": [1, 25]}
    assert facts(capture) == (125_000_000, 126, True)


def test_logic_1_has_spaces_and_fifteen_decimals_and_no_end(tmp_path: Path):
    text = "Time[s], SCL, SDA\r\n0.000000000000000, 1, 1\r\n0.000000500000000, 0, 1\r\n0.000001250000000, 0, 0\r\n"
    capture = read(tmp_path, text)
    assert edges(capture) == {"SCL": [1, 500], "SDA": [1, 1250]}
    assert facts(capture) == (10**9, 1251, False)
    assert capture.notes == ("the format has no row for the end, so the last change is used",)


def test_ticks_have_the_resolution_of_the_times(tmp_path: Path):
    capture = read(tmp_path, "Time[s], a\n0.000000000000000, 1\n0.000000041666667, 0\n")
    assert capture.rate == 10**15 and edges(capture) == {"a": [1, 41666667]}
    assert edges(read(tmp_path, "Time[s], a\n0.000000000000000, 1\n0.000000041666667, 0\n", 24_000_000)) == {
        "a": [1, 1]
    }


@pytest.mark.parametrize("rate", [24_000_000, 6_250_000, 500_000_000, 3_000_000])
@given(st.lists(st.integers(1, 10**9), min_size=1, max_size=20), st.integers(-(10**9), 10**9))
@settings(max_examples=examples(40), deadline=None)
def test_times_with_nine_decimals_are_converted_to_samples_exactly(
    tmp_path_factory: pytest.TempPathFactory, rate: int, steps: list[int], trigger: int
):
    samples = [0]
    for step in steps:
        samples.append(samples[-1] + step)
    rows = []
    for n, sample in enumerate(samples):
        nanoseconds = round(Fraction((sample - trigger) * 10**9, rate))
        sign = "-" if nanoseconds < 0 else ""
        rows.append(f"{sign}{abs(nanoseconds) // 10**9}.{abs(nanoseconds) % 10**9:09},{n & 1}")
    text = "\n".join(["Time [s],a", *rows, ""])
    capture = read(tmp_path_factory.mktemp("csv"), text, rate)
    assert edges(capture) == {"a": [0, *samples[1:]]}


@pytest.mark.parametrize(
    ("text", "found"),
    [
        pytest.param(
            "Time [s],a\n2022-06-24T23:59:59.999999990+02:00,0\n2022-06-25T00:00:00.000000010+02:00,1\n"
            "2022-06-24T22:00:00.5Z,0\n",
            {"a": [0, 20, 500_000_010]},
            id="times of day",
        ),
        pytest.param(
            "Time [s],a,b\n0,0,0\n0.000000001,0,0\n0.000000002,1,1\n\n0.000000003,1,1\n",
            {"a": [0, 2], "b": [0, 2]},
            id="a row can have no change or several",
        ),
        pytest.param(
            "Time [s],a\n-0.5,1\n0,0\n0.00000000025,1\n1,0\n",  # in ticks of 10 ps
            {"a": [1, 5 * 10**10, 5 * 10**10 + 25, 15 * 10**10]},
            id="the number of decimals can differ",
        ),
    ],
)
def test_edges_of_a_text(tmp_path: Path, text: str, found: dict[str, list[int]]):
    assert edges(read(tmp_path, text)) == found


def test_names_can_be_any_text(tmp_path: Path):
    text = '\ufeffTime [s],"clock, slow",SDA  ,"say ""hi"""\n0.0,1,0,1\n'
    assert list(edges(read(tmp_path, text))) == ["clock, slow", "SDA", 'say "hi"']


def test_x_is_unknown(tmp_path: Path):
    text = "Time [s],a,b\n-0.000000004,1,X\n0.000000000,X,X\n0.000000004,0,X\n0.000000008,0,X\n"
    capture = read(tmp_path, text)
    assert [channel.unknown for channel in capture.channels] == [(Span(4, 8),), (Span(0, 13),)]
    assert edges(capture)["a"] == [1, 8]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "line 1: found '', expected Time [s] and channel names; export CSV again"),
        ("Time [s]\n", "line 1: found 'Time [s]', expected Time [s] and channel names; export CSV again"),
        ("Time [s],a\n", "line 2: found no row, expected the levels at the start; export it again"),
        ("Time [s],a\n0.0,1,0\n", "line 2: found 3 columns, expected 2 as in line 1; export it again"),
        ("Time [s],a\n0.0,1\n1.0\n", "line 3: found 1 columns, expected 2 as in line 1; export it again"),
        ("Time [s],a\n0.0,3.3\n", "line 2: found '0.0,3.3', expected a time and 0, 1 or X; export digital data"),
        ("Time [s],a\nnoon,1\n", "line 2: found 'noon,1', expected a time and 0, 1 or X; export digital data"),
        (
            "Time [s],a\n2022-13-01T00:00:00,1\n",
            "line 2: found '2022-13-01T00:00:00,1', expected a time and 0, 1 or X; export digital data",
        ),
        (
            "Time [s],a\n1.0,1\n0.5,0\n",
            "line 3: found a time before that of the row above, expected rising times; export again",
        ),
        (
            "Time [s],a\n0,1\n99999999999,0\n",
            "line 3: found a time beyond 64 bits, expected a shorter capture; state the rate",
        ),
        (
            "Time [s],a\n0,1\n" + "9" * 200_000 + ",0\n",
            "line 3: found field larger than field limit (131072), expected rows of cells; export it again",
        ),
    ],
)
def test_an_error_is_reported_with_its_line(tmp_path: Path, text: str, message: str):
    assert refusal(BadCapture, read, tmp_path, text) == f"{tmp_path}/x.csv, {message}"


def test_a_wrong_rate_is_rejected(tmp_path: Path):
    assert refusal(BadCapture, read, tmp_path, LOGIC2, 100_000_000 // 3) == (
        f"{tmp_path}/x.csv, line 4: found a time between two samples, expected the grid of 33333333 Hz; "
        "state the right rate"
    )


def test_with_salvage_a_file_is_read_up_to_the_error(tmp_path: Path):
    path = tmp_path / "x.csv"
    path.write_text(LOGIC2 + "0.0000020")
    capture = saleae_csv.read(path, salvage=True)
    assert edges(capture) == {"SDA": [1, 120, 200], "SCL": [1, 200]} and capture.length == 1001
    assert capture.notes == ("read up to line 5: line 6: found 1 columns, expected 3 as in line 1; export it again",)
    path.write_text("Time [s],a\nnoon,1\n")
    with pytest.raises(BadCapture, match="found 'noon,1'"):
        saleae_csv.read(path, salvage=True)


def test_times_beyond_64_bits_are_read_with_the_rate(tmp_path: Path):
    capture = read(tmp_path, "Time [s],a\n0,1\n5,0\n99999999999,1\n99999999999.5,1\n", 10)
    assert edges(capture) == {"a": [1, 50, 999999999990]} and capture.length == 999999999996
