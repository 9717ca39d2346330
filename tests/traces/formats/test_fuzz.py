"""Damaged capture files: reading any of them returns a valid Capture or raises an error of one sentence.

Every reader is fuzzed with files made here, with a small capture written by the writers of the package, and with small
real captures. Zip files are damaged as bytes and, with correct checksums, in their members.
"""

from __future__ import annotations

import io
import re
import signal
import tracemalloc
import zipfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from periph_sim.traces import formats
from periph_sim.traces.capture.capture import Channel
from periph_sim.traces.formats import BadCapture, Capture
from tests.captures.where import captures
from tests.profiles import examples
from tests.traces.formats.test_pulseview_csv import DSVIEW
from tests.traces.formats.test_saleae_bin import version_0, version_1
from tests.traces.formats.test_saleae_csv import LOGIC2
from tests.traces.formats.test_sigrok_sr import V1
from tests.traces.formats.test_vcd import SIGROK
from tests.traces.formats.writers import dsl_bytes, metadata, sr_bytes, zip_bytes

SMALL = 6000  # maximal size of a real capture that is fuzzed, in bytes
LONGEST = 20  # seconds for one small file; a longer time is a hang

MADE = {
    "v2.sr": sr_bytes(["SCL", "SDA"], "4 MHz", b"\3\3\1\0", b"\2\2\3"),
    "v1.sr": zip_bytes({"logic-1": b"\3\2\2\3", "metadata": V1, "version": b"1"}),
    "packed.sr": zip_bytes(
        {"version": b"2", "metadata": metadata(["a"], "1 MHz"), "logic-1-1": bytes(99)}, zipfile.ZIP_DEFLATED
    ),
    "dsview.dsl": dsl_bytes({"SCL": [1] * 40 + [0] * 30, "SDA": [0, 1] * 35}, "10 MHz"),
    "sigrok.vcd": SIGROK.encode(),
    "vector.vcd": b"$timescale 1ps $end $var reg 4 ! a[3:0] $end $var real 64 r v $end\n#0 b1xz0 ! r1.5 r\n#9 b0 !\n",
    "logic2.csv": LOGIC2.encode(),
    "iso.csv": b"Time [s],a\n2022-06-24T23:59:59.999999990+02:00,0\n2022-06-25T00:00:00.000000010+02:00,1\n",
    "samples.csv": b"; Channels (2/8): SCL, SDA\n; Samplerate: 4 MHz\nSCL,SDA\n1,1\n1,0\n0,0\n",
    "changes.csv": b"; Channels (1/8): a\n; Samplerate: 500 kHz\nmicroseconds,logic\n2,1\n236,0\n",
    "dsview.csv": DSVIEW.encode(),
    "digital_0.bin": version_0(1, 0.0, 1e-6, [120e-9, 200e-9]),
    "digital_1.bin": version_1((1, 1e6, 0.0, 9e-6, [4e-6]), (1, 1e6, 20e-6, 29e-6, [25e-6])),
}
ZIPPED = (".sr", ".dsl", ".psr")


@cache
def seeds() -> dict[str, bytes]:
    """Return the undamaged content of each file by its name."""
    found = dict(MADE)
    found |= {path.name: path.read_bytes() for path in captures() if path.is_file() and path.stat().st_size < SMALL}
    return found


def small() -> Capture:
    channels = [Channel(name, n, 1, np.array([5 + n, 90], np.int64)) for n, name in enumerate(["SCL", "SDA"])]
    return Capture(Path("made"), Fraction(10**6), 100, tuple(channels))


READ_BY_WRITER = sorted(
    suffix for suffix, writer in formats.writers().items() if hasattr(writer, "read") and suffix.startswith(".")
)


@pytest.mark.parametrize("name", sorted(formats.readers()))
def test_every_reader_has_a_file_to_fuzz(name: str, tmp_path: Path):
    reader = formats.readers()[name]
    for file, content in seeds().items():
        (tmp_path / file).write_bytes(content)
    known = [file for file in seeds() if reader.recognises(tmp_path / file, seeds()[file][: formats.HEAD])]
    if not known and not set(reader.SUFFIXES) & set(READ_BY_WRITER):
        pytest.skip(f"{reader.NAME}: no small file of it here")


