"""Binary export of Saleae: versions 0 and 1, files and folders."""

from __future__ import annotations

import struct
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.traces import formats
from periph_sim.traces.capture import size_limits as limits
from periph_sim.traces.formats import BadCapture, Capture, Span, saleae_bin
from tests.refusals import refusal
from tests.traces.formats.looks import facts


def version_0(initial: int, begin: float, end: float, times: list[float], kind: int = 0) -> bytes:
    head = struct.pack("<8siiIddQ", b"<SALEAE>", 0, kind, initial, begin, end, len(times))
    return head + struct.pack(f"<{len(times)}d", *times)


def version_1(*chunks: tuple[int, float, float, float, list[float]]) -> bytes:
    content = struct.pack("<8siiQ", b"<SALEAE>", 1, 0, len(chunks))
    for initial, rate, begin, end, times in chunks:
        content += struct.pack("<IdddQ", initial, rate, begin, end, len(times))
        content += struct.pack(f"<{len(times)}d", *times)
    return content


def read(tmp_path: Path, content: bytes, rate: int | None = None) -> Capture:
    path = tmp_path / "digital_3.bin"
    path.write_bytes(content)
    return saleae_bin.read(path, None if rate is None else Fraction(rate))


def test_version_0_in_nanoseconds_or_samples(tmp_path: Path):
    content = version_0(1, 0.0, 1e-6, [120e-9, 200e-9])
    capture = read(tmp_path, content)
    (channel,) = capture.channels
    assert (channel.name, channel.index, channel.initial) == ("digital_3", 3, 1)
    assert channel.edges.tolist() == [120, 200]
    assert facts(capture) == (10**9, 1001, False)
    sampled = read(tmp_path, content, 125_000_000)
    assert sampled.channels[0].edges.tolist() == [15, 25]
    assert facts(sampled) == (125_000_000, 126, True)


def test_version_1_states_its_rate(tmp_path: Path):
    capture = read(tmp_path, version_1((0, 24e6, -1e-3, 1e-3, [-1e-3 + n / 24e6 for n in (3, 7, 1000)])))
    assert capture.channels[0].edges.tolist() == [3, 7, 1000]
    assert facts(capture) == (24_000_000, 48_001, True)


def test_time_between_chunks_is_unknown(tmp_path: Path):
    capture = read(tmp_path, version_1((1, 1e6, 0.0, 9e-6, [4e-6]), (1, 1e6, 20e-6, 29e-6, [25e-6])))
    (channel,) = capture.channels
    assert channel.edges.tolist() == [4, 20, 25]
    assert channel.unknown == (Span(10, 20),)
    assert capture.known(channel) == [Span(0, 10), Span(20, 30)]


def test_a_folder_is_one_capture_of_all_its_digital_files(tmp_path: Path):
    (tmp_path / "digital_0.bin").write_bytes(version_0(0, 1.0, 1.5, [1.25]))
    (tmp_path / "digital_10.bin").write_bytes(version_0(1, 1.0, 1.5, []))
    (tmp_path / "digital_2.bin").write_bytes(version_0(1, 1.1, 1.5, [1.2]))
    (tmp_path / "analog_0.bin").write_bytes(version_0(1, 1.0, 1.5, [], kind=1))
    capture = formats.read(tmp_path, Fraction(1000))
    assert [(c.name, c.edges.tolist(), c.unknown) for c in capture.channels] == [
        ("digital_0", [250], ()),
        ("digital_2", [200], (Span(0, 100),)),
        ("digital_10", [], ()),
    ]


def test_two_changes_at_one_position_cancel_each_other(tmp_path: Path):
    capture = read(tmp_path, version_0(0, 0.0, 1e-6, [1e-10, 100.1e-9, 100.2e-9, 300e-9]))
    (channel,) = capture.channels
    assert (channel.initial, channel.edges.tolist()) == (1, [300])


def test_a_channel_is_unknown_after_the_end_of_its_file(tmp_path: Path):
    (tmp_path / "digital_0.bin").write_bytes(version_0(0, 0.0, 0.5, []))
    (tmp_path / "digital_1.bin").write_bytes(version_0(1, 0.0, 0.2, []))
    capture = formats.read(tmp_path, Fraction(1000))
    assert [channel.unknown for channel in capture.channels] == [(), (Span(201, 501),)]


@given(st.lists(st.integers(1, 10**9), max_size=20), st.floats(-1000, 1000), st.sampled_from([24e6, 500e6, 1e6]))
@settings(deadline=None)
def test_float_seconds_lose_no_sample(
    tmp_path_factory: pytest.TempPathFactory, steps: list[int], begin: float, rate: float
):
    samples = [sum(steps[: n + 1]) for n in range(len(steps))]
    times = [begin + sample / rate for sample in samples]
    end = begin + (sum(steps) + 1) / rate
    capture = read(tmp_path_factory.mktemp("bin"), version_1((0, rate, begin, end, times)))
    assert capture.channels[0].edges.tolist() == samples


