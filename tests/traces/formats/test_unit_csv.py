"""CSV with units in its titles: exact numbers, errors with their lines, and any bytes without a traceback."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from periph_sim.traces.formats import BadCapture
from periph_sim.traces.formats.unit_csv import line_of_row, read
from tests.profiles import examples

FINITE = st.floats(allow_nan=False, allow_infinity=False)


@settings(deadline=None, max_examples=examples(40))
@given(st.lists(st.tuples(FINITE, FINITE), min_size=1, max_size=20), st.sampled_from(["\n", "\r\n", "\n\n"]))
def test_numbers_are_read_exactly(tmp_path_factory, rows, end: str):
    path = tmp_path_factory.mktemp("csv") / "f.csv"
    lines = ["time [s],gyroscope_x [deg/s]", *(f"{a!r}, {b!r}" for a, b in rows)]
    path.write_bytes((end.join(lines) + end).encode())
    time, gyroscope = read(path)
    assert (time.name, time.unit, gyroscope.name, gyroscope.unit) == ("time", "s", "gyroscope_x", "deg/s")
    assert np.array_equal(np.stack([time.values, gyroscope.values], axis=1), np.array(rows))
    assert line_of_row(path, len(rows) - 1) == 1 + len(rows) * len(end.replace("\r\n", "\n"))


def judge(path: Path, data: bytes) -> None:
    """Check that reading gives finite numbers, or an error of one sentence."""
    path.write_bytes(data)
    try:
        columns = read(path)
    except BadCapture as error:
        assert str(error).startswith(f"{path}, line ") and "\n" not in str(error)
    else:
        assert columns and all(len(one.values) and np.isfinite(one.values).all() for one in columns)


@settings(deadline=None, max_examples=examples(40))
@given(st.binary(max_size=60))
@example(b"1\n")
@example(b"1_0\n")
@example(b"0x10\n")
@example(b'"1"\n')
@example(b'"1\n')
@example(b"1,\n")
@example(b"\x00\n")
@example(b"\n\n\n")
@example(b"1\r2\r")
@example(b"1e400\n")
@example(b" 1 \n")
@example(b"#1\n")
def test_any_bytes_are_numbers_or_rejected_in_a_sentence(tmp_path_factory, data: bytes):
    judge(tmp_path_factory.mktemp("csv") / "f.csv", b"x [g]\n" + data)


@settings(deadline=None, max_examples=examples(40))
@given(st.binary(max_size=40))
@example(b"")
@example(b"\xff [s]")
@example(b'"x [g]')
@example(b"x []")
@example(b",")
@example(b"\x00")
def test_any_titles_are_accepted_or_rejected_in_a_sentence(tmp_path_factory, data: bytes):
    judge(tmp_path_factory.mktemp("csv") / "f.csv", data + b"\n1\n")


def test_a_folder_is_rejected(tmp_path: Path):
    with pytest.raises(BadCapture, match=r"the file: found is a directory, expected a file that can be read"):
        read(tmp_path)


@pytest.mark.parametrize("length", [100_000, 200_000], ids=["a cell", "more than a cell may hold"])
@pytest.mark.parametrize("text", ["\0", "x [g]\nz"])
def test_the_message_about_a_long_cell_is_short(tmp_path: Path, text: str, length: int):
    (tmp_path / "f.csv").write_text(text + text[-1] * length + "\n")
    with pytest.raises(BadCapture, match=r"line \d: found .*(\d characters\)|field larger than .*), expected") as error:
        read(tmp_path / "f.csv")
    assert len(str(error.value)) < 600