# Damage ---------------------------------------------------------------------------

WORDS = [
    b"\0" * 8,
    b"\xff" * 8,
    b"\xff\xff\xff\x7f",
    b"\0\0\0\x80",
    b"\0\0\xf8\x7f",
]  # 0, -1, the extremes of an int32, NaN
LONG = b"9" * 5000  # more digits than Python converts to a number
EXTREMES = [*WORDS, b"-1", b"9" * 20, b"1e99", b"nan", LONG]
LONGEST_MESSAGE = 1000  # characters besides the path; contents of the file are quoted only briefly
PLACE = st.integers(0, 1 << 16)
Change = Callable[[bytes], bytes]


def at(content: bytes, place: int) -> int:
    return place % (len(content) + 1)


def cut(place: int) -> Change:
    return lambda content: content[: at(content, place)]


def put(place: int, removed: int, added: bytes) -> Change:
    def change(content: bytes) -> bytes:
        here = at(content, place)
        return content[:here] + added + content[here + removed :]

    return change


def flip(place: int, bit: int) -> Change:
    def change(content: bytes) -> bytes:
        here = at(content, place)
        return content[:here] + bytes(byte ^ 1 << bit for byte in content[here : here + 1]) + content[here + 1 :]

    return change


def swap_lines(place: int, other: int) -> Change:
    """Swap two lines, so that times fall."""

    def change(content: bytes) -> bytes:
        lines = content.splitlines(keepends=True)
        if lines:
            a, b = place % len(lines), other % len(lines)
            lines[a], lines[b] = lines[b], lines[a]
        return b"".join(lines)

    return change


def repeat(place: int, size: int, times: int) -> Change:
    """Repeat times, rows or chunks."""

    def change(content: bytes) -> bytes:
        here = at(content, place)
        return content[:here] + content[here : here + size] * times + content[here:]

    return change


def line_ends(end: bytes, every: int) -> Change:
    def change(content: bytes) -> bytes:
        lines = content.split(b"\n")
        return b"".join(line + (end if n % every == 0 else b"\n") for n, line in enumerate(lines))

    return change


def other_number(place: int, number: bytes) -> Change:
    """Replace a count, a time or a rate by another number."""

    def change(content: bytes) -> bytes:
        numbers = list(re.finditer(rb"\d+", content))
        if not numbers:
            return content
        match = numbers[place % len(numbers)]
        return content[: match.start()] + number + content[match.end() :]

    return change


CHANGE = st.one_of(
    st.builds(cut, PLACE),
    st.builds(put, PLACE, st.integers(0, 8), st.binary(max_size=8)),
    st.builds(put, PLACE, st.integers(0, 8), st.sampled_from(EXTREMES)),
    st.builds(flip, PLACE, st.integers(0, 7)),
    st.builds(swap_lines, PLACE, PLACE),
    st.builds(repeat, PLACE, st.integers(1, 60), st.integers(1, 4)),
    st.builds(line_ends, st.sampled_from([b"\r\n", b"\r", b"\n\n", b""]), st.integers(1, 3)),
    st.builds(
        other_number, PLACE, st.sampled_from([b"0", b"-1", b"-0.5", b"9" * 25, LONG, b"1e9", b"4294967296", b""])
    ),
)
SEPARATE = ".fst"  # read in a separate process for each file
CHANGES = st.lists(CHANGE, min_size=1, max_size=3)
RATE = st.sampled_from([None, Fraction(10**6), Fraction(24 * 10**6), Fraction(10**7, 3)])
FUZZED = settings(max_examples=examples(40), deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])

SUFFIXES = sorted({"", *(suffix for reader in formats.readers().values() for suffix in reader.SUFFIXES)} - {"/"})


def damaged(content: bytes, changes: list[Change]) -> bytes:
    for change in changes:
        content = change(content)
    return content


