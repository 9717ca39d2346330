"""Reserved addresses, against the table of UM10204, section 3.1.12."""

from __future__ import annotations

import pytest

from periph_sim.traces.decode.reserved_addresses import purpose_of

TABLE = """
0000 000 0 general call
0000 000 1 START byte
0000 001 X CBUS
0000 010 X other bus format
0000 011 X future use
0000 1XX X Hs-mode controller code
1111 1XX X device ID
1111 0XX X 10-bit
"""


def matches(pattern: str, byte: int) -> bool:
    return all(p in ("X", b) for p, b in zip(pattern, f"{byte:08b}", strict=True))


@pytest.mark.parametrize("byte", range(256))
def test_each_address_byte_is_for_what_the_table_says(byte: int):
    rows = [row.split(" ", 3) for row in TABLE.strip().splitlines()]
    named = [purpose for *bits, purpose in rows if matches("".join(bits), byte)]
    assert named == ([purpose_of(byte)] if purpose_of(byte) else [])
