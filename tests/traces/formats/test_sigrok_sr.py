"""sigrok sessions: both versions, every sample width, peculiarities of real files, and broken files."""

from __future__ import annotations

import io
import shutil
import subprocess
import tracemalloc
import zipfile
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.traces import formats
from periph_sim.traces.capture import size_limits as limits
from periph_sim.traces.capture.capture import Channel
from periph_sim.traces.formats import BadCapture, Capture, Span, session_archive, sigrok_sr
from tests.profiles import examples
from tests.refusals import refusal
from tests.traces.formats.looks import edges, facts
from tests.traces.formats.make_traces import FOLDER
from tests.traces.formats.sigrok import sigrok_says
from tests.traces.formats.writers import metadata, sr_bytes, zip_bytes

V1 = b"""[global]
sigrok version = 0.2.0
[device 1]
driver = ols
capturefile = logic-1
unitsize = 1
total probes = 32
samplerate = 200 kHz
probe1 = SCL
 trigger1 = 0
probe2 = SDA
 trigger2 = 0
"""


def read(tmp_path: Path, content: bytes, rate: Fraction | None = None):
    path = tmp_path / "x.sr"
    path.write_bytes(content)
    return sigrok_sr.read(path, rate)


def rejection(tmp_path: Path, content: bytes) -> str:
    message = refusal(BadCapture, read, tmp_path, content)
    assert message.startswith(f"{tmp_path}/x.sr, ")
    return message.removeprefix(f"{tmp_path}/x.sr, ")


def session(lines: bytes, **members: bytes) -> bytes:
    """A session with this metadata and these logic members, in whose names `_` is replaced by `-`."""
    return zip_bytes(
        {"version": b"2", "metadata": lines} | {name.replace("_", "-"): data for name, data in members.items()}
    )


def test_version_2_has_chunks_of_any_size(tmp_path: Path):
    capture = read(tmp_path, sr_bytes(["SCL", "SDA"], "4 MHz", b"\3\3\1", b"\1\0", b"\0\0\2"))
    assert edges(capture) == {"SCL": [1, 4], "SDA": [1, 2, 7]}
    assert (*facts(capture), capture.notes) == (4_000_000, 8, True, ())


def test_chunks_are_read_in_numerical_order(tmp_path: Path):
    capture = read(tmp_path, sr_bytes(["a"], "1 MHz", *[bytes([n >= 9]) for n in range(12)]))
    assert edges(capture) == {"a": [0, 9]}


def test_version_1_has_one_member_and_indented_keys(tmp_path: Path):
    capture = read(tmp_path, zip_bytes({"logic-1": b"\3\2\2\3", "metadata": V1, "version": b"1"}))
    assert edges(capture) == {"SCL": [1, 1, 3], "SDA": [1]}
    assert capture.rate == 200_000


@pytest.mark.parametrize("unitsize", range(1, 9))
def test_every_unitsize(tmp_path: Path, unitsize: int):
    top = 8 * unitsize - 1
    names = ["low", *[""] * (top - 1), "high"]
    samples = [1, 1, 1 << top, 0]
    content = b"".join(sample.to_bytes(unitsize, "little") for sample in samples)
    capture = read(tmp_path, sr_bytes(names, "1 MHz", content, unitsize=unitsize))
    assert edges(capture) == {"low": [1, 2], "high": [0, 2, 3]}
    assert [channel.index for channel in capture.channels] == [0, top]


@given(st.lists(st.integers(0, 2**24 - 1), min_size=1, max_size=60), st.integers(1, 7))
@settings(max_examples=examples(40), deadline=None)
def test_any_samples_are_read(tmp_path_factory: pytest.TempPathFactory, samples: list[int], block: int):
    content = b"".join(sample.to_bytes(3, "little") for sample in samples)
    cut = len(content) // 2
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(session_archive, "BLOCK", block)
        capture = read(
            tmp_path_factory.mktemp("sr"),
            sr_bytes([f"p{n}" for n in range(24)], "1 MHz", content[:cut], content[cut:], unitsize=3),
        )
    every = range(len(samples))
    for channel in capture.channels:
        levels = [(channel.initial + sum(edge <= n for edge in channel.edges.tolist())) & 1 for n in every]
        assert levels == [sample >> channel.index & 1 for sample in samples]


def test_bits_of_channels_that_were_not_captured_are_ignored(tmp_path: Path):
    capture = read(tmp_path, sr_bytes(["", "RTS#", "", "RX"], "24 MHz", b"\x0a\x0f\x05\x05\x00"))
    assert edges(capture) == {"RTS#": [1, 2], "RX": [1, 2]}
    assert [channel.index for channel in capture.channels] == [1, 3]


