"""DSView sessions, which have one bit per sample and one file per channel and block."""

from __future__ import annotations

import zipfile
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.traces import formats
from periph_sim.traces.capture import size_limits as limits
from periph_sim.traces.formats import BadCapture, Capture, Span, session_archive
from tests.profiles import examples
from tests.refusals import refusal
from tests.traces.formats.looks import edges, facts
from tests.traces.formats.writers import dsl_bytes, zip_bytes

SCL = [1] * 40 + [0] * 30 + [1] * 30
SDA = [0] * 5 + [1, 0] * 47 + [1]


def read(tmp_path: Path, content: bytes, salvage: bool = False) -> Capture:
    path = tmp_path / "x.dsl"
    path.write_bytes(content)
    return formats.read(path, salvage=salvage)


def changes(levels: list[int]) -> list[int]:
    """The initial level and the positions of its changes."""
    return [levels[0], *(n for n, (a, b) in enumerate(pairwise(levels), 1) if a != b)]


@pytest.mark.parametrize("version", [2, 3])
def test_channels_in_blocks(tmp_path: Path, version: int):
    capture = read(tmp_path, dsl_bytes({"SCL": SCL, "SDA": SDA}, "10 MHz", version=version))
    assert edges(capture) == {"SCL": [1, 40, 70], "SDA": [0, 5, *range(6, 100)]}
    assert (*facts(capture), capture.notes) == (10_000_000, 100, True, ())


@given(
    st.lists(st.integers(0, 1), min_size=1, max_size=300),
    st.integers(1, 20),
    st.integers(1, 20),
)
@settings(max_examples=examples(40), deadline=None)
def test_any_samples_are_read(tmp_path_factory: pytest.TempPathFactory, levels: list[int], block: int, piece: int):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(session_archive, "BLOCK", piece)
        capture = read(tmp_path_factory.mktemp("dsl"), dsl_bytes({"a": levels}, "1 MHz", block))
    assert (edges(capture), capture.length) == ({"a": changes(levels)}, len(levels))


def test_disabled_channels_have_no_blocks(tmp_path: Path):
    content = dsl_bytes({"SCL": SCL, "SDA": SDA}, "10 MHz", probe2="off", probe9="off")
    assert list(edges(read(tmp_path, content))) == ["SCL", "SDA"]


def test_folders_with_other_numbers_than_the_probes_are_read_in_order(tmp_path: Path):
    path = tmp_path / "y.zip"
    path.write_bytes(dsl_bytes({"SCL": SCL, "SDA": SDA}, "10 MHz"))
    with zipfile.ZipFile(path) as archive:
        members = {
            name.replace("L-1/", "L-7/").replace("L-0/", "L-3/"): archive.read(name) for name in archive.namelist()
        }
    assert list(edges(read(tmp_path, zip_bytes(members))).values()) == [[1, 40, 70], [0, 5, *range(6, 100)]]


def test_a_session_is_recognized_by_its_content(tmp_path: Path):
    path = tmp_path / "capture.zip"
    path.write_bytes(dsl_bytes({"SCL": SCL}, "10 MHz"))
    assert edges(formats.read(path)) == {"SCL": [1, 40, 70]}


def test_without_a_samplerate_positions_have_no_time(tmp_path: Path):
    capture = read(tmp_path, dsl_bytes({"SCL": SCL}, "0"))
    assert (capture.rate, capture.notes) == (None, ("the file states no samplerate, so positions have no time",))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (dsl_bytes({"a": SCL}, "1 MHz", version=4), "header: found version '4', expected version 2 or 3; "),
        (dsl_bytes({"a": SCL}, "fast"), "header, samplerate: found 'fast', expected a rate such as 4 MHz; "),
        (dsl_bytes({"a": SCL}, "1 MHz", device_mode="1"), "header, device mode: found 1, expected 0, logic; "),
        (dsl_bytes({"a": SCL}, "1 MHz", total_blocks="5"), "L-0/4: found nothing, expected a whole DSView session; "),
        (dsl_bytes({"a": SCL}, "1 MHz", total_samples="999"), "its blocks: found 128 samples, expected 999 as the "),
        (zip_bytes({"header": b"[version]\nversion = 3\n[header]\n"}), "the archive: found no probe0, expected logic "),
        (zip_bytes({"version": b"2"}), "the archive: found no member 'header', expected a DSView session; "),
    ],
)
def test_an_error_is_reported_with_its_place(tmp_path: Path, content: bytes, message: str):
    assert refusal(BadCapture, read, tmp_path, content).startswith(f"{tmp_path}/x.dsl, {message}")


def test_too_many_edges_are_rejected(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(limits, "MOST_EDGES", 90)
    with pytest.raises(BadCapture, match="found over 90 edges, expected fewer; cut the capture"):
        read(tmp_path, dsl_bytes({"a": SDA}, "1 MHz"))


def test_with_salvage_a_channel_is_unknown_after_its_damage(tmp_path: Path):
    content = bytearray(dsl_bytes({"SCL": SCL, "SDA": SDA}, "10 MHz"))
    content[content.index(b"L-1/2") + 5] ^= 1
    with pytest.raises(BadCapture, match=r"L-1/2: found bytes that do not fit their CRC-32, .* with --salvage$"):
        read(tmp_path, bytes(content))
    capture = read(tmp_path, bytes(content), salvage=True)
    assert edges(capture) == {"SCL": [1, 40, 70], "SDA": [0, 5, *range(6, 64)]}
    assert [channel.unknown for channel in capture.channels] == [(), (Span(64, 100),)]
    assert capture.notes == (
        "L-1/2 holds bytes that do not fit their CRC-32: its channel is dropped from sample 64 on",
    )


def test_with_salvage_a_cut_file_is_read_up_to_its_end(tmp_path: Path):
    content = dsl_bytes({"SCL": SCL, "SDA": SDA}, "10 MHz")
    capture = read(tmp_path, content[: content.index(b"L-1/1") + 5 + 2], salvage=True)
    assert edges(capture) == {"SCL": [1, 40, 70], "SDA": [0, 5, *range(6, 48)]}
    assert [channel.unknown for channel in capture.channels] == [(), (Span(48, 100),)]
    assert capture.notes[1:] == ("L-1/1 holds 2 bytes instead of 4: its channel is dropped from sample 48 on",)
