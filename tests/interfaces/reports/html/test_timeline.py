"""Lanes of the timeline, compared with the records of a separate run."""

from __future__ import annotations

from itertools import accumulate
from pathlib import Path

import pytest

from periph_sim.core.records import RECORDED, Kind, Record
from periph_sim.interfaces.reports.html import gather
from periph_sim.interfaces.reports.html.gather import CaseReport
from periph_sim.interfaces.reports.html.timeline import Lane, Timeline, only_chosen
from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene
from tests.interfaces.reports.html.made import CASE, report_of, small_report

IMAGE = """
name = "image"
duration = "100 us"

[unit.dsp]
image = "image.asm"
modules = ["GPIO"]

[[budget]]
name = "depth"
measure = "stack high-water"
max = 1

[[budget]]
name = "count"
measure = "level of variable _count"
max = 1
"""
COUNTS = """
          .reserve ".stack", 0x400, 64
          .sect ".data", 0x8800
_count:   .word 0
          .sect ".text", 0x9000
          .global _c_int00, _step, _count
_c_int00: MOV   SP,#0x400
          LCR   _step
          LCR   _step
          ESTOP0
_step:    MOVW  DP,#_count >> 6
          INC   @_count
          LRETR
"""


@pytest.fixture(scope="module")
def records(tmp_path_factory: pytest.TempPathFactory) -> list[Record]:
    """Return all records of the small case."""
    path = tmp_path_factory.mktemp("records") / "small.toml"
    path.write_text(CASE, encoding="utf-8")
    found: list[Record] = []
    Scene(load(path, []), lambda recorder, _: recorder.subscribe(RECORDED, found.append)).run()
    return sorted(found, key=lambda record: record.tick)


@pytest.fixture(scope="module")
def response(small: CaseReport) -> Timeline:
    return small.budgets[0].timeline


@pytest.fixture(scope="module")
def words(small: CaseReport) -> Timeline:
    """Return the timeline around the highest FIFO level, with the characters of the host."""
    return small.budgets[3].timeline


def lane(timeline: Timeline, group: str, name: str) -> Lane:
    return next(one for title, lanes in timeline.groups for one in lanes if (title, one.name) == (group, name))


def within(timeline: Timeline, records: list[Record]) -> list[Record]:
    ((first, last),) = timeline.kept
    return [r for r in records if first <= r.tick - timeline.origin <= last]


def test_waves_have_the_edges_of_the_wires(response: Timeline, records: list[Record]) -> None:
    for group, wire in (("I2C bus", "SCL"), ("I2C bus", "SDA"), ("UART", "RX")):
        wave = lane(response, group, wire)
        edges = [r for r in within(response, records) if r.kind is Kind.EDGE and r.where == wire]
        assert wave.kind == "wave" and len(edges) > 10
        assert wave.at == [r.tick - response.origin for r in edges]
        assert wave.initial == 1 - edges[0].value


def test_a_flag_is_drawn_with_its_changes_and_their_meaning(response: Timeline, records: list[Record]) -> None:
    wave = lane(response, "flags", "I2CSTR.XRDY")
    changes = [r for r in within(response, records) if r.kind is Kind.FLAG and r.what == "I2CSTR.XRDY"]
    assert wave.kind == "wave"
    assert wave.at == [r.tick - response.origin for r in changes]
    message = wave.says
    assert all(
        f"I2C-A.I2CSTR.XRDY {'set' if r.value else 'cleared'}" in text for r, text in zip(changes, message, strict=True)
    )
    assert any("by the write of I2C-A.I2CDXR at batch_read:" in text for text in message)
    assert "[SPRUG03B table 10]" in message[0]


def test_a_field_of_several_bits_is_a_row_of_boxes(words: Timeline, records: list[Record]) -> None:
    boxes = lane(words, "flags", "SCIFFRX.RXFFST")
    changes = [r for r in within(words, records) if r.kind is Kind.FLAG and r.what == "SCIFFRX.RXFFST"]
    assert boxes.kind == "boxes"
    assert boxes.at == [words.kept[0][0], *(r.tick - words.origin for r in changes)]
    assert boxes.end[:-1] == boxes.at[1:]
    assert boxes.labels[1:] == [str(r.value) if r.value < 10 else f"{r.value:#x}" for r in changes]


def test_accesses_have_value_and_place(response: Timeline, records: list[Record]) -> None:
    marks = lane(response, "accesses", "I2CDXR")
    writes = [r for r in within(response, records) if r.kind is Kind.ACCESS and r.what == "W I2C-A.I2CDXR"]
    assert marks.kind == "marks" and marks.strong == [1] * len(writes)
    assert marks.at == [r.tick - response.origin for r in writes]
    assert marks.places == [r.text for r in writes]
    assert marks.says[0].startswith("write of I2C-A I2CDXR=")