def test_channels_without_names_are_numbered(tmp_path: Path):
    lines = b"[device 1]\ncapturefile=logic-1\ntotal probes=3\nsamplerate=1 MHz\nunitsize=1\n"
    assert list(edges(read(tmp_path, session(lines, logic_1_1=b"\0\5")))) == ["0", "1", "2"]


def test_a_partial_sample_at_the_end_is_left_out_and_noted(tmp_path: Path):
    capture = read(tmp_path, sr_bytes(["a"], "1 MHz", b"\1\0\0", b"\0\1\0\1", unitsize=2))
    assert edges(capture) == {"a": [1, 1, 2]}
    assert (capture.length, capture.notes) == (3, ("a partial sample at the end is dropped, 1 byte",))


@pytest.mark.parametrize("line", [b"samplerate=0\n", b"samplerate=0 Hz\n", b""])
def test_without_a_samplerate_positions_have_no_time(tmp_path: Path, line: bytes):
    content = session(b"[device 1]\nunitsize=1\ntotal probes=1\nprobe1=a\n" + line, logic_1=b"\0\1")
    capture = read(tmp_path, content)
    assert capture.rate is None
    assert capture.notes == ("the file states no samplerate, so positions have no time",)
    stated = read(tmp_path, content, Fraction(500_000))
    assert stated.rate == 500_000 and stated.notes == ()


def test_a_given_rate_takes_precedence_over_that_of_the_file(tmp_path: Path):
    content = sr_bytes(["a"], "1 Hz", b"\0\1")
    assert read(tmp_path, content, Fraction(500_000)).rate == 500_000


def test_analogue_members_are_ignored(tmp_path: Path):
    content = zip_bytes(
        {"version": b"2", "metadata": metadata(["a"], "1 MHz"), "logic-1-1": b"\1\0", "analog-1-2-1": b"\0" * 400}
    )
    assert edges(read(tmp_path, content)) == {"a": [1, 1]}


# Broken files ------------------------------------------------------------------

GOOD = sr_bytes(["a"], "1 MHz", b"\1\0" * 100)


@pytest.mark.parametrize("cut", [0, 3, 40, len(GOOD) // 2, len(GOOD) - 1])
def test_a_truncated_zip_is_rejected(tmp_path: Path, cut: int):
    message = rejection(tmp_path, GOOD[:cut])
    assert message.startswith("the archive: found a broken zip (")
    salvage = ", or read the intact part with --salvage" if cut > 3 else ""
    assert message.endswith(f"), expected a whole sigrok session; copy or save it again{salvage}")


BROKEN = "the archive: found a broken zip ("
OR_SALVAGE = ", expected a whole sigrok session; copy or save it again, or read the intact part with --salvage"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (
            zip_bytes({"version": b"2"}, zipfile.ZIP_LZMA),
            f"{BROKEN}member 'version' is packed by method 14, not by deflate){OR_SALVAGE}",
        ),
        (
            GOOD.replace(b"\1\0" * 100, b"\1\0" * 99 + b"\0\0"),
            f"logic-1-1: found bytes that do not fit their CRC-32{OR_SALVAGE}",
        ),
        (
            b"Time [s],a\n",
            f"{BROKEN}File is not a zip file), expected a whole sigrok session; copy or save it again",
        ),
        (
            zip_bytes({"version": b"2", "metadata": bytes((1 << 20) + 1)}, zipfile.ZIP_DEFLATED),
            "metadata: found 1048577 bytes, expected at most 1048576; save it again",
        ),
    ],
    ids=["packed otherwise", "damaged samples", "no zip", "a megabyte of metadata"],
)
def test_a_broken_archive_is_rejected(tmp_path: Path, content: bytes, message: str):
    assert rejection(tmp_path, content) == message


def test_a_directory_that_would_fill_the_memory_is_rejected_before_reading(tmp_path: Path):
    content = bytearray(GOOD)
    end = content.rindex(b"PK\5\6")
    content[end + 12 : end + 16] = (1 << 30).to_bytes(4, "little")
    assert "found a broken zip (a directory of 1073741824 bytes, expected at most 16777216)" in rejection(
        tmp_path, bytes(content)
    )


HEAD = b"[device 1]\ncapturefile=logic-1\n"


