"""The .psr format: records, the arrays that numpy reads, runs read as captures, and damaged files."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Callable, Iterable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.core.records import RECORDED, Kind, Record
from periph_sim.traces import formats
from periph_sim.traces.formats import psr
from periph_sim.traces.formats.record_table import BLOCK, Columns, RecordTable
from tests.profiles import examples
from tests.refusals import refusal
from tests.traces.formats.looks import edges, facts

NAMES = st.sampled_from(["SCL", "SDA", "dsp.I2C-A", "", "ein Rücken", "\ud800", "a\nb"])
INT64 = st.integers(-(1 << 63), (1 << 63) - 1)


@st.composite
def runs(draw: st.DrawFn) -> list[Record]:
    ticks = sorted(draw(st.lists(st.integers(0, 1 << 62), max_size=20)))
    kinds = st.sampled_from(RECORDED)
    return [
        Record(
            n,
            tick,
            draw(kinds),
            draw(NAMES),
            draw(NAMES),
            draw(INT64),
            draw(NAMES),
            draw(st.integers(0, n)),
            draw(NAMES),
        )
        for n, tick in enumerate(ticks, 1)
    ]


def table_of(records: Iterable[Record], per_second: Fraction, end: int) -> RecordTable:
    columns = Columns()
    for record in records:
        columns.add(record)
    return columns.table(per_second, end, {}, {})


def saved(path: Path, records: list[Record], end: int = 0) -> Path:
    with path.open("wb") as file:
        psr.write_table(table_of(records, Fraction(3 * 10**9), end), file)
    return path


@pytest.mark.parametrize("count", [BLOCK - 1, BLOCK, 2 * BLOCK + 1])
def test_more_records_than_a_block_are_kept_in_order(count: int):
    records = [
        Record(n, 3 * n, RECORDED[n % 3], f"at {n % 5}", f"{n % 7}", -n, f"text {n % 11}", n // 2, f"field {n % 13}")
        for n in range(1, count + 1)
    ]
    assert list(table_of(records, Fraction(1), 9).records()) == records


@given(runs())
@settings(max_examples=examples(40), deadline=None)
def test_records_are_written_and_read(tmp_path_factory: pytest.TempPathFactory, records: list[Record]):
    table = psr.read_table(saved(tmp_path_factory.mktemp("psr") / "run.psr", records, 1 << 62))
    assert list(table.records()) == records
    assert (table.per_second, table.end, len(table)) == (3 * 10**9, 1 << 62, len(records))


RUN = [
    Record(1, 0, Kind.EDGE, "MODEL", "level", 0, "dsp.GPIO34", 0),
    Record(2, 30, Kind.FLAG, "dsp.I2C-A", "I2CSTR.BB", 1, "", 1),
    Record(3, 60, Kind.EDGE, "SDA", "level", 0, "controller", 0),
    Record(4, 60, Kind.EDGE, "SDA", "level", 1, "", 0),
    Record(5, 90, Kind.EDGE, "SDA", "level", 0, "controller", 3),
    Record(6, 95, Kind.EDGE, "MODEL", "level", 1, "", 0),
    Record(7, 120, Kind.NOTE, "dsp", "duty", 1, "a note", 0),
]


def test_columns_and_lookups(tmp_path: Path):
    table = psr.read_table(saved(tmp_path / "run.psr", RUN))
    assert table.rows(Kind.EDGE).tolist() == [0, 2, 3, 4, 5]
    assert table.rows(Kind.EDGE, "SDA").tolist() == [2, 3, 4]
    assert table.rows(where="dsp.I2C-A", what="I2CSTR.BB").tolist() == [1]
    assert table.rows(where="nowhere").tolist() == []
    assert table.tick[table.rows(Kind.EDGE)].tolist() == [0, 60, 60, 90, 95]
    assert table.texts("text", table.rows(Kind.NOTE)) == ["a note"]
    assert list(table.records(table.rows(Kind.FLAG))) == [RUN[1]]
    assert table.value.dtype == table.tick.dtype == table.cause.dtype == np.int64


def test_numpy_can_open_a_file(tmp_path: Path):
    with np.load(saved(tmp_path / "run.psr", RUN)) as found:
        head = json.loads(found["head"].tobytes())
        assert np.cumsum(found["tick"]).tolist() == [record.tick for record in RUN]
        where = np.array(head["topics"])[found["topic"], 1]
        assert [head["names"]["where"][place] for place in where] == [record.where for record in RUN]
    assert (head["format"], head["version"], head["ticks_per_second"]) == ("periph-sim records", 3, 3 * 10**9)


@pytest.mark.parametrize(("end", "length"), [(200, 200), (95, 96), (0, 96)])
def test_a_run_can_be_read_as_a_capture_of_its_wires(tmp_path: Path, end: int, length: int):
    capture = formats.read(saved(tmp_path / "run.psr", RUN, end))
    assert edges(capture) == {"MODEL": [0, 95], "SDA": [1, 90]}  # low at 0; a level of zero duration is not an edge
    assert facts(capture) == (3 * 10**9, length, False)


def test_a_run_is_read_on_the_grid_of_a_rate_or_rejected(tmp_path: Path):
    path = saved(tmp_path / "run.psr", RUN, 150)
    assert edges(formats.read(path, Fraction(200_000_000 * 3))) == {"MODEL": [0, 19], "SDA": [1, 18]}
    assert refusal(formats.BadCapture, formats.read, path, Fraction(100_000_000)) == (
        f"{path}, its times: found an edge at position 95 of 3000000000 a second, expected times on the grid of "
        "100000000 Hz; state the right rate or none"
    )


def test_a_time_beyond_64_bits_at_the_rate_is_rejected(tmp_path: Path):
    path = saved(tmp_path / "run.psr", RUN, 1 << 61)
    assert refusal(formats.BadCapture, formats.read, path, Fraction(12 * 10**9)) == (
        f"{path}, its times: found sample {1 << 63} of 12 GHz, expected at most {1 << 62}; state the right rate or none"
    )


def test_a_run_without_edges_cannot_be_read_as_a_capture(tmp_path: Path):
    path = saved(tmp_path / "run.psr", RUN[6:])
    assert psr.holds_run(path) and len(psr.read_table(path)) == 1
    with pytest.raises(formats.BadCapture, match=r"found no edge of a wire, expected edges; record a run in which"):
        formats.read(path)


def test_holds_run_is_true_only_for_runs(tmp_path: Path):
    formats.write(formats.read(saved(tmp_path / "run.psr", RUN)), tmp_path / "capture.psr")
    (tmp_path / "x.vcd").write_text("$date $end")
    (tmp_path / "broken.psr").write_bytes((tmp_path / "run.psr").read_bytes()[:100])
    whole = (tmp_path / "run.psr").read_bytes()
    (tmp_path / "flipped.psr").write_bytes(whole[:60] + bytes(byte ^ 0xFF for byte in whole[60:90]) + whole[90:])
    names = ("run.psr", "capture.psr", "x.vcd", "broken.psr", "flipped.psr", "none.psr")
    assert [psr.holds_run(tmp_path / name) for name in names] == [True, False, False, False, False, False]


@pytest.mark.parametrize("kept", [100, 700, None], ids=["cut early", "cut late", "flipped"])
def test_the_message_about_a_damaged_file_says_that_salvage_is_impossible(tmp_path: Path, kept: int | None):
    path = saved(tmp_path / "run.psr", RUN)
    whole = path.read_bytes()
    flipped = whole[:60] + bytes(byte ^ 0xFF for byte in whole[60:90]) + whole[90:]
    path.write_bytes(flipped if kept is None else whole[:kept])
    said = rejection(path, formats.read)
    assert said.endswith("; copy or record it again")
    assert (
        refusal(formats.BadCapture, formats.read, path, salvage=True)
        == f"{path}, {said}, since --salvage reads no part of a file of this format"
    )


def test_an_undamaged_file_is_read_with_salvage_and_other_errors_do_not_mention_it(tmp_path: Path):
    path = saved(tmp_path / "run.psr", RUN)
    assert facts(formats.read(path, salvage=True)) == facts(formats.read(path))
    with pytest.raises(formats.BadCapture, match=r"; read it with the newer periph-sim it is from$"):
        formats.read(changed(path, lambda head: head.update(version=4)), salvage=True)


def changed(path: Path, change: Callable[[dict[str, Any]], object]) -> Path:
    """Write the file again with a changed head. Return its path."""
    with np.load(path) as found:
        arrays = dict(found)
    head = json.loads(arrays["head"].tobytes())
    change(head)
    return packed(path, arrays | {"head": np.frombuffer(json.dumps(head).encode(), np.uint8)})


def packed(path: Path, arrays: dict[str, Any]) -> Path:
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)
    path.write_bytes(buffer.getvalue())
    return path


@pytest.mark.parametrize(
    ("most", "stored"), [(127, "int8"), (128, "int16"), (1 << 15, "int32"), (1 << 31, "int64"), (-128, "int8")]
)
def test_columns_have_the_smallest_sufficient_type(tmp_path: Path, most: int, stored: str):
    records = [
        Record(1, 1 << 40, Kind.FLAG, "a", "b", most, "", 0),
        Record(2, (1 << 40) + 1, Kind.FLAG, "a", "b", 0, "", 1),
    ]
    path = saved(tmp_path / "run.psr", records)
    with np.load(path) as found:
        assert {name: str(found[name].dtype) for name in ("tick", "value", "cause")} == {
            "tick": "int64",
            "value": stored,
            "cause": "int8",
        }
    assert list(psr.read_table(path).records()) == records


def rejection(path: Path, read: Callable[[Path], object] = psr.read_table) -> str:
    return refusal(formats.BadCapture, read, path).removeprefix(f"{path}, ")


@pytest.mark.parametrize(
    ("key", "value", "sentence"),
    [
        ("version", 4, "head.npy: found version 4, expected up to 3; read it with the newer periph-sim it is from"),
        ("version", 2, "head.npy: found version 2, expected version 3; record it again"),
        ("version", "1", "head.npy: found version '1', expected version 3; record it again"),
        (
            "format",
            "other",
            "head.npy: found another kind of file, expected the format 'periph-sim records'; "
            "give a recording of periph-sim",
        ),
        (
            "end",
            -1,
            "head.npy: found ValueError no count: -1, expected names, end and rate; copy or record it again",
        ),
        (
            "ticks_per_second",
            "1/0",
            "head.npy: found ZeroDivisionError Fraction(1, 0), expected names, end and rate; copy or record it again",
        ),
        (
            "names",
            {"kind": ["edge"], "where": ["a"], "what": ["b"], "text": ["c"], "field": [""]},
            "head.npy, topics: found place 7, expected places in a table of 1 names; copy or record it again",
        ),
        (
            "topics",
            [],
            "topic.npy: found places 0 to 3, expected places in a table of 0 topics; copy or record it again",
        ),
        (
            "topics",
            [[0, 0]],
            "head.npy: found ValueError a topic without its three places, expected topics; copy or record it again",
        ),
        (
            "topics",
            3,
            "head.npy: found TypeError 'int' object is not iterable, expected topics; copy or record it again",
        ),
        (
            "names",
            {
                "kind": ["edge"] * 7 + ["dream"],
                "where": ["a"] * 9,
                "what": ["b"] * 9,
                "text": ["c"] * 9,
                "field": [""],
            },
            "head.npy: found records of kind 'dream', expected edge, access, flag, irq, span, bus, frame, note, wait, "
            "hold; copy or record it again",
        ),
    ],
)
def test_an_invalid_head_is_reported_in_one_sentence(tmp_path: Path, key: str, value: object, sentence: str):
    assert rejection(changed(saved(tmp_path / "run.psr", RUN), lambda head: head.update({key: value}))) == sentence


def test_invalid_columns_are_reported_in_one_sentence(tmp_path: Path):
    with np.load(saved(tmp_path / "run.psr", RUN)) as found:
        arrays = dict(found)
    path = tmp_path / "x.psr"
    assert rejection(packed(path, arrays | {"tick": arrays["tick"][:3]})).startswith("its columns: found lengths {")
    packed(path, arrays | {"tick": -arrays["tick"]})
    assert rejection(path, formats.read) == (
        "tick.npy: found an edge before the one above, expected times that rise from 0; copy or record it again"
    )
    assert rejection(packed(path, arrays | {"tick": arrays["tick"].astype(float)})) == (
        "tick.npy: found an array of float64, shape (7,), in 184 bytes, expected one column of int8, int16, int32, "
        "int64; copy or record it again"
    )
    del arrays["cause"]
    assert rejection(packed(path, arrays)) == (
        "the zip: found no member cause.npy, expected one; copy or record it again"
    )


def test_a_small_file_with_much_unpacked_content_is_rejected(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path = saved(tmp_path / "run.psr", RUN)
    monkeypatch.setattr(psr, "MOST_BYTES", 1000)
    assert "bytes unpacked, expected at most 1000; record a shorter run" in rejection(path)


def test_an_array_larger_than_its_member_is_rejected(tmp_path: Path):
    path = saved(tmp_path / "run.psr", RUN)
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    huge = members["value.npy"].replace(
        b"'shape': (7,), }                    ", b"'shape': (999999999999999,), }      "
    )
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in (members | {"value.npy": huge}).items():
            archive.writestr(name, content)
    assert "value.npy: found an array of int8, shape (999999999999999,), in 135 bytes" in rejection(path)


@given(place=st.integers(0, 3000), byte=st.integers(0, 255), cut=st.booleans())
@settings(max_examples=examples(40), deadline=None)
def test_damaged_bytes_give_a_valid_table_or_one_sentence(
    tmp_path_factory: pytest.TempPathFactory, place: int, byte: int, cut: bool
):
    path = saved(tmp_path_factory.mktemp("psr") / "run.psr", RUN)
    content = bytearray(path.read_bytes())
    place %= len(content)
    content[place] = byte
    path.write_bytes(content[:place] if cut else content)
    for read in (psr.read_table, psr.read):
        try:
            read(path)
        except formats.BadCapture as error:
            assert str(error).startswith(f"{path}, ") and "\n" not in str(error)