def test_bytes_equal_those_of_the_controller(response: Timeline, records: list[Record]) -> None:
    boxes = lane(response, "I2C bus", "bytes")
    assert boxes.kind == "boxes"
    message = boxes.labels
    whole = [r for r in within(response, records) if r.kind is Kind.BUS]
    assert message.count("S") == sum(r.what == "START" for r in whole)
    assert message.count("P") == sum(r.what == "STOP" for r in whole)
    addresses = [f"0x{r.value >> 1 >> 1:02X} {'R' if r.value >> 1 & 1 else 'W'}" for r in whole if r.what == "address"]
    assert [text for text in message if text.endswith((" R", " W"))] == addresses
    data = [f"0x{r.value >> 1:02X}" for r in whole if r.what == "byte"]
    assert [text for text in message if len(text) == 4] == data


def test_characters_on_rx_are_divided_into_their_ten_bits(words: Timeline, records: list[Record]) -> None:
    boxes, bits, wave = (lane(words, "UART", name) for name in ("RX bytes", "RX bits", "RX"))
    assert boxes.kind == bits.kind == "boxes" and wave.kind == "wave"
    sent = [r for r in within(words, records) if r.kind is Kind.FRAME and r.what == "byte"]
    assert boxes.labels == [text for r in sent for text in ("S", f"0x{r.value:02X}", "T")]
    for begin, end in zip(boxes.at[::3], boxes.end[2::3], strict=True):
        assert begin in wave.at  # the start bit falls
        assert abs((end - begin) / words.per_second - 10 / 115_200) < 1e-7
    assert all(any(b <= at < e for b, e in zip(boxes.at, boxes.end, strict=True)) for at in wave.at)
    assert "".join(bits.labels) == "".join(f"S{f'{r.value:08b}'[::-1]}T" for r in sent)
    assert bits.at[1:10] == bits.end[:9] and bits.end[9] == boxes.end[2]


def test_transfers_last_from_start_to_stop(response: Timeline, records: list[Record]) -> None:
    boxes = lane(response, "I2C bus", "transfer")
    bus = [r for r in within(response, records) if r.kind is Kind.BUS]
    assert boxes.kind == "boxes"
    assert boxes.at == [r.tick - response.origin for r in bus if r.what == "START"]
    assert boxes.end == [r.tick - response.origin for r in bus if r.what == "STOP"]


def test_service_routines_and_waits_last_from_their_begin_to_their_end(words: Timeline, records: list[Record]) -> None:
    for kind, name in ((Kind.IRQ, "interrupt"), (Kind.WAIT, "wait")):
        boxes = lane(words, "firmware", name)
        assert boxes.kind == "boxes"
        begins = [r.tick - words.origin for r in within(words, records) if r.kind is kind and r.value]
        ends = [r.tick - words.origin for r in within(words, records) if r.kind is kind and not r.value]
        assert set(begins) <= set(boxes.at) and set(ends) <= set(boxes.end)


def test_the_json_has_every_instant(response: Timeline) -> None:
    json = response.json()
    for (_, lanes_), group in zip(response.groups, json["groups"], strict=True):
        for one, packed in zip(lanes_, group["lanes"], strict=True):
            assert list(accumulate(packed["at"])) == one.at
            assert [json["says"][place] for place in packed["says"]] == one.says


def test_a_window_with_too_many_events_is_cut_around_the_occurrence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(gather, "MOST_OF_PASSED", 120)
    found = small_report(tmp_path).budgets[0].timeline
    assert found.kept[0][0] < found.begin and found.end < found.kept[0][1]
    events = sum(len(one.at) for _, lanes_ in found.groups for one in lanes_ if one.kind != "boxes")
    assert 60 < events <= 120


def test_lanes_of_a_response_are_those_of_its_explanation(response: Timeline) -> None:
    chosen = {one.name for _, lanes_ in response.groups for one in lanes_ if one.chosen}
    assert {"SCL", "SDA", "bytes", "I2CSTR.XRDY", "I2CSTR.SDIR", "wait", "I2CDXR"} <= chosen
    assert not chosen & {"RX", "RX bytes", "MODEL", "SCIFFRX.RXFFST", "I2CSTR.NACK"}
    assert len(chosen) < sum(len(lanes_) for _, lanes_ in response.groups) / 2


def test_lanes_of_a_full_fifo_are_those_of_the_host(words: Timeline) -> None:
    chosen = {one.name for _, lanes_ in words.groups for one in lanes_ if one.chosen}
    assert {"RX", "RX bytes", "SCIFFRX.RXFFINT"} <= chosen and not chosen & {"SCL", "SDA"}


def test_only_the_chosen_lanes_and_their_texts_are_kept(response: Timeline) -> None:
    cut = only_chosen(response)
    kept = [one for _, lanes_ in response.groups for one in lanes_ if one.chosen]
    left = [one for _, lanes_ in cut.groups for one in lanes_]
    assert left == kept and len(cut.json()["says"]) < len(response.json()["says"])


def test_the_stack_and_the_variables_of_an_image_are_lanes(tmp_path: Path) -> None:
    (tmp_path / "image.toml").write_text(IMAGE, encoding="utf-8")
    (tmp_path / "image.asm").write_text(COUNTS, encoding="utf-8")
    of_image = report_of(tmp_path / "image.toml")
    timelines = [one.timeline for one in of_image.budgets if one.timeline is not None]
    drawn = {one.name for timeline in timelines for _, lanes in timeline.groups for one in lanes}
    assert {"stack", "_count"} <= drawn
