"""The picture of a divergence: both sides, aligned at the last event in agreement, and the actions of the chip."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from periph_sim.replay import picture
from periph_sim.replay.i2c_closed_loop import I2cReplay
from periph_sim.replay.i2c_master import I2cMasterReplay
from periph_sim.replay.i2c_open_loop import I2cOpenReplay
from periph_sim.replay.picture import Side, divergence_picture, last_agreed
from periph_sim.replay.report import Divergence, HistoryEntry
from periph_sim.replay.uart import UartReplay
from periph_sim.scene.case.load import load
from periph_sim.traces import formats
from periph_sim.traces.decode import i2c
from periph_sim.traces.decode.uart import Line
from periph_sim.traces.drawing.svg_diagram import BLACK, BLUE, GREY, ORANGE, Box, Lane, Mark, Tick
from tests.replay.slow import one_read, slow_case
from tests.replay.test_report import happened
from tests.traces.formats.make_traces import FOLDER
from tests.traces.formats.writers import I2cWave

CASES = Path(__file__).resolve().parents[2] / "timing"


def texts(svg: str | None) -> list[str]:
    assert svg is not None
    root = ElementTree.fromstring(svg)
    return ["".join(element.itertext()) for element in root.iter() if element.tag.endswith("text")]


@pytest.mark.parametrize(("replay", "side"), [(I2cReplay, "replay"), (I2cOpenReplay, "chip would drive")])
def test_a_wrong_byte_is_drawn_with_both_values_and_the_write_that_made_it(replay, side):
    player = replay(
        load(CASES / "responder.toml", ["unit.dsp.settings.replies=['e4']"]),
        formats.read(FOLDER / "nack.sr"),
        "SCL",
        "SDA",
    )
    shown = texts(player.picture(player.run()))
    for text in ("capture", side, "SCL", "SDA", "0xE5", "0xE4", "0x53 R", "A", "N", "AAS", "SDIR", "XRDY", "W I2CDXR"):
        assert text in shown, text
    assert "expected data read E5, found data read E4" in shown and "last agreed" in shown
    assert "1" not in shown, "flags of one bit are lines, and not boxes with their values"


def test_a_stretch_is_drawn_with_the_event_at_both_its_times(tmp_path):
    case = load(slow_case(tmp_path), ["unit.dsp.settings.wait=100"])
    player = I2cReplay(case, one_read(), "SCL", "SDA", tolerance=Fraction(1, 10**6))
    shown = texts(player.picture(player.run()))
    assert "capture: data read A7" in shown and "replay: data read A7 85.353 us later" in shown
    assert shown.count("0xA7") >= 2


def test_divergences_of_a_master_and_a_uart_are_drawn():
    case = load(CASES / "captured_master.toml", ["unit.dsp.settings.script=['53 R 1']"])
    player = I2cMasterReplay(case, formats.read(FOLDER / "nack.sr"), "SCL", "SDA")
    shown = texts(player.picture(player.run()))
    assert "expected address 53 write, found address 53 read" in shown and "0x53 W" in shown
    assert "last agreed" in shown
    frames = formats.read(FOLDER / "host_frames.sr")
    uart = UartReplay(load(CASES / "imu_hil_published.toml"), frames, "RX", Line(115200, 7))
    shown = texts(uart.picture(uart.run()))
    assert "last agreed" not in shown and "us, 0 is 0.000300 s of the capture" in shown
    assert "RX" in shown and any(text.startswith("capture: ") for text in shown)


@pytest.mark.parametrize(
    ("replay", "case"), [(I2cReplay, "responder"), (I2cOpenReplay, "responder"), (I2cMasterReplay, "captured_master")]
)
def test_without_a_divergence_there_is_no_picture(replay: Any, case: str):
    player = replay(load(CASES / f"{case}.toml"), formats.read(FOLDER / "nack.sr"), "SCL", "SDA")
    assert player.picture(player.run()) is None
    frames = formats.read(FOLDER / "host_frames.sr")
    uart = UartReplay(load(CASES / "uart_logger.toml"), frames, "RX", Line(115200))
    assert uart.picture(uart.run()) is None


# Numbers in the picture ---------------------------------------------------------------


class Drawn(NamedTuple):
    """The arguments of `timing_diagram`."""

    lanes: list[Lane]
    window: tuple[float, float]
    marks: list[Mark]
    title: str
    axis: str


def drawn(monkeypatch: pytest.MonkeyPatch, *given: Any, draw: Any = divergence_picture) -> Drawn:
    calls: list[Drawn] = []
    monkeypatch.setattr(picture, "timing_diagram", lambda *arguments: calls.append(Drawn(*arguments)))
    draw(*given)
    (call,) = calls
    return call


BOTH_AGREE = "0 is the last event that agrees, {:.6f} s in the capture, {:.6f} s in replay"


@pytest.mark.parametrize(
    ("times", "agreed", "window", "marks", "axis"),
    [
        ((12, 10), (11, 9), (-21, 14), "0 last agreed; 1 expected A, found B", BOTH_AGREE),
        ((12, 10.5), (11, 9), (-21, 14.5), "0 last agreed; 1 expected A, found B", BOTH_AGREE),
        ((12, 10.75), (11, 9), (-21, 14.75), "0 last agreed; 1 capture: A; 1.75 replay: B", BOTH_AGREE),
        ((12, None), (11, 9), (-21, 14), "0 last agreed; 1 expected A, found B", BOTH_AGREE),
        ((None, 11), (11, 9), (-20, 15), "0 last agreed; 2 expected A, found B", BOTH_AGREE),
        ((71, 69.5), (11, 9), (16, 73.5), "0 last agreed; 60 expected A, found B", BOTH_AGREE),
        ((11, 11), (11, 11), (-22, 13), "0 expected A, found B", "0 is 11.000000 s of the capture"),
        ((3, 3), (0, 0), (-19, 16), "0 the capture begins; 3 expected A, found B", "0 is 0.000000 s of the capture"),
        ((3, 3.5), (0, 1), (-19.5, 16), "0 last agreed; 3 expected A, found B", BOTH_AGREE),
        ((3.5, 3), (1, 0), (-19.5, 16), "0 last agreed; 2.5 expected A, found B", BOTH_AGREE),
    ],
)
def test_window_marks_and_axis_count_from_the_last_agreed_event_of_each_side(
    monkeypatch, times, agreed, window, marks, axis
):
    """A bit is 1 s; the window has 22 bits before and 13 after the divergence, at most 44 before its first event."""
    sides = (Side(name, (), Fraction(4), 0, (), at) for name, at in zip(("capture", "replay"), agreed, strict=True))
    call = drawn(monkeypatch, Divergence(3, "A", "B", *times), "title", *sides, 1.0)
    assert (call.window, call.title, call.axis) == (window, "title", axis.format(*agreed))
    assert "; ".join(f"{mark.at:g} {mark.text}" for mark in call.marks) == marks
    assert [mark.wrong for mark in call.marks] == [not mark.text.endswith(("agreed", "begins")) for mark in call.marks]


def read_of_12() -> formats.Capture:
    """Return a capture of 53 read: 12, not acknowledged; a position is 0.25 s, and a bit is 1 s."""
    return I2cWave(2, 1, idle=8).play("S A7+ 12- P .4").capture(4)


def test_the_lanes_show_bytes_edges_flags_and_accesses_of_the_window(monkeypatch):
    """The last event in agreement is at 11 s of the capture and 9 s of the replay; the window is -4.5 s to 4.75 s."""
    capture = read_of_12()
    lines = tuple((name, capture.channel(name)) for name in ("SCL", "SDA"))
    captured = Side("capture", lines, Fraction(4), 0, i2c.transfers(capture), 11.0)
    replayed = Side("replay", lines[:1], Fraction(2), 2, i2c.transfers(capture), 9.0, (Fraction(8), 16))
    history = (
        HistoryEntry(4.5, "I2C-A.I2CMDR.NACKMOD", 0),
        HistoryEntry(13.75, "I2C-A.I2CMDR.FREE", 1),
        HistoryEntry(4.25, "I2C-A.I2CMDR.IRS", 1),  # outside of the window: shown only for fields in ALWAYS
        HistoryEntry(14.0, "I2C-A.I2CMDR.MST", 1),
        HistoryEntry(9.5, "I2C-A.I2CFFRX.RXFFST", 1),
        HistoryEntry(10.5, "I2C-A.I2CFFRX.RXFFST", 2),
        HistoryEntry(-50.0, "I2C-A.I2CSTR.AAS", 1),
        HistoryEntry(9.0, "W I2C-A.I2CDXR", 0x12),
        HistoryEntry(9.5, "R I2C-A.I2CDRR", 0xAB),
        HistoryEntry(9.6, "R I2C-A.I2CSTR", 0x1),
        HistoryEntry(90.0, "W I2C-A.I2CDXR", 0x13),
        HistoryEntry(11.0, "W I2C-A.I2CDXR", 0x14),
    )
    wrong = Divergence(3, "data read 12", "data read 13", 12.0, 10.5, "byte", history)
    call = drawn(monkeypatch, wrong, "title", captured, replayed, 0.25)

    def edges(name: str, rate: int, origin: int, agreed: int) -> tuple[tuple[float, int], ...]:
        channel = capture.channel(name)
        moved = [
            ((at - origin) / rate - agreed, level) for at, level in zip(channel.edges, channel.levels, strict=True)
        ]
        return tuple((at, level) for at, level in moved if at <= 4.75)

    assert call.window == (-4.5, 4.75)
    assert edges("SDA", 4, 0, 11)[-1][0] == 4.75, "an edge at the window's end is in it"
    assert call.lanes == [
        Lane(
            "bytes",
            "capture",
            BLUE,
            boxes=(Box(-8, -0.8875, "0x53 R"), Box(0, 0.1125, "A"), Box(1, 8.1125, "0x12", True)),
        ),
        Lane("SCL", "capture", BLUE, 1, edges("SCL", 4, 0, 11)),
        Lane("SDA", "capture", BLUE, 1, edges("SDA", 4, 0, 11)),
        Lane(
            "bytes",
            "replay",
            ORANGE,
            boxes=(Box(-5, -1.3875, "0x12"), Box(-1, -0.8875, "N"), Box(-0.25, -0.25 + 0.1375, "P")),
        ),
        Lane("SCL", "replay", ORANGE, 1, edges("SCL", 2, 2, 9)),
        Lane("AAS", "flags", BLACK, 0, ((-59, 1),)),
        Lane("RXFFST", "flags", BLACK, boxes=(Box(0.5, 1.5, "1"), Box(1.5, 4.75, "2"))),
        Lane("NACKMOD", "flags", BLACK, 1, ((-4.5, 0),)),
        Lane("FREE", "flags", BLACK, 0, ((4.75, 1),)),
        Lane("W I2CDXR", "firmware", GREY, ticks=(Tick(0, "12"), Tick(2, "14"))),
        Lane("R I2CDRR", "firmware", GREY, ticks=(Tick(0.5, "AB"),)),
    ]


def test_nine_flags_and_nine_registers_are_drawn_at_most(monkeypatch):
    history = [HistoryEntry(1.0, f"I2C-A.R.F{number}", 1) for number in range(10)]
    history += [HistoryEntry(1.0, f"W I2C-A.R{number}", 1) for number in range(10)]
    side = Side("replay", (), Fraction(1), 0, (), 0.0)
    call = drawn(monkeypatch, Divergence(0, "A", "B", 1.0, 1.0, "byte", tuple(history)), "", side, side, 1.0)
    assert [lane.name for lane in call.lanes] == [*(f"F{n}" for n in range(9)), *(f"W R{n}" for n in range(9))]


@pytest.mark.parametrize(("index", "agreed"), [(0, (0, 0)), (1, (0, 0.5)), (2, (0.5, 1)), (3, (0, 0)), (4, (0, 0))])
def test_the_last_agreed_event_has_its_time_on_each_side(index: int, agreed: tuple[float, float]):
    """The replay is half a second late, and has two of the three events."""
    wrong = Divergence(index, "A", "B", None, None)
    assert last_agreed(wrong, happened("START ACK STOP"), happened("START ACK", late=1)) == agreed


@pytest.mark.parametrize(
    ("player", "case", "setting", "title"),
    [
        (I2cReplay, "responder", "replies=['e4']", "closed loop: event 17 of 19"),
        (I2cOpenReplay, "responder", "replies=['e4']", "open loop: event 17 of 19"),
        (
            I2cMasterReplay,
            "captured_master",
            "script=['53 W', '53 W', '53 W', '53 W 01']",
            "closed loop: event 12 of 19",
        ),
    ],
)
def test_both_sides_have_the_same_bytes_at_the_same_times_up_to_the_wrong_one(
    monkeypatch, player: Any, case: str, setting: str, title: str
):
    replay = player(
        load(CASES / f"{case}.toml", [f"unit.dsp.settings.{setting}"]), formats.read(FOLDER / "nack.sr"), "SCL", "SDA"
    )
    call = drawn(monkeypatch, replay.run(), draw=replay.picture)
    assert call.title == f"{case}, nack.sr, {title}"
    captured, replayed = [lane.boxes for lane in call.lanes if lane.name == "bytes"]
    upto = next(number for number, box in enumerate(captured) if box.wrong) + 1
    assert [box.wrong for box in captured[:upto]] == [box.wrong for box in replayed[:upto]]
    assert [box.text for box in captured[: upto - 1]] == [box.text for box in replayed[: upto - 1]]
    assert captured[upto - 1].text != replayed[upto - 1].text and upto > 1
    for one, other in zip(captured[: upto - 1], replayed[: upto - 1], strict=True):
        assert (one.begin, one.end) == pytest.approx((other.begin, other.end), abs=2e-6)
    if player is not I2cMasterReplay:
        assert captured[0].begin == pytest.approx(replayed[0].begin, abs=1e-12)