@pytest.mark.parametrize("name", MADE)
@given(changes=CHANGES, rate=RATE, salvage=st.booleans())
@FUZZED
def test_damaged_bytes(tmp_path: Path, name: str, changes: list[Change], rate: Fraction | None, salvage: bool):
    judge(tmp_path / name, damaged(MADE[name], changes), rate, salvage)


@pytest.mark.parametrize("name", [name for name in seeds() if name not in MADE])
@given(changes=CHANGES, rate=RATE, salvage=st.booleans())
@settings(FUZZED, max_examples=examples(15))
def test_damaged_captures(tmp_path: Path, name: str, changes: list[Change], rate: Fraction | None, salvage: bool):
    judge(tmp_path / name, damaged(seeds()[name], changes), rate, salvage)


@pytest.mark.parametrize("name", [name for name in MADE if name.endswith(ZIPPED)])
@given(changes=CHANGES, which=PLACE, rate=RATE, salvage=st.booleans())
@FUZZED
def test_damage_with_correct_checksums(
    tmp_path: Path, name: str, changes: list[Change], which: int, rate: Fraction | None, salvage: bool
):
    judge(tmp_path / name, zip_bytes(damaged_member(MADE[name], changes, which)), rate, salvage)


@pytest.mark.parametrize("suffix", [suffix for suffix in READ_BY_WRITER if suffix != SEPARATE])
@given(changes=CHANGES, which=PLACE, inside=st.booleans(), rate=RATE, salvage=st.booleans())
@FUZZED
def test_damage_to_written_files(tmp_path: Path, suffix: str, **damage: Any):
    judge_written(tmp_path, suffix, **damage)


@given(changes=CHANGES, which=PLACE, inside=st.booleans(), rate=RATE, salvage=st.booleans())
@settings(FUZZED, max_examples=examples(8))
def test_damage_to_written_files_that_a_separate_process_reads(tmp_path: Path, **damage: Any):
    judge_written(tmp_path, SEPARATE, **damage)


def judge_written(
    tmp_path: Path,
    suffix: str,
    changes: list[Change],
    which: int,
    inside: bool,
    rate: Fraction | None,
    salvage: bool,
) -> None:
    path = tmp_path / f"made{suffix}"
    if not (tmp_path / "sound").exists():
        formats.write(small(), path)
        path.rename(tmp_path / "sound")
    content = (tmp_path / "sound").read_bytes()
    if inside and suffix in ZIPPED:
        judge(path, zip_bytes(damaged_member(content, changes, which)), rate, salvage)
    else:
        judge(path, damaged(content, changes), rate, salvage)


@given(content=st.binary(max_size=300), suffix=st.sampled_from(SUFFIXES))
@settings(FUZZED, max_examples=examples(40))
def test_any_bytes(tmp_path: Path, content: bytes, suffix: str):
    judge(tmp_path / f"any{suffix}", content, None, False)


