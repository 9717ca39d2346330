"""Mistakes in the devices of a case file: one sentence with file, line and correction."""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim import BadCase, Scene, load
from tests.scene.small import sentence_of

CASE = """\
name = "small"
duration = "1 ms"

[unit.dsp]
firmware = "captured_master"
modules = ["I2C-A"]

[device.memory]
model = "24lc64"

[device.adc]
model = "registers"
address = 0x48

[[device.adc.register]]
name = "VALUE"
at = 0x02
width = 16

[[device.adc.register]]
name = "STATUS"
at = 0x01
"""
MEMORY = 'model = "24lc64"'
VALUE = "at = 0x02\nwidth = 16"
STATUS = "at = 0x01"


def refusal(folder: Path, old: str, new: str) -> str:
    """Return the sentence that refuses the changed case, without the folder."""
    assert CASE.count(old) == 1
    file = folder / "small.toml"
    file.write_text(CASE.replace(old, new), encoding="utf-8")
    return sentence_of(BadCase, lambda: Scene(load(file))).replace(f"{folder}/", "")


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        (
            MEMORY,
            'model = "24lc65"',
            "small.toml, line 9: device.memory.model: there is no device '24lc65'; did you mean 24lc64 or",
        ),
        (MEMORY, 'model = "flash"', "there is no device 'flash'; it has 24c02, 24lc02, 24aa02"),
        (MEMORY, 'model = "hmc5883l"', "hmc5883l is a sensor chip; give it a [chip.memory] table"),
        (MEMORY, "", "small.toml, line 8: device.memory.model is missing"),
        (
            MEMORY,
            f"{MEMORY}\naddress = 0x48",
            "line 10: device.memory.address: 24lc64 has no address 0x48; it can have 0x50, 0x51",
        ),
        (
            MEMORY,
            "model = '24lc02'\naddress = 0x51",
            "line 10: device.memory.address: 24lc02 has no address 0x51; it can have 0x50",
        ),
        (
            MEMORY,
            f"{MEMORY}\naddress = 0x80",
            "line 10: device.memory.address: expected an address of 7 bits, 0x00 to 0x7f",
        ),
        (MEMORY, f"{MEMORY}\npages = 8", "line 10: device.memory.pages: a 24lc64 has no such key; did you mean page?"),
        (
            MEMORY,
            f"{MEMORY}\nstrech = '1 us'",
            "line 10: device.memory.strech: a 24lc64 has no such key; did you mean stretch?",
        ),
        (MEMORY, f"{MEMORY}\npage = 24", "line 10: device.memory.page: a page is a power of two, but it is 24"),
        (
            MEMORY,
            'model = "24lc02"\npage = 0',
            "line 10: device.memory.page: expected 1 to 256",
        ),
        (
            MEMORY,
            f"{MEMORY}\nwrite_time = 5",
            'line 10: device.memory.write_time: 5 has no unit; write for instance "5 ms"',
        ),
        (
            MEMORY,
            f"{MEMORY}\ncontents = '0g'",
            "line 10: device.memory.contents: '0g' is not a sequence of bytes; "
            'write for instance "1d 00 ff", or name a file',
        ),
        (
            MEMORY,
            f"{MEMORY}\ncontents = 'no.bin'",
            "no.bin cannot be read (No such file or directory); its path is relative to the folder",
        ),
        (
            MEMORY,
            f"model = '24c02'\ncontents = '{'00' * 257}'",
            "line 10: device.memory.contents: it has 257 bytes, but a 24c02 holds 256",
        ),
        (
            MEMORY,
            f"{MEMORY}\nwrite_protect = 'WP'",
            "line 10: device.memory.write_protect: there is no wire 'WP'; name it in a unit's pins",
        ),
        (
            MEMORY,
            'model = "24c16"\n[device.other]\nmodel = "24c02"\naddress = 0x53',
            "line 12: device.other.address: memory has the address 0x53 too",
        ),
        (MEMORY, 'model = "no.py"\naddress = 0x42', "no.py'; its path counts from the folder of the case"),
        (MEMORY, 'model = "no.py"', "a device of a file has no address of its own; give it address = 0x42"),
        ("address = 0x48", "address = 0x50", "line 13: device.adc.address: memory has the address 0x50 too"),
        (
            "address = 0x48",
            "",
            "device.adc.address: a device of registers has no default address; give one such as address = 0x48",
        ),
        (
            "address = 0x48",
            "address = 0x48\nwrap = 'end'",
            "line 14: device.adc.wrap: expected 'pointer' or 'map', but it is 'end'",
        ),
        (VALUE, "at = 0x02\nwidth = 12", "line 18: device.adc.register.0.width: expected 8 or 16, but it is 12"),
        (
            VALUE,
            "at = 0x01\nwidth = 16",
            "line 22: device.adc.register.1.at: STATUS and VALUE overlap at 0x01; move one of them",
        ),
        (
            VALUE,
            "at = 0xFF\nwidth = 16",
            "line 17: device.adc.register.0.at: VALUE reaches 0x100, beyond 0xff, the last that",
        ),
        (
            VALUE,
            "at = 2\nreset = 0x100",
            "device.adc.register.0: reset of VALUE is 0x100, but a register of 8 bits ends at 0xff",
        ),
        (
            VALUE,
            "at = 2\nreed_only = true",
            "line 18: device.adc.register.0.reed_only: a registers has no such key; did you mean read_only?",
        ),
        (
            VALUE,
            "at = 2\nevery = '1 ms'",
            "device.adc.register.0: VALUE: 'every' needs 'values' or 'step', which define the new value",
        ),
        (VALUE, "at = 2\nread_only = 3\nwrite_1_clears = 1", "bits of VALUE are both read_only and write_1_clears"),
        (
            VALUE,
            "at = 2\nupdates = 'no.csv'",
            "line 18: device.adc.register.0.updates: no.csv cannot be read (No such file or directory)",
        ),
        (
            VALUE,
            "at = 2\nupdates = [['2 ms', 1], ['1 ms', 2]]",
            "line 18: device.adc.register.0.updates: the times of VALUE do not rise; sort its rows",
        ),
        (
            VALUE,
            "at = 2\nsets = { register = 'STATE', bits = 1 }",
            "there is no register 'STATE'; the map has VALUE, STATUS",
        ),
        (
            STATUS,
            "at = 1\n[device.adc.interrupt]\nwire = 'INT'\nregister = 'STATUS'",
            "line 24: device.adc.interrupt.wire: there is no wire 'INT'",
        ),
        ('name = "STATUS"', 'name = "VALUE"', "line 21: device.adc.register.1.name: there are two registers 'VALUE'"),
        *(
            ("[device.memory]", f"[device.{name}]", f"'{name}' is another party on the wires already; give the device")
            for name in ("dsp", "controller", "host", "serial", "outside")
        ),
        (MEMORY, f"{MEMORY}\nstretch = 20", "line 10: device.memory.stretch: expected a table"),
        (MEMORY, f"{MEMORY}\nstretch = '20'", "line 10: device.memory.stretch.length: '20'"),
        (
            MEMORY,
            f"{MEMORY}\n[device.memory.stretch]\nlength = '1 us'\nbyte = 1",
            "line 12: there is no key 'device.memory.stretch.byte'; did you mean bytes?",
        ),
        (
            MEMORY,
            f"{MEMORY}\n[[device.memory.fault]]\nkind = 'dead'",
            "line 11: device.memory.fault.0.kind: expected 'nack', 'wrong', 'flip', 'hold' or 'off'",
        ),
        (
            MEMORY,
            f"{MEMORY}\n[[device.memory.fault]]\nkind = 'off'\nbytes = [1]",
            "a fault of kind 'off' has no bytes; leave it out",
        ),
        (
            MEMORY,
            f"{MEMORY}\n[[device.memory.fault]]\nkind = 'hold'",
            "SDA is held either for a length or for a number of clocks; give one of them",
        ),
        (
            MEMORY,
            f"{MEMORY}\n[[device.memory.fault]]\nkind = 'wrong'",
            "a wrong byte needs its value, value = 0xFF for instance",
        ),
        (
            MEMORY,
            f"{MEMORY}\n[[device.memory.fault]]\nkind = 'flip'\nbytes = [0]",
            "is about bytes that the device sends, 1 and up of a read",
        ),
        (
            MEMORY,
            f"{MEMORY}\n[[device.memory.fault]]\nkind = 'nack'\nafter = '2 ms'\nuntil = '1 ms'",
            "'until' is not later than 'after'",
        ),
    ],
)
def test_a_mistake_is_reported_with_file_line_and_correction(tmp_path: Path, old: str, new: str, sentence: str):
    assert sentence in refusal(tmp_path, old, new)


def test_a_mistake_in_a_hex_file_is_reported_with_its_line(tmp_path: Path):
    for text, sentence in {
        ":00000001FF": "",
        ":0100000055AA\n": "it has no end record",
        ":0100000055AB\n:00000001FF": "image.hex, line 1: its checksum is 0xab, but 0xaa was expected",
        "55 66\n": "image.hex, line 1: '55 66' is no record of Intel HEX",
    }.items():
        (tmp_path / "image.hex").write_text(text)
        if sentence:
            assert sentence in refusal(tmp_path, MEMORY, f"{MEMORY}\ncontents = 'image.hex'")
