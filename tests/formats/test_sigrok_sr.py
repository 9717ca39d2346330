"""sigrok sessions: both versions, every sample width, the traps of real files, and broken ones."""

from __future__ import annotations

import zipfile
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.formats import BadCapture, sigrok_sr
from tests.formats.looks import edges, facts
from tests.formats.writers import metadata, sr_bytes, zip_bytes

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


def refusal(tmp_path: Path, content: bytes) -> str:
    with pytest.raises(BadCapture) as caught:
        read(tmp_path, content)
    message = str(caught.value)
    assert message.startswith(f"{tmp_path}/x.sr, ")
    return message.removeprefix(f"{tmp_path}/x.sr, ")


def session(lines: bytes, **members: bytes) -> bytes:
    """A zip whose metadata is given as text; members without the version are logic ones (`_` stands for `-`)."""
    return zip_bytes(
        {"version": b"2", "metadata": lines} | {name.replace("_", "-"): data for name, data in members.items()}
    )


def test_version_2_in_chunks_that_split_anywhere(tmp_path: Path):
    capture = read(tmp_path, sr_bytes(["SCL", "SDA"], "4 MHz", b"\3\3\1", b"\1\0", b"\0\0\2"))
    assert edges(capture) == {"SCL": [1, 4], "SDA": [1, 2, 7]}
    assert (*facts(capture), capture.notes) == (4_000_000, 8, True, ())


def test_chunk_ten_comes_after_nine(tmp_path: Path):
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
@settings(max_examples=50, deadline=None)
def test_any_samples_come_back(tmp_path_factory: pytest.TempPathFactory, samples: list[int], block: int):
    content = b"".join(sample.to_bytes(3, "little") for sample in samples)
    cut = len(content) // 2
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sigrok_sr, "BLOCK", block)
        capture = read(
            tmp_path_factory.mktemp("sr"),
            sr_bytes([f"p{n}" for n in range(24)], "1 MHz", content[:cut], content[cut:], unitsize=3),
        )
    every = range(len(samples))
    for channel in capture.channels:
        levels = [(channel.initial + sum(edge <= n for edge in channel.edges.tolist())) & 1 for n in every]
        assert levels == [sample >> channel.index & 1 for sample in samples]


def test_a_channel_that_was_not_captured_is_not_there_and_its_bits_do_not_matter(tmp_path: Path):
    capture = read(tmp_path, sr_bytes(["", "RTS#", "", "RX"], "24 MHz", b"\x0a\x0f\x05\x05\x00"))
    assert edges(capture) == {"RTS#": [1, 2], "RX": [1, 2]}
    assert [channel.index for channel in capture.channels] == [1, 3]


def test_a_file_that_names_no_channel_has_all_of_them_by_number(tmp_path: Path):
    lines = b"[device 1]\ncapturefile=logic-1\ntotal probes=3\nsamplerate=1 MHz\nunitsize=1\n"
    assert list(edges(read(tmp_path, session(lines, logic_1_1=b"\0\5")))) == ["0", "1", "2"]


def test_a_partial_sample_at_the_end_is_left_out_and_noted(tmp_path: Path):
    capture = read(tmp_path, sr_bytes(["a"], "1 MHz", b"\1\0\0", b"\0\1\0\1", unitsize=2))
    assert edges(capture) == {"a": [1, 1, 2]}
    assert (capture.length, capture.notes) == (3, ("1 bytes of a partial sample at the end are left out",))


@pytest.mark.parametrize("line", [b"samplerate=0\n", b"samplerate=0 Hz\n", b""])
def test_without_a_samplerate_positions_have_no_time(tmp_path: Path, line: bytes):
    content = session(b"[device 1]\nunitsize=1\ntotal probes=1\nprobe1=a\n" + line, logic_1=b"\0\1")
    capture = read(tmp_path, content)
    assert capture.rate is None
    assert capture.notes == ("the file states no samplerate, so positions have no time",)
    stated = read(tmp_path, content, Fraction(500_000))
    assert stated.rate == 500_000 and stated.notes == ()


def test_a_stated_rate_wins_over_the_files(tmp_path: Path):
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
def test_a_truncated_zip(tmp_path: Path, cut: int):
    message = refusal(tmp_path, GOOD[:cut])
    assert message.startswith("the archive: found a broken zip (")
    assert message.endswith("), expected a whole sigrok session; copy or save it again")


def test_damaged_samples(tmp_path: Path):
    damaged = GOOD.replace(b"\1\0" * 100, b"\1\0" * 99 + b"\0\0")
    assert refusal(tmp_path, damaged) == (
        "the archive: found a broken zip (Bad CRC-32 for file 'logic-1-1'), expected a whole sigrok session; "
        "copy or save it again"
    )


def test_no_zip(tmp_path: Path):
    assert refusal(tmp_path, b"Time [s],a\n").startswith("the archive: found a broken zip (File is not a zip file)")


HEAD = b"[device 1]\ncapturefile=logic-1\n"


@pytest.mark.parametrize(
    ("members", "message"),
    [
        ({}, "the archive: found no member 'version', expected a sigrok session; save it again as .sr"),
        ({"version": b"2"}, "the archive: found no member 'metadata', expected a sigrok session; save it again as .sr"),
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
            "the archive: found no chunk logic-1-2, expected chunks 1 to 3; save it again",
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
def test_what_is_missing_or_wrong_is_named(tmp_path: Path, members: dict[str, bytes], message: str):
    assert refusal(tmp_path, zip_bytes(members)) == message


def test_an_unreadable_rate_is_no_matter_where_one_is_stated(tmp_path: Path):
    content = session(HEAD + b"unitsize=1\nprobe1=a\nsamplerate=fast\n", logic_1=b"\1")
    assert read(tmp_path, content, Fraction(10**6)).rate == 10**6


# Zip bombs ---------------------------------------------------------------------


def packed(samples: bytes) -> bytes:
    members = {"version": b"2", "metadata": metadata(["a"], "1 MHz"), "logic-1-1": samples}
    return zip_bytes(members, zipfile.ZIP_DEFLATED)


def test_a_zip_that_unpacks_to_too_much_is_refused_unopened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(sigrok_sr, "MOST_BYTES", 1 << 20)
    assert read(tmp_path, packed(bytes(1 << 20))).length == 1 << 20
    assert refusal(tmp_path, packed(bytes((1 << 20) + 1))) == (
        "logic-1: found 1048577 bytes unpacked, expected at most 1048576; cut it with sigrok-cli"
    )


def test_a_zip_that_changes_too_often_is_refused_at_that_sample(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(sigrok_sr, "MOST_CHANGES", 5000)
    monkeypatch.setattr(sigrok_sr, "BLOCK", 1000)
    assert refusal(tmp_path, packed(b"\0\1" * 50_000)) == (
        "sample 6000: found over 5000 changes, expected fewer; cut the capture or drop its busy channels"
    )


def test_metadata_of_a_megabyte_is_refused(tmp_path: Path):
    content = zip_bytes({"version": b"2", "metadata": bytes((1 << 20) + 1)}, zipfile.ZIP_DEFLATED)
    assert refusal(tmp_path, content) == (
        "metadata: found 1048577 bytes, expected at most 1048576; save it again as .sr"
    )


def test_memory_follows_the_changes_and_not_the_length(tmp_path: Path):
    import tracemalloc

    content = packed(bytes(64 << 20) + b"\1")
    tracemalloc.start()
    capture = read(tmp_path, content)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert capture.length == (64 << 20) + 1 and capture.channels[0].edges.tolist() == [64 << 20]
    assert peak < 16 << 20
