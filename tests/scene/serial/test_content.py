"""The characters of an entry of a serial table, and characters as messages show them."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim.scene.case.model import BadCase, Case
from periph_sim.scene.case.origin import Source
from periph_sim.scene.case.serial import SendTable
from periph_sim.scene.serial.content import content_of, show_characters


def content(folder: Path, bits: int = 8, **given: object) -> bytes:
    case = Case.model_validate({"name": "x", "duration": "1 s"}).from_source(Source(folder / "case.toml", ""))
    entry = SendTable.model_validate({"to": "dsp.SCI-A", "at": "1 ms", **given})
    return content_of(case, entry, bits, "serial", "send", 0)


def test_a_text_bytes_or_a_file(tmp_path: Path):
    (tmp_path / "page.bin").write_bytes(b"\x00\xff")
    assert content(tmp_path, text="OK\r\n") == b"OK\r\n"
    assert content(tmp_path, text="µ", encoding="latin-1") == b"\xb5"
    assert content(tmp_path, text="µ", encoding="utf-8") == b"\xc2\xb5"
    assert content(tmp_path, bytes="55 aa") == b"\x55\xaa"
    assert content(tmp_path, file="page.bin") == b"\x00\xff"
    assert content(tmp_path, **{"break": "1 ms"}) == b""


@pytest.mark.parametrize(
    ("given", "bits", "said"),
    [
        ({"text": "aµ"}, 8, "'µ' cannot be encoded in ascii; give another encoding, or bytes instead of text"),
        ({"bytes": "7f 80"}, 7, "0x80 does not fit a character of 7 bits; give other content, or more bits"),
        ({"text": "a"}, 6, "0x61 does not fit a character of 6 bits"),
        ({"file": "empty.bin"}, 8, "empty.bin is empty; it needs at least one character"),
        ({"file": "no.bin"}, 8, "no.bin cannot be read (No such file or directory); a path counts from the folder"),
        ({"file": "high.bin"}, 7, "0xff does not fit a character of 7 bits"),
        ({"file": "large.bin"}, 8, "large.bin cannot be read ("),
    ],
)
def test_what_cannot_be_sent(given: dict[str, str], bits: int, said: str, tmp_path: Path):
    (tmp_path / "empty.bin").touch()
    (tmp_path / "high.bin").write_bytes(b"\xff")
    with open(tmp_path / "large.bin", "wb") as file:
        file.truncate((1 << 24) + 1)
    with pytest.raises(BadCase) as caught:
        content(tmp_path, bits, **given)
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("characters", "as_text", "shown"),
    [
        ((0x4F, 0x4B, 0x0D), True, r"'OK\r'"),
        ((0x4F, 0x4B), False, "4f 4b"),
        ((0x7F,), True, r"'\x7f'"),
        ((0x80,), True, "80"),
        ((0x4F, 0x14B), True, "4f 4b!"),
        ((0x100, 0xFF), False, "00! ff"),
    ],
)
def test_characters_are_shown_as_text_or_numbers_and_wrong_ones_marked(
    characters: tuple[int, ...], as_text: bool, shown: str
):
    assert show_characters(characters, as_text) == shown
