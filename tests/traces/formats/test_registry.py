"""The registry of formats: formats.read recognizes the format of a file, or lists the known ones."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.traces import formats
from tests.refusals import refusal
from tests.traces.formats.writers import sr_bytes

KNOWN = ", ".join(reader.NAME for reader in formats.readers().values())
VCD = b"$timescale 1 us $end $var wire 1 ! a $end $enddefinitions $end #0 1! #5 0! #9\n"
SALEAE = b"Time [s],a\n0.0,1\n0.000005,0\n0.000009,0\n"
PULSEVIEW = b"; Channels (1/1): a\n; Samplerate: 1 MHz\na\n" + b"1\n" * 5 + b"0\n" * 4


def test_every_module_with_a_name_is_a_format():
    folder = Path(formats.__file__).parent
    named = {path.stem for path in folder.glob("*.py") if "\nNAME = " in path.read_text()}
    assert set(formats.formats()) == named >= {"sigrok_sr", "vcd", "saleae_csv", "saleae_bin", "pulseview_csv"}


@pytest.mark.parametrize("name", sorted(formats.formats()))
def test_each_format_has_the_required_attributes(name: str):
    of = formats.formats()[name]
    assert of.NAME and of.SUFFIXES and all(suffix[0] in "./" for suffix in of.SUFFIXES)
    assert hasattr(of, "read") or hasattr(of, "write")
    assert hasattr(of, "read") == hasattr(of, "recognises")
    if hasattr(of, "read"):
        assert not of.recognises(Path("x"), b"") and not of.recognises(Path("x"), b"\x7fELF")


def test_each_suffix_is_written_by_only_one_format():
    able = [of for of in formats.formats().values() if hasattr(of, "write")]
    suffixes = [suffix for of in able for suffix in getattr(of, "WRITTEN", of.SUFFIXES)]
    assert len(suffixes) == len(set(suffixes)) == len(formats.writers())


@pytest.mark.parametrize(
    ("suffix", "content"),
    [
        (".vcd", VCD),
        (".csv", SALEAE),
        (".csv", PULSEVIEW),
        (".sr", sr_bytes(["a"], "1 MHz", b"\1" * 5 + b"\0" * 4)),
        (".txt", SALEAE),
        (".txt", VCD),
        ("", PULSEVIEW),
        (".zip", sr_bytes(["a"], "1 MHz", b"\1" * 5 + b"\0" * 4)),
        (".SR", sr_bytes(["a"], "1 MHz", b"\1" * 5 + b"\0" * 4)),
    ],
)
def test_the_format_is_recognized_by_content_under_any_name(tmp_path: Path, suffix: str, content: bytes):
    path = tmp_path / f"capture{suffix}"
    path.write_bytes(content)
    capture = formats.read(str(path), Fraction(10**6))
    assert capture.path == path and capture.rate == 10**6
    assert [(c.name, c.initial, c.edges.tolist()) for c in capture.channels] == [("a", 1, [5])]


@pytest.mark.parametrize(
    ("suffix", "found", "way_out"),
    [
        (".sal", "a Saleae session, whose layout the vendor changes at will", "export CSV or binary from Logic 2"),
        (".logicdata", "a Saleae Logic 1 session, whose layout is not published", "export CSV from Logic"),
        (".pvs", "a PulseView setup without samples", "give the .sr file beside it"),
    ],
)
def test_known_unreadable_formats_are_rejected_by_name(tmp_path: Path, suffix: str, found: str, way_out: str):
    path = tmp_path / f"capture{suffix}"
    assert (
        refusal(formats.BadCapture, formats.read, path)
        == f"{path}, its name: found {found}, expected {KNOWN}; {way_out}"
    )


@pytest.mark.parametrize(("content", "found"), [(b"\x00\x01\x02", repr(b"\x00\x01\x02")), (b"", "nothing")])
def test_unknown_content_is_shown_in_the_message(tmp_path: Path, content: bytes, found: str):
    path = tmp_path / "capture.csv"
    path.write_bytes(content)
    assert (
        refusal(formats.BadCapture, formats.read, path)
        == f"{path}, its first bytes: found {found}, expected {KNOWN}; export one of these"
    )


def test_a_missing_file_is_rejected(tmp_path: Path):
    assert refusal(formats.BadCapture, formats.read, tmp_path / "none.sr") == (
        f"{tmp_path}/none.sr, the file: found no such file or directory, expected a file that can be read; "
        "check its name"
    )


def test_a_rate_must_be_positive(tmp_path: Path):
    with pytest.raises(ValueError, match="the sampling rate is 0 Hz; expected more than 0"):
        formats.read(tmp_path / "x.sr", Fraction(0))
