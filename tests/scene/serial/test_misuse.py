"""Mistakes in serial tables: each is refused with one sentence that names file, line and correction."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim import BadCase, Case, Scene, load
from periph_sim.scene.case.origin import Source
from periph_sim.scene.case.serial import SendTable, content_of, show_characters
from tests.scene.small import sentence_of

TEXT = """\
name = "small"
duration = "1 ms"

[unit.dsp]
firmware = "idle.py"
modules = ["SCI-A", "GPIO"]

[[serial.send]]
name = "ask"
to = "dsp.SCI-A"
text = "ask"
at = "100 us"

[[serial.expect]]
name = "told"
from = "dsp.SCI-A"
text = "OK"
after_send = "ask"
within = "1 ms"
"""
HOST = '\n[host]\nbaud = 9600\n'  # fmt: skip
CABLE = '\n[[cable]]\nfrom = "dsp.SCI-A.TX"\nto = "dsp.SCI-A.RX"\n'


@pytest.fixture
def small(tmp_path: Path) -> Path:
    (tmp_path / "idle.py").write_text("def main(dsp, settings):\n    pass\n")
    (tmp_path / "empty.bin").write_bytes(b"")
    (tmp_path / "high.bin").write_bytes(b"\xff")
    return tmp_path / "small.toml"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            'to = "dsp.SCI-A"',
            'to = "dps.SCI-A"',
            "line 10: serial.send.ask.to: there is no unit 'dps'; did you mean dsp?",
        ),
        (
            'to = "dsp.SCI-A"',
            'to = "dsp.SCI-B"',
            "line 10: serial.send.ask.to: unit dsp has no SCI-B; add it to its modules",
        ),
        (
            'to = "dsp.SCI-A"',
            'to = "dsp.SCIA"',
            "line 10: serial.send.ask.to: there is no SCI 'dsp.SCIA'; did you mean dsp.SCI-A?",
        ),
        (
            'from = "dsp.SCI-A"',
            'from = "dsp.SCI-C"',
            "line 16: serial.expect.told.from: unit dsp has no SCI-C; add it to its modules",
        ),
        (
            'text = "ask"',
            'text = "ask"\nexpect = "nothing"',
            'line 8: serial.send.ask: expect = "nothing" and within belong together; give both, or expect a reply by '
            "[[serial.expect]]",
        ),
        (
            'text = "ask"',
            'text = "ask"\nexpect = "OK"\nwithin = "1 ms"',
            "line 12: serial.send.ask.expect: expected 'nothing', but it is 'OK'",
        ),
        (
            'text = "ask"',
            'text = "ask"\nexpect = "nothing"\nwithin = "1 ms"',
            "line 20: serial.expect.told.after_send: send 'ask' expects nothing; leave its key expect or this reply "
            "out",
        ),
        (
            'name = "ask"\nto = "dsp.SCI-A"\ntext = "ask"',
            'to = "dsp.SCI-A"\ntext = "ask"\nexpect = "nothing"\nwithin = "1 ms"',
            "line 8: serial.send.0: a send that expects nothing is a budget; give it a name",
        ),
        (
            'text = "ask"',
            'text = "né"',
            "line 11: serial.send.ask.text: 'é' cannot be encoded in ascii; "
            "give another encoding, or bytes instead of text",
        ),
        (
            'text = "OK"',
            'text = "€"\nencoding = "latin-1"',
            "line 17: serial.expect.told.text: '€' cannot be encoded in latin-1; "
            "give another encoding, or bytes instead of text",
        ),
        (
            'at = "100 us"',
            'at = "100 us"\ngap = "-1 us"',
            "line 13: serial.send.ask.gap: '-1 us' is negative; a duration is 0 or more",
        ),
        (
            'text = "ask"',
            'text = "ask"\nbytes = "00"',
            "line 8: serial.send.ask: text and bytes cannot both be; leave one of them out",
        ),
        ('text = "ask"', "", "line 8: serial.send.ask: a send needs one of text, bytes, file and break"),
        ('text = "ask"', 'text = ""', "line 8: serial.send.ask: text is empty; write at least one character"),
        (
            'text = "ask"',
            'file = "ask.bin"',
            "line 11: serial.send.ask.file: ask.bin cannot be read (No such file or directory); "
            "a path counts from the folder of the case",
        ),
        (
            'text = "ask"',
            'file = "empty.bin"',
            "line 11: serial.send.ask.file: empty.bin is empty; it needs at least one character",
        ),
        (
            'text = "ask"',
            'bytes = "80"\nbits = 7',
            "line 11: serial.send.ask.bytes: 0x80 does not fit a character of 7 bits; give other content, or more bits",
        ),
        (
            'text = "ask"',
            'text = "a"\nbits = 6',
            "line 11: serial.send.ask.text: 0x61 does not fit a character of 6 bits; give other content, or more bits",
        ),
        (
            'text = "ask"',
            'file = "high.bin"\nbits = 7',
            "line 11: serial.send.ask.file: 0xff does not fit a character of 7 bits; give other content, or more bits",
        ),
        (
            'at = "100 us"',
            "",
            "line 8: serial.send.ask: a send needs one of at, after, after_text and after_bytes",
        ),
        (
            'at = "100 us"',
            'after = "frame TY"',
            "line 12: serial.send.ask.after: 'frame TY': there is no serial line 'TY'; "
            "it has RX, TX, begin, end, error",
        ),
        (
            'at = "100 us"',
            'at = "100 us"\ntimes = 2',
            "line 8: serial.send.ask: times needs period, since a time comes once; give period, or leave times out",
        ),
        (
            'at = "100 us"',
            'at = "100 us"\nwrong_parity = [0]',
            "line 13: serial.send.ask.wrong_parity: there is no parity that could be wrong; "
            'give parity = "even" or "odd"',
        ),
        (
            'at = "100 us"',
            'at = "100 us"\nmissing_stop = [3]',
            "line 13: serial.send.ask.missing_stop: there is no character 3; it sends 3, counted from 0",
        ),
        (
            'at = "100 us"',
            'at = "100 us"\naddress = 1',
            "line 13: serial.send.ask.address: an address needs a mode that has them; "
            'give multiprocessor = "address-bit" or "idle-line"',
        ),
        (
            'after_send = "ask"',
            'after_send = "aks"',
            "line 18: serial.expect.told.after_send: there is no send 'aks'; did you mean ask?",
        ),
        (
            'after_send = "ask"',
            "",
            "line 14: serial.expect.told: an expect needs one of after_send, after and at",
        ),
        (
            'within = "1 ms"',
            'within = "1 ms"\nwithn = "2 ms"',
            "line 20: there is no key 'serial.expect.told.withn'; did you mean within?",
        ),
        (
            "",
            HOST,
            "line 10: serial.send.ask.to: the host drives the RX of dsp.SCI-A already, and one line has one sender; "
            "send to another SCI, or leave the other one out",
        ),
        (
            "",
            CABLE,
            "line 10: serial.send.ask.to: dsp.SCI-A.TX drives the RX of dsp.SCI-A already, and one line has "
            "one sender; send to another SCI, or leave the other one out",
        ),
        (
            "",
            '\n[[budget]]\nname = "told"\nmeasure = "overruns"\nmax = 0\n',
            "line 15: serial.expect.told.name: there are two budgets 'told'; "
            "verdicts are known by name, so rename one of them",
        ),
        (
            "",
            '\n[[budget]]\nname = "b"\nmeasure = "reply:tld"\nmax = "1 ms"\n',
            "line 23: budget.b.measure: no reply 'tld' is expected; did you mean told?",
        ),
        (
            'text = "ask"\nat = "100 us"\n',
            'text = "ask"\nat = "100 us"\n[[budget]]\nname = "b"\nmeasure = "silence:ask"\nmax = 0\n',
            "line 15: budget.b.measure: no send 'ask' has expect = \"nothing\"; it has none",
        ),
    ],
)
def test_a_mistake_is_reported_with_file_and_line(small: Path, old: str, new: str, message: str):
    assert not old or old in TEXT
    small.write_text(TEXT.replace(old, new, 1) if old else TEXT + new, encoding="utf-8")
    assert sentence_of(BadCase, lambda: Scene(load(small))).removeprefix(f"{small}, ") == message


def test_a_reply_needs_a_serial_table(small: Path):
    text = TEXT.split("[[serial.send]]")[0] + '[[budget]]\nname = "b"\nmeasure = "reply:told"\nmax = "1 ms"\n'
    small.write_text(text, encoding="utf-8")
    with pytest.raises(BadCase, match="'reply:told' needs serial in the scene, which has none"):
        Scene(load(small))


def test_the_path_of_a_file_is_relative_to_the_folder_of_the_case(small: Path):
    (small.parent / "ask.bin").write_bytes(b"ask")
    small.write_text(TEXT.replace('text = "ask"', 'file = "ask.bin"'), encoding="utf-8")
    assert Scene(load(small)).run().sci_bytes == 3


@pytest.mark.parametrize(
    ("file", "message"),
    [
        ("/dev/zero", "/dev/zero cannot be read (Not a regular file); a path counts from the folder of the case"),
        ("long.bin", "long.bin cannot be read (Longer than 16777216 bytes); a path counts from the folder of the case"),
    ],
)
def test_an_endless_or_huge_file_is_refused(small: Path, file: str, message: str):
    with (small.parent / "long.bin").open("wb") as long:
        long.truncate(16 * 1024 * 1024 + 1)  # a sparse file takes no space
    small.write_text(TEXT.replace('text = "ask"', f'file = "{file}"'))
    assert sentence_of(BadCase, lambda: Scene(load(small))) == f"{small}, line 11: serial.send.ask.file: {message}"


def content(folder: Path, **given: object) -> bytes:
    case = Case.model_validate({"name": "x", "duration": "1 s"}).from_source(Source(folder / "case.toml", ""))
    entry = SendTable.model_validate({"to": "dsp.SCI-A", "at": "1 ms", **given})
    return content_of(case, entry, 8, "serial", "send", 0)


def test_content_is_a_text_bytes_or_a_file(tmp_path: Path):
    (tmp_path / "page.bin").write_bytes(b"\x00\xff")
    assert content(tmp_path, text="OK\r\n") == b"OK\r\n"
    assert content(tmp_path, text="µ", encoding="latin-1") == b"\xb5"
    assert content(tmp_path, text="µ", encoding="utf-8") == b"\xc2\xb5"
    assert content(tmp_path, bytes="55 aa") == b"\x55\xaa"
    assert content(tmp_path, file="page.bin") == b"\x00\xff"
    assert content(tmp_path, **{"break": "1 ms"}) == b""


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