@pytest.mark.parametrize(
    ("members", "message"),
    [
        ({}, "the archive: found no member 'version', expected a sigrok session; save it again"),
        ({"version": b"2"}, "the archive: found no member 'metadata', expected a sigrok session; save it again"),
        ({"version": b"3"}, "version: found '3', expected 1 or 2; save it with sigrok 0.7"),
        (
            {"version": b"2", "metadata": b"[global]\n"},
            "metadata: found no section [device 1], expected the device's settings; save it again as .sr",
        ),
        (
            {"version": b"2", "metadata": HEAD},
            "metadata, unitsize: found nothing, expected 1 to 8; mend the metadata or save it again",
        ),
        (
            {"version": b"2", "metadata": HEAD + b"unitsize=9\n"},
            "metadata, unitsize: found 9, expected 1 to 8; mend the metadata or save it again",
        ),
        (
            {"version": b"2", "metadata": HEAD + b"unitsize=1\nprobe9=a\n"},
            "metadata, probe9: found unitsize 1, expected probe1 to probe8; mend the metadata",
        ),
        (
            {"version": b"2", "metadata": HEAD + b"unitsize=1\n"},
            "metadata, total probes: found nothing, expected 1 to 8; mend the metadata or save it again",
        ),
        (
            {"version": b"2", "metadata": HEAD + b"unitsize=1\nprobe1=a\n"},
            "the archive: found no member 'logic-1' or 'logic-1-1', expected logic samples; capture again",
        ),
        (
            {"version": b"2", "metadata": HEAD + b"unitsize=1\nprobe1=a\n", "logic-1-1": b"\1", "logic-1-3": b"\1"},
            "the archive: found no chunk logic-1-2, expected chunks 1 to 3; "
            "save it again, or read the intact part with --salvage",
        ),
        (
            {"version": b"2", "metadata": HEAD + b"unitsize=1\nprobe1=a\nsamplerate=fast\n", "logic-1": b"\1"},
            "metadata, samplerate: found 'fast', expected a rate such as 4 MHz; state the rate",
        ),
        (
            {"version": b"2", "metadata": HEAD + b"unitsize=2\nprobe1=a\n", "logic-1": b"\1"},
            "logic-1: found no samples, expected logic samples; capture again",
        ),
    ],
)
def test_missing_or_wrong_parts_are_reported_with_their_place(tmp_path: Path, members: dict[str, bytes], message: str):
    assert rejection(tmp_path, zip_bytes(members)) == message


def test_an_invalid_rate_is_ignored_if_one_is_given(tmp_path: Path):
    content = session(HEAD + b"unitsize=1\nprobe1=a\nsamplerate=fast\n", logic_1=b"\1")
    assert read(tmp_path, content, Fraction(10**6)).rate == 10**6


# Zip bombs ---------------------------------------------------------------------


def packed(samples: bytes) -> bytes:
    members = {"version": b"2", "metadata": metadata(["a"], "1 MHz"), "logic-1-1": samples}
    return zip_bytes(members, zipfile.ZIP_DEFLATED)


