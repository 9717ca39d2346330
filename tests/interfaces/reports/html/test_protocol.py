"""Rows of the protocol table, compared with the records of their run."""

from __future__ import annotations

from periph_sim.core.records import Kind, Record
from periph_sim.interfaces.reports.html.timeline import Timeline
from tests.interfaces.reports.html.test_timeline import records, response, within, words

__all__ = ["records", "response", "words"]  # fixtures


def test_each_start_is_a_row_with_its_address_bytes_and_end(response, records: list[Record]) -> None:  # type: ignore[no-untyped-def]
    rows = [row for row in response.rows if row.bus == "I2C"]
    bus = [r for r in within(response, records) if r.kind is Kind.BUS]
    starts = [r for r in bus if r.what in ("START", "repeated START")]
    assert [row.at for row in rows] == [r.tick - response.origin for r in starts]
    assert [row.start for row in rows] == [{"START": "START"}.get(r.what, "Sr") for r in starts]
    first, second = rows[:2]
    assert (first.address, first.way, first.ack, first.data, first.stop) == (
        "0x68",
        "W",
        "ACK",
        (("1D", "ACK", ""),),
        False,
    )
    assert (second.way, second.stop, len(second.data)) == ("R", True, 6)
    assert [ack for _, ack, _ in second.data] == ["ACK"] * 5 + ["NACK"]
    assert second.end == next(r.tick for r in bus if r.what == "STOP") - response.origin and first.end == second.at
    assert [f"{r.value >> 1:02X}" for r in bus if r.what == "byte"] == [byte for row in rows for byte, *_ in row.data]


def test_frames_without_a_pause_are_one_row(words: Timeline, records: list[Record]) -> None:
    rows = [row for row in words.rows if row.bus == "RX"]
    sent = [r for r in within(words, records) if r.kind is Kind.FRAME and r.what == "byte"]
    assert [byte for row in rows for byte, *_ in row.data] == [f"{r.value:02X}" for r in sent]
    assert 1 <= len(rows) < len(sent) and rows[0].at == sent[0].tick - words.origin


def test_rows_are_in_order_of_time_and_in_the_json(response) -> None:  # type: ignore[no-untyped-def]
    assert [row.at for row in response.rows] == sorted(row.at for row in response.rows)
    assert response.json()["rows"][0] == response.rows[0]
