"""Tables of several buses merged into one list: the columns, the order of rows, and groups of rows."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim.traces.decode import i2c_table, spi, uart
from periph_sim.traces.decode.event_rows import (
    DETAILS,
    EVENTS,
    START,
    Rows,
    grouped,
    i2c_rows,
    joined,
    merged,
    no_rows,
    purpose_of,
    spi_rows,
    uart_rows,
)
from periph_sim.traces.decode.i2c_table import I2cTable
from periph_sim.traces.decode.uart import UartTable
from tests.traces.decode.test_i2c_table import of

KINDS = [np.int64, np.int64, np.uint8, np.uint8, np.int32, np.uint8, np.uint8]


def readable(rows: Rows) -> list[tuple[int, int, int, str, int, int, str]]:
    """The rows as tuples, with events and details in words."""
    return [
        (at, end, bus, EVENTS[event], value, bits, DETAILS[detail])
        for at, end, bus, event, value, bits, detail in zip(*(column.tolist() for column in rows), strict=True)
    ]


def test_i2c_rows_have_a_direction_for_complete_and_cut_bytes_only():
    kind = i2c_table.I2cRowKind
    of = [  # kind, at, last, end, value, bits, read
        (kind.START, 10, 10, 10, -1, 0, False),
        (kind.ADDRESS, 20, 27, 28, 0x53, 8, False),
        (kind.ACK, 30, 30, 31, -1, 1, False),
        (kind.REPEATED_START, 40, 40, 40, -1, 0, False),
        (kind.ADDRESS, 50, 57, 58, 0x53, 8, True),
        (kind.NACK, 60, 60, 61, -1, 1, True),
        (kind.ADDRESS_LOW, 62, 64, 66, 0x242, 8, False),
        (kind.DATA, 70, 77, 78, 0xA5, 8, True),
        (kind.CUT, 80, 82, 83, 0b101, 3, True),
        (kind.CUT, 84, 84, 85, 1, 1, False),
        (kind.STOP, 90, 90, 90, -1, 0, False),
    ]
    types = (np.uint8, np.int64, np.int64, np.int64, np.int16, np.uint8, np.bool_)
    columns = zip(zip(*of, strict=True), types, strict=True)
    rows = i2c_rows(I2cTable._make(np.array(column, of_type) for column, of_type in columns))
    assert readable(rows) == [
        (10, 10, 0, "start", -1, 0, ""),
        (20, 28, 0, "address", 0x53, 8, "write"),
        (30, 31, 0, "ack", -1, 1, ""),
        (40, 40, 0, "repeated start", -1, 0, ""),
        (50, 58, 0, "address", 0x53, 8, "read"),
        (60, 61, 0, "nack", -1, 1, ""),
        (62, 66, 0, "address low", 0x242, 8, "write"),
        (70, 78, 0, "data", 0xA5, 8, "read"),
        (80, 83, 0, "cut", 0b101, 3, "read"),
        (84, 85, 0, "cut", 1, 1, "write"),
        (90, 90, 0, "stop", -1, 0, ""),
    ]
    assert [column.dtype for column in rows] == KINDS


def test_a_ten_bit_read_address_is_complete_if_the_same_transfer_has_its_low_byte():
    bus = of("S F4+ 42+ Sr F5+ Sr F7+ P S F5+ P")  # F7 is another target, whose low byte is not known
    found = [row[4:6] for row in readable(i2c_rows(i2c_table.i2c_table(bus))) if row[3] == "address"]
    assert found == [(0x7A, 8), (0x242, 10), (0x7B, 8), (0x7A, 8)]


def test_uart_rows_have_words_for_every_set_of_faults():
    n = 8
    faults = [np.array([case >> place & 1 for case in range(n)], bool) for place in range(3)]
    of = UartTable(
        np.zeros(n, np.uint8), np.arange(n), np.arange(n) + 9, np.arange(n, dtype=np.int32), np.full(n, 8, np.uint8),
        *faults, np.zeros(n, np.int32),
    )  # fmt: skip
    rows = uart_rows(of)
    assert [detail for *_, detail in readable(rows)] == [
        "",
        "parity error",
        "frame error",
        "parity error, frame error",
        "glitch",
        "parity error, glitch",
        "frame error, glitch",
        "parity error, frame error, glitch",
    ]
    assert [row[:6] for row in readable(rows)] == [(case, case + 9, 0, "frame", case, 8) for case in range(n)]
    assert [column.dtype for column in rows] == KINDS


def test_uart_rows_have_a_word_for_every_kind():
    kinds = np.array([*uart.UartRowKind], np.uint8)
    zeros = np.zeros(len(kinds), np.int64)
    of = UartTable(kinds, zeros, zeros, zeros.astype(np.int32), zeros.astype(np.uint8), *[zeros > 0] * 3, zeros)
    assert dict(
        zip([kind.name for kind in uart.UartRowKind], [row[3] for row in readable(uart_rows(of))], strict=True)
    ) == {
        "FRAME": "frame",
        "BREAK": "break",
        "CUT": "cut",
        "REJECTED": "rejected start",
    }
    assert [row[2] for row in readable(uart_rows(of))] == [0] * 4


def made(*rows: tuple[int, int, int, int]) -> Rows:
    """Rows of (at, end, bus, event), whose values are their numbers."""
    of = np.array(rows, np.int64).reshape(-1, 4)
    count = len(of)
    columns = [of[:, 0], of[:, 1], of[:, 2], of[:, 3], np.arange(count), np.full(count, 8), np.zeros(count)]
    return Rows._make(column.astype(kind) for column, kind in zip(columns, KINDS, strict=True))


def test_empty_rows_have_the_types_of_other_rows():
    assert [column.dtype for column in no_rows()] == KINDS and len(no_rows().at) == 0
    some = made((5, 6, 0, START))
    assert readable(joined([no_rows(), some])) == readable(some) == readable(merged([some, no_rows()]))
    rows, first = grouped(no_rows(), [None, 4])
    assert len(rows.at) == 0 and first.tolist() == []


def test_merged_rows_at_one_position_keep_the_order_of_the_parts():
    one, other = made((5, 6, 0, 0), (9, 9, 0, 0)), made((5, 7, 1, 0), (2, 3, 1, 0))
    assert [(row[0], row[2]) for row in readable(merged([one, other]))] == [(2, 1), (5, 0), (5, 1), (9, 0)]
    assert [(row[0], row[2]) for row in readable(merged([other, one]))] == [(2, 1), (5, 1), (5, 0), (9, 0)]
    unsorted = made((9, 9, 0, 0), (5, 6, 0, 0))
    assert merged([unsorted]) is unsorted  # the table of one bus is assumed to be in order


ROWS = st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6), st.integers(0, 2), st.sampled_from([START, 4])))


@given(ROWS, st.integers(0, 5))
def test_groups_agree_with_a_loop_over_the_rows(drawn: list[tuple[int, int, int, int]], quiet: int):
    """Bus 0 is I2C, whose groups begin at a START. Buses 1 and 2 are serial; their groups begin after long silence."""
    silence, groups = [None, quiet, quiet + 1], []
    at, begun = 0, set()
    of = []
    for step, length, bus, event in drawn:
        at += step
        event = START if bus == 0 and bus not in begun else event
        begun.add(bus)
        of.append((at, at + length, bus, event))
    for bus, limit in enumerate(silence):
        mine = [(number, row) for number, row in enumerate(of) if row[2] == bus]
        for place, (number, row) in enumerate(mine):
            before = [end for _, (_, end, _, _) in mine[:place]]
            new = row[3] == START if limit is None else not before or row[0] - max(before) > limit
            if new:
                groups.append((row[0], bus, []))
            groups[-1][2].append(number)
    # Groups of one bus that begin at one position cannot be distinguished, so they are one.
    wanted: dict[tuple[int, int], list[int]] = {}
    for begin, bus, numbers in sorted(groups, key=lambda group: group[:2]):
        wanted.setdefault((begin, bus), []).extend(numbers)
    rows, first = grouped(made(*of), silence)
    found = np.split(rows.value, first[1:]) if len(of) else []
    assert [part.tolist() for part in found] == [*wanted.values()]
    assert first.tolist() == np.cumsum([0, *(len(numbers) for numbers in wanted.values())])[:-1].tolist()


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
def test_each_address_byte_has_the_purpose_in_the_table(byte: int):
    rows = [row.split(" ", 3) for row in TABLE.strip().splitlines()]
    named = [purpose for *bits, purpose in rows if matches("".join(bits), byte)]
    assert named == ([purpose_of(byte)] if purpose_of(byte) else [])


def test_spi_rows_have_words_of_up_to_63_bits():
    rows = spi_rows([spi.Event("word", 10, 73, (1 << 63) - 1, None, 63)], is_mosi=True)
    assert readable(rows) == [(10, 73, 0, "word", (1 << 63) - 1, 63, "")]
    with pytest.raises(OverflowError):
        spi_rows([spi.Event("word", 10, 74, 1 << 63, None, 64)], is_mosi=True)