GOOD = version_0(1, 0.0, 1e-6, [120e-9, 200e-9])
SALVAGE = ", or read the intact part with --salvage"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "byte 0: found 0 bytes more, expected 8; the file was cut, export it again"),
        (b"x" * 60, "byte 0: found no <SALEAE> mark, expected a Saleae binary export; export it again"),
        (GOOD[:8] + struct.pack("<i", 2) + GOOD[12:], "byte 8: found version 2, expected version 0 or 1; export CSV"),
        (
            version_0(1, 0, 1, [], kind=1),
            "byte 12: found analogue data, expected digital data; export digital data as binary",
        ),
        (
            version_0(1, 0, 1, [], kind=100),
            "byte 12: found a piece of a Logic 2 session, expected digital data; export digital data as binary",
        ),
        (GOOD[:30], "byte 20: found 10 bytes more, expected 24; the file was cut, export it again"),
        (GOOD[:-1], "byte 44: found 15 bytes more, expected 16; the file was cut, export it again" + SALVAGE),
        (
            version_0(2, 0, 1, []),
            "byte 16: found initial level 2, expected 0 or 1; export it again",
        ),
        (
            version_0(1, 0, 1, [0.5, 0.25]),
            "byte 16: found times out of order, expected begin, rising times, end; export it again" + SALVAGE,
        ),
        (
            version_0(1, 0, float("nan"), []),
            "byte 16: found times out of order, expected begin, rising times, end; export it again",
        ),
        (version_0(1, 0, 1e300, []), "its times: found a time beyond 64 bits, expected seconds; export it again"),
        (version_1(), "byte 16: found 0 chunks, expected at least one, all there; export it again"),
        (
            version_1((0, 0.0, 0, 1, [])),
            "byte 24: found sample rate 0.0, expected more than 0; export it again",
        ),
        (
            version_1((0, 1e6, 0, 1, []), (0, 1e6, 0.5, 2, [])),
            "its chunks: found one that begins before the last ends, expected chunks in order; export again" + SALVAGE,
        ),
        (
            version_1((0, 1e6, 0, 1, [1.5e-6])),
            "its times: found a change at 1.5e-06 s, expected the grid of 1e+06 Hz; state the right rate",
        ),
    ],
)
def test_an_error_is_reported_with_its_byte(tmp_path: Path, content: bytes, message: str):
    assert refusal(BadCapture, read, tmp_path, content) == f"{tmp_path}/digital_3.bin, {message}"


def test_an_absurd_number_of_chunks_is_rejected_quickly(tmp_path: Path):
    content = version_1((0, 1e6, 0, 1, []))
    with pytest.raises(BadCapture, match="the file was cut"):
        read(tmp_path, content[:16] + struct.pack("<Q", 1 << 60) + content[24:])


def test_a_folder_without_exports_is_rejected(tmp_path: Path):
    assert refusal(BadCapture, formats.read, tmp_path) == (
        f"{tmp_path}, the folder: found no digital_N.bin, expected one file a channel; export digital data as binary"
    )


@pytest.mark.parametrize(
    ("content", "edges", "unknown", "note"),
    [
        (GOOD[:-1], [120], (Span(121, 1001),), "digital_3.bin ends after 1 of 2 changes: the rest is dropped"),
        (GOOD[:-16], [], (Span(1, 1001),), "digital_3.bin ends after 0 of 2 changes: the rest is dropped"),
        (
            version_0(1, 0, 1e-6, [1e-7, 5e-7, 4e-7, 6e-7]),
            [100, 500],
            (Span(501, 1001),),
            "digital_3.bin has times out of order from byte 60 on: they are dropped",
        ),
        (
            version_1((0, 1e9, 0, 1e-7, [5e-8]), (0, 1e9, 2e-7, 3e-7, []), (2, 1e9, 4e-7, 5e-7, [])),
            [50, 200],
            (Span(101, 200),),
            "byte 104 of digital_3.bin has initial level 2: the rest is dropped",
        ),
    ],
)
def test_salvage_reads_up_to_the_damage(
    tmp_path: Path, content: bytes, edges: list[int], unknown: tuple[Span, ...], note: str
):
    path = tmp_path / "digital_3.bin"
    path.write_bytes(content)
    with pytest.raises(BadCapture):
        formats.read(path)
    capture = formats.read(path, salvage=True)
    (channel,) = capture.channels
    assert (channel.edges.tolist(), channel.unknown, capture.notes) == (edges, unknown, (note,))


def test_too_many_edges_are_rejected_before_reading(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(limits, "MOST_EDGES", 1)
    with pytest.raises(BadCapture, match="its counts: found 2 edges, expected at most 1; export a shorter time"):
        read(tmp_path, GOOD)
