"""Output and errors of the command `periph-sim image FILE`."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from periph_sim.processor.image_files.coff2 import write
from periph_sim.processor.image_files.model import Section
from tests.interfaces.commands.conftest import Run, periph_sim  # noqa: F401
from tests.processor.image_files.own_images import image, text


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "own.out"
    path.write_bytes(write(image()))
    return path


def test_text(periph_sim: Run, file: Path):  # noqa: F811
    came = periph_sim("image", str(file))
    assert came.status == 0
    assert came.out.splitlines() == [
        "TI COFF2, linker 5002, entry 0x008000 (_main)",
        "9 instructions in 14 words of code, all known",
        "",
        " section  loaded at  runs at  words  contents",
        " ────────────────────────────────────────────",
        " .text    0x008000               14  code",
        " .econst  0x009000                3  data",
        " .stack   0x000400              768  reserved",
        "",
        " vector    address  handler                   stored in",
        " ──────────────────────────────────────────────────────",
        " I2CINT1A  0x0db0   _handler_of_the_transfer  _main",
        "",
        " module  registers touched",
        " ─────────────────────────",
        " I2C-A   I2CSTR, I2CMDR",
        "",
        " function                  address   words  source",
        " ─────────────────────────────────────────────────",
        " _main                     0x008000     13",
        " _handler_of_the_transfer  0x00800d      1",
    ]


def test_json(periph_sim: Run, file: Path):  # noqa: F811
    found = json.loads(periph_sim("image", str(file), "--json").out)
    assert (found["schema"], found["instructions"], found["unknown"]) == ("periph-sim image", 9, [])


def test_verbose_lists_the_functions_that_access_each_register(periph_sim: Run, file: Path):  # noqa: F811
    came = periph_sim("image", str(file), "-v")
    assert " I2C-A I2CSTR  0x7902       1       1  _main" in came.out.splitlines()


def test_unknown_words_are_listed_and_the_status_is_1(periph_sim: Run, tmp_path: Path):  # noqa: F811
    path = tmp_path / "tmu.out"
    path.write_bytes(write(image(text((0x7700, 0xE271, 0x0006)))))
    came = periph_sim("image", str(path))
    assert came.status == 1
    assert "2 instructions in 3 words of code, 1 unknown word" in came.out
    lines = came.out.splitlines()
    heading = lines.index("words of code that are not instructions of the F28335:")
    assert "0x008001  0xe271  0x008001  the TMU of an F2837x" in lines[heading + 1]


def test_sections_that_share_memory_get_a_note(periph_sim: Run, tmp_path: Path):  # noqa: F811
    path = tmp_path / "shared.out"
    reserved = (Section(".stack", 0x400, 0x400, 0x100), Section(".ebss", 0x4F0, 0x4F0, 0x20))
    path.write_bytes(write(image(text(), *reserved, Section(".esysmem", 0x500, 0x500, 0x10), Section("x", 0, 0, 0))))
    came = periph_sim("image", str(path))
    assert came.status == 0
    notes = " ".join(came.out.split()).split("note: ")[1:]
    assert [one[: one.index(":")] for one in notes] == [
        "sections .stack and .ebss share 0x0004f0 to 0x0004ff",
        "sections .ebss and .esysmem share 0x000500 to 0x00050f",
    ]
    assert len(json.loads(periph_sim("image", "--json", str(path)).out)["shared_memory"]) == 2


def test_bad_input_gives_one_sentence_and_status_2(periph_sim: Run, tmp_path: Path):  # noqa: F811
    path = tmp_path / "x.out"
    path.write_bytes(b"\x7fELF" + bytes(100))
    came = periph_sim("image", str(path))
    assert (came.status, came.out) == (2, "")
    assert came.err.startswith(f"Error: {path}: ") and came.err.count("\n") == 1