def members_of(content: bytes) -> dict[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def damaged_member(content: bytes, changes: list[Change], which: int) -> Mapping[str, bytes]:
    members = members_of(content)
    name = sorted(members)[which % len(members)]
    return members | {name: damaged(members[name], changes)}


def judge(path: Path, content: bytes, rate: Fraction | None, salvage: bool) -> None:
    """Check that reading gives a valid Capture, or an error of one sentence that names the file."""
    path.write_bytes(content)
    try:
        with within(LONGEST):
            capture = formats.read(path, rate, salvage=salvage)
    except BadCapture as error:
        message = str(error)
        assert message.startswith(str(path)) and len(message.splitlines()) == 1
        assert ": found " in message and ", expected " in message and "; " in message
        assert len(message) <= len(str(path)) + LONGEST_MESSAGE
        return
    assert capture.length >= 1
    assert capture.rate is None or capture.rate > 0
    assert all(len(note.splitlines()) == 1 and len(note) <= LONGEST_MESSAGE for note in capture.notes)
    for channel in capture.channels:
        assert channel.initial in (0, 1) and len(channel.edges) == len(channel.levels)
        assert channel.edges.dtype == np.int64 and channel.levels.dtype == np.uint8
        assert (np.diff(channel.edges, prepend=0) > 0).all()
        assert not len(channel.edges) or channel.edges[-1] < capture.length
        assert (np.diff(channel.levels.astype(int), prepend=channel.initial) != 0).all()
        assert all(0 <= hole.begin < hole.end <= capture.length for hole in channel.unknown)


@contextmanager
def within(seconds: int) -> Iterator[None]:
    """Raise AssertionError if the block takes longer than `seconds`."""

    def late(number: int, frame: object) -> None:
        raise AssertionError(f"still reading after {seconds} s")

    if not hasattr(signal, "SIGALRM"):  # on Windows, the time limit of the test suite ends a hang
        yield
        return
    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def numbers(content: bytes) -> range:
    """The indices of the numbers in the content, as `other_number` counts them."""
    return range(len(re.findall(rb"\d+", content)))


LONG_NUMBERS = [(name, which) for name in MADE if not name.endswith((*ZIPPED, ".bin")) for which in numbers(MADE[name])]


@pytest.mark.parametrize(("name", "which"), LONG_NUMBERS)
def test_a_number_too_long_for_python_anywhere_in_a_text(tmp_path: Path, name: str, which: int):
    judge(tmp_path / name, other_number(which, LONG)(MADE[name]), None, False)


LONG_MEMBERS = [
    (name, member, which)
    for name in MADE
    if name.endswith((".sr", ".dsl"))
    for member, content in members_of(MADE[name]).items()
    if not member.startswith(("logic", "L-"))
    for which in numbers(content)
]


@pytest.mark.parametrize(("name", "member", "which"), LONG_MEMBERS)
def test_a_number_too_long_for_python_anywhere_in_the_metadata(tmp_path: Path, name: str, member: str, which: int):
    members = members_of(MADE[name])
    judge(tmp_path / name, zip_bytes(members | {member: other_number(which, LONG)(members[member])}), None, False)


# Small files that need much memory ---------------------------------------------------------

HUGE = 1 << 60
BOMBS = {
    "edges.sr": zip_bytes(
        {"version": b"2", "metadata": metadata(["a"], "1 MHz", 8), "logic-1-1": bytes(32 << 20)}, zipfile.ZIP_DEFLATED
    ),
    "metadata.sr": zip_bytes({"version": b"2", "metadata": b"\n" * (64 << 20)}, zipfile.ZIP_DEFLATED),
    "blocks.dsl": dsl_bytes({"a": [1, 0]}, "1 MHz", total_blocks="999999999"),
    "probes.dsl": dsl_bytes(
        {"a": [1, 0]}, "1 MHz", total_blocks="999999999", **{f"probe{n}": "b" for n in range(9999)}
    ),
    "samples.dsl": dsl_bytes({"a": [1, 0]}, "1 MHz", total_samples=str(HUGE)),
    "digital_0.bin": version_0(1, 0, 1e8, [])[:36] + HUGE.to_bytes(8, "little"),
    "digital_1.bin": version_1((0, 1e6, 0, 1, []))[:16] + HUGE.to_bytes(8, "little"),
    "line.csv": b"; Channels (1/1): a\n" + b"1" * (8 << 20),
    "columns.csv": b"; Samplerate: 1 MHz\n" + b"1," * (400 << 10) + b"1\n",
    "times.csv": b"Time [s],a\n0,1\n99999999999.000000001,0\n",
    "times.vcd": b"$timescale 1 fs $end $var wire 1 ! a $end $enddefinitions $end\n#0 1!\n#9223372036854775806 0!\n",
}


@pytest.mark.parametrize("name", BOMBS)
@pytest.mark.parametrize("salvage", [False, True])
def test_small_files_do_not_fill_the_memory(tmp_path: Path, name: str, salvage: bool):
    tracemalloc.start()
    try:
        judge(tmp_path / name, BOMBS[name], None, salvage)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 64 << 20