def test_a_zip_with_too_much_unpacked_content_is_rejected_before_unpacking(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(limits, "MOST_BYTES", 1 << 20)
    assert read(tmp_path, packed(bytes(1 << 20))).length == 1 << 20
    assert rejection(tmp_path, packed(bytes((1 << 20) + 1))) == (
        "logic-1: found 1048577 bytes unpacked, expected at most 1048576; cut it with sigrok-cli"
    )


def test_a_session_with_too_many_edges_is_rejected_at_that_sample(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(limits, "MOST_EDGES", 5000)
    monkeypatch.setattr(session_archive, "BLOCK", 1000)
    assert rejection(tmp_path, packed(b"\0\1" * 50_000)) == (
        "sample 6000: found over 5000 edges, expected fewer; cut the capture or drop its busy channels"
    )


def test_the_memory_needed_depends_on_the_edges_and_not_on_the_length(tmp_path: Path):
    path = tmp_path / "x.sr"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("version", "2")
        archive.writestr("metadata", metadata(["a"], "1 MHz"))
        for number in range(1, 65):
            archive.writestr(f"logic-1-{number}", bytes([number & 1]) * (4 << 20))
    tracemalloc.start()
    capture = formats.read(path)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert capture.length == 256 << 20
    assert capture.channels[0].edges.tolist() == [number * (4 << 20) for number in range(1, 64)]
    assert peak < 16 << 20


# Salvage -------------------------------------------------------------------------


def salvaged(tmp_path: Path, content: bytes) -> Capture:
    path = tmp_path / "x.sr"
    path.write_bytes(content)
    return formats.read(path, salvage=True)


CHUNKS = [b"\1" * 5000 + b"\0" * 5000, b"\1" * 10_000, b"\0" * 10_000]


def chunked(compression: int = zipfile.ZIP_STORED, *without: int) -> bytes:
    members = {"version": b"2", "metadata": metadata(["a"], "1 MHz")}
    members |= {f"logic-1-{n}": chunk for n, chunk in enumerate(CHUNKS, 1) if n not in without}
    return zip_bytes(members, compression)


def test_an_undamaged_file_is_read_with_salvage_without_notes(tmp_path: Path):
    capture = salvaged(tmp_path, chunked())
    assert (edges(capture), capture.length, capture.notes) == ({"a": [1, 5000, 10_000, 20_000]}, 30_000, ())


def test_with_salvage_a_zip_without_its_end_is_read_from_the_front(tmp_path: Path):
    content = chunked()
    capture = salvaged(tmp_path, content[: content.index(b"logic-1-3") + 9 + 1234])
    assert (edges(capture), capture.length) == ({"a": [1, 5000, 10_000, 20_000]}, 21_234)
    assert capture.notes == (
        "the archive is a broken zip (File is not a zip file): its members were searched one by one",
        "logic-1-3 holds 1234 bytes instead of 10000: all samples after 21234 are dropped",
    )


def test_with_salvage_a_longer_part_of_a_file_never_gives_fewer_samples(tmp_path: Path):
    content = chunked(zipfile.ZIP_DEFLATED)
    lengths = [0]
    for cut in range(20, len(content) + 1):
        try:
            capture = salvaged(tmp_path, content[:cut])
        except BadCapture:
            assert lengths[-1] == 0
            continue
        assert capture.notes or cut == len(content)
        assert edges(capture) == {"a": [1, *(edge for edge in (5000, 10_000, 20_000) if edge < capture.length)]}
        assert capture.length >= lengths[-1]
        lengths.append(capture.length)
    assert lengths[-1] == 30_000 and len(set(lengths)) > 4


def test_with_salvage_sizes_after_the_data_are_found(tmp_path: Path):
    class Pipe(io.BytesIO):
        def seekable(self) -> bool:
            return False

        def tell(self) -> int:
            raise OSError

    pipe = Pipe()
    with zipfile.ZipFile(pipe, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("version", "2")
        archive.writestr("metadata", metadata(["a"], "1 MHz"))
        for number, chunk in enumerate(CHUNKS, 1):
            archive.writestr(f"logic-1-{number}", chunk)
    content = pipe.getvalue()
    capture = salvaged(tmp_path, content[: content.index(b"PK\1\2")])
    assert (edges(capture), capture.length) == ({"a": [1, 5000, 10_000, 20_000]}, 30_000)


@pytest.mark.parametrize(
    ("chunk", "found", "note"),
    [
        ("logic-1-2", [1, 5000], "it and all samples after 10000 are dropped"),
        ("logic-1-1", [1, 100, 101, 5000], "its samples are read up to 10000, some may be wrong"),
    ],
)
def test_with_salvage_a_damaged_chunk_and_all_later_ones_are_dropped_unless_it_is_the_first(
    tmp_path: Path, chunk: str, found: list[int], note: str
):
    content = bytearray(chunked())
    content[content.index(chunk.encode()) + 9 + 100] = 0
    capture = salvaged(tmp_path, bytes(content))
    assert (edges(capture), capture.length) == ({"a": found}, 10_000)
    assert capture.notes == (f"{chunk} holds bytes that do not fit their CRC-32: {note}",)


def test_with_salvage_chunks_after_a_missing_one_are_dropped(tmp_path: Path):
    capture = salvaged(tmp_path, chunked(zipfile.ZIP_STORED, 2))
    assert (edges(capture), capture.length) == ({"a": [1, 5000]}, 10_000)
    assert capture.notes == ("logic-1-2 is missing: it and the rest are dropped",)


# Writing -------------------------------------------------------------------------


def lines(length: int, *channels: list[int], rate: Fraction | None = Fraction(4_000_000)) -> Capture:
    """A capture with channels a, b, ..., each given by its initial level and its edges."""
    made = [Channel(chr(97 + n), n, c[0], np.array(c[1:], np.int64)) for n, c in enumerate(channels)]
    return Capture(Path("made"), rate, length, tuple(made))


def back(tmp_path: Path, capture: Capture, **options: Fraction) -> Capture:
    assert formats.write(capture, tmp_path / "y.sr", **options) == ()
    return formats.read(tmp_path / "y.sr")


PLACES = st.sets(st.integers(1, 299), max_size=40).map(sorted)


@given(st.lists(st.tuples(st.integers(0, 1), PLACES), min_size=1, max_size=64), st.integers(3, 60))
@settings(max_examples=examples(40), deadline=None)
def test_a_written_session_is_read_unchanged(
    tmp_path_factory: pytest.TempPathFactory, channels: list[tuple[int, list[int]]], chunk: int
):
    capture = lines(300, *([initial, *places] for initial, places in channels))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sigrok_sr, "CHUNK", 8 * chunk)
        again = back(tmp_path_factory.mktemp("sr"), capture)
    assert (edges(again), facts(again), again.notes) == (edges(capture), facts(capture), ())


def test_equal_captures_make_equal_files(tmp_path: Path):
    for name in ("a.sr", "b.sr"):
        formats.write(lines(300, [1, 7]), tmp_path / name)
    assert (tmp_path / "a.sr").read_bytes() == (tmp_path / "b.sr").read_bytes()


def test_a_capture_without_a_rate_is_written_without_one(tmp_path: Path):
    assert back(tmp_path, lines(300, [1, 7], rate=None)) is not None
    assert formats.read(tmp_path / "y.sr").rate is None


def test_ticks_are_converted_to_samples_with_a_note_about_lost_pulses(tmp_path: Path):
    capture = replace(lines(3000, [1, 1000, 1100, 2000], rate=Fraction(3 * 10**9)), sampled=False)
    assert formats.write(capture, tmp_path / "y.sr", rate=Fraction(10**7)) == (
        "channel a: pulses that fall between two samples of 10 MHz are lost: 1",
    )
    again = formats.read(tmp_path / "y.sr")
    assert (edges(again), facts(again)) == ({"a": [1, 7]}, (10**7, 10, True))


def test_a_note_reports_unknown_spans(tmp_path: Path):
    channel = replace(lines(9, [1, 7]).channels[0], unknown=(Span(2, 4),))
    assert formats.write(replace(lines(9, [1]), channels=(channel,)), tmp_path / "y.sr") == (
        "a session has no unknown levels: those of a are written as the level before them",
    )


@pytest.mark.parametrize(
    ("capture", "message"),
    [
        (
            lines(1 << 40, [1]),
            "what it would hold: found 1099511627776 samples of 4 MHz, expected at most 4294967296; "
            "convert with --sample '15625 Hz', or write .vcd",
        ),
        (
            lines(9, [1], rate=Fraction(10**6, 3)),
            "what it would hold: found 1000000/3 samples a second, expected a whole number; "
            "convert with --sample '4 MHz', or write .vcd",
        ),
        (
            lines(1 << 33, *[[1]] * 65),
            "what it would hold: found 65 channels and 8589934592 samples of 4 MHz, expected 1 to 64 and at most "
            "4294967296; convert with --channels a,b --sample '2 MHz', or write .vcd",
        ),
    ],
)
def test_a_capture_too_large_for_a_session_is_rejected(tmp_path: Path, capture: Capture, message: str):
    assert refusal(BadCapture, formats.write, capture, tmp_path / "y.sr") == f"{tmp_path}/y.sr, {message}"
    assert not list(tmp_path.iterdir())


def test_an_unknown_suffix_is_rejected_with_the_nearest_known_one(tmp_path: Path):
    said = refusal(BadCapture, formats.write, lines(9, [1]), tmp_path / "y.srr")
    assert said.startswith(f"{tmp_path}/y.srr, its name: found '.srr', expected one of ")
    assert said.endswith("; did you mean .sr or .psr?")


@pytest.mark.skipif(shutil.which("sigrok-cli") is None, reason="sigrok-cli is not installed")
@pytest.mark.parametrize(
    ("name", "decoder"),
    [
        ("imu_round.sr", "i2c:scl=SCL:sda=SDA"),
        ("nack.sr", "i2c:scl=SCL:sda=SDA"),
        ("host_frames.sr", "uart:rx=RX:baudrate=115200"),
    ],
)
def test_sigrok_decodes_the_same_events_from_a_written_session(tmp_path: Path, name: str, decoder: str):
    formats.write(formats.read(FOLDER / name), tmp_path / name)
    said = [sigrok_says(path, decoder) for path in (FOLDER / name, tmp_path / name)]
    assert said[0] == said[1] and len(said[0].splitlines()) > 20


@pytest.mark.skipif(shutil.which("sigrok-cli") is None, reason="sigrok-cli is not installed")
@pytest.mark.parametrize("rate", [115_200, 4_000_000, 24_000_000, 1, 3 * 10**9, 12_345])
def test_sigrok_reads_the_rate_as_it_is_written(tmp_path: Path, rate: int):
    formats.write(lines(20, [1, 7], [0, 3], rate=Fraction(rate)), tmp_path / "y.sr")
    command = ["sigrok-cli", "-i", tmp_path / "y.sr", "--show"]
    shown = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert f"Samplerate: {rate}" in shown and "a: logic" in shown
