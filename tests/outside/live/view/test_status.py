"""The status of a live session; taking it does not affect the session."""

from __future__ import annotations

import json
import threading

import pytest

from periph_sim.core.records import UNWANTED, Kind, Recorder
from periph_sim.core.time import Timebase
from periph_sim.devices.sensor_rounds import Round
from periph_sim.outside import Session
from periph_sim.outside.live.pacing import Pacer
from periph_sim.outside.live.view.last_round import KEPT, LastRound
from periph_sim.outside.live.view.status import Board, Status
from tests.outside.live.view.imu import FRAME, Clock, Imu
from tests.outside.sessions import case

BUDGETS = [
    {"name": "round", "measure": "round", "max": "3 ms"},
    {"name": "too much", "measure": "round", "max": "1 us"},
    {"name": "half", "measure": "response", "p50": "10 us"},
    {"name": "none yet", "measure": "cpu load", "max": "3 %"},
]


def watched() -> Imu:
    imu = Imu(budget=BUDGETS)
    imu.status.say("client 1 came")
    imu.passes("1 ms")
    imu.status.snapshot()
    imu.line.write(FRAME)
    for _ in range(4):
        imu.passes("20 ms")
    return imu


def test_a_snapshot_contains_counts_rates_readings_and_attitude() -> None:
    snapshot = watched().status.snapshot()
    assert (snapshot["case"], snapshot["where"], snapshot["said"], snapshot["over"]) == (
        "mine",
        "/dev/pts/1",
        ["client 1 came"],
        False,
    )
    assert snapshot["simulated_s"] == pytest.approx(0.081)
    assert snapshot["totals"] == {"SCI bytes in": 12, "SCI bytes out": 0, "waiting": 0, "I2C bytes": 108, "rounds": 4}
    assert snapshot["rates"]["SCI bytes in"] == pytest.approx(12 / 0.080)
    assert snapshot["rates"]["rounds"] == pytest.approx(4 / 0.080)
    assert snapshot["rates"]["pace"] == pytest.approx(0.5)
    assert [(one["chip"], one["unit"]) for one in snapshot["readings"]] == [
        ("gyroscope", "deg/s"),
        ("accelerometer", "g"),
        ("magnetometer", "gauss"),
    ]
    assert snapshot["attitude"] == pytest.approx(
        [17.2, -11.5, 57.3], abs=1.5
    )  # noise and 10-bit codes limit the accuracy
    values = {one["chip"]: one["values"] for one in snapshot["readings"]}
    assert [value * 115 / 8 for value in values["gyroscope"]] == pytest.approx([-44, 51, 1])
    assert [value * 256 for value in values["accelerometer"]] == pytest.approx([-59, -72, -241])
    assert [value * 660 for value in values["magnetometer"]] == pytest.approx([-16, -79, 31])
    assert snapshot["flags"] == []
    assert json.loads(json.dumps(snapshot)) == snapshot


def test_waiting_bytes_and_sent_bytes_are_counted_separately() -> None:
    imu = watched()
    imu.line.write(FRAME)
    assert imu.status.snapshot()["totals"] | {"I2C bytes": 0, "rounds": 0} == {
        "SCI bytes in": 12,
        "SCI bytes out": 0,
        "waiting": 12,
        "I2C bytes": 0,
        "rounds": 0,
    }


def test_a_snapshot_is_put_four_times_a_second_and_at_the_end() -> None:
    """
    clock, ms   0   240  250  499  500  close
    snapshot    1         2         3    4, over
    """
    imu, now, board = watched(), [0.0], Board()
    door, seen = Status(imu.session, imu.line, imu.pacer, board, clock=lambda: now[0]), []
    for now[0] in (0.0, 0.24, 0.25, 0.499, 0.5):
        door.turn()
        seen.append(board.after(0, 0)[0])
    assert seen == [1, 1, 2, 2, 3] and door.files() == ()
    door.close()
    number, last = board.after(3, 0)
    assert number == 4 and last is not None and last["over"] and board.closed
    assert board.after(4, 30.0) == (4, None)  # at once, since there will be no more


def test_budgets_and_lateness_so_far() -> None:
    imu = watched()
    snapshot = imu.status.snapshot()
    states = {one["name"]: (one["state"], one["limit"]) for one in snapshot["budgets"]}
    assert states == {
        "round": ("pass", "3 ms"),
        "too much": ("fail", "1 us"),
        "half": ("pass", "p50 10 us"),
        "none yet": ("", "3 %"),
    }
    seen = [(one["seen"], one["margin"]) for one in snapshot["budgets"]]
    assert seen == [("2.620 ms", "380.000 us"), ("2.620 ms", "-2.619 ms"), ("5.000 us", "5.000 us"), ("-", "-")]
    late = snapshot["lateness"]
    assert late is not None and late.pop("worst") == pytest.approx(0.081)
    assert late == {
        "steps": [0.0001, 0.0002, 0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 1.0],
        "counts": [0, 0, 0, 1, 0, 0, 0, 0, 2, 2, 0, 0],
        "p99": 0.1,
        "late": 2,
        "slips": 0,
        "tolerated": 0.05,
        "when_late": "catch-up",
    }


def test_rates_are_those_of_the_last_two_seconds_and_sentences_the_last_three() -> None:
    """A snapshot every second of the clock, which is half a second of the session; 100 bytes are sent in the first."""
    session, clock, shown = Session(case("uart_logger", ("SCI-A",)), ("RX",)), Clock(), []
    clock.session, line = session, session.serial("scia")
    status = Status(session, line, Pacer(session.ticks_per_second, clock=clock), Board(), clock=clock)
    line.write(bytes(100))
    for number in range(6):
        status.say(f"{number}")
        shown.append(status.snapshot())
        session.advance(session.now + session.ticks("500 ms"))
    rates = [one["rates"].get("SCI bytes in") for one in shown]
    assert rates == [None, 200.0, 100.0, 0.0, 0.0, 0.0]
    assert [one["said"] for one in shown[2:4]] == [["0", "1", "2"], ["1", "2", "3"]]
    assert status.snapshot(over=True)["over"] and shown[0]["lateness"] is None


def test_a_percentile_is_computed_every_ten_seconds() -> None:
    imu = watched()
    budget = imu.status.snapshot()["budgets"][2]
    old = {**budget, "seen": "looked at before"}
    for since, seen in ((9.99, "looked at before"), (10.0, "5.000 us")):
        imu.status._percentiles["half"] = (imu.status._clock() - since, old)
        assert imu.status.snapshot()["budgets"][2]["seen"] == seen


def test_flags_that_are_set_are_named() -> None:
    imu = watched()
    imu.line.hold_break(True)
    imu.passes("1 ms")
    assert "dsp.SCI-A.SCIRXST.BRKDT" in imu.status.snapshot()["flags"]


def test_taking_snapshots_changes_no_record() -> None:
    looked, alone = Imu(budget=BUDGETS), Imu(watched=False, budget=BUDGETS)
    for imu in (looked, alone):
        imu.line.write(FRAME * 2)
        for _ in range(9):
            imu.passes("3 ms")
            if imu is looked:
                imu.status.snapshot()
    assert looked.records.kept == alone.records.kept and len(alone.records.kept) > 1000
    assert looked.session.finish().counts == alone.session.finish().counts


def test_the_wave_of_the_last_round() -> None:
    imu = watched()
    wave = imu.status.snapshot()["wave"]
    assert wave is not None and wave["title"] == "round 4"
    assert (wave["at_s"], wave["length"]) == (pytest.approx(0.062, abs=1e-4), pytest.approx(2660, abs=1))
    lines = {one["name"]: one for one in wave["lines"]}
    assert list(lines) == ["SCL", "SDA", "RX"]
    assert lines["RX"] == {"name": "RX", "first": 1, "edges": []}
    clocks = 27 * 9 * 2 + 3 * 4  # two edges per bit and per repeated START, two for START and STOP
    assert lines["SCL"]["first"] == 1 and len(lines["SCL"]["edges"]) == clocks
    for line in wave["lines"]:
        assert line["edges"] == sorted(line["edges"]) and all(0 <= at <= wave["length"] for at in line["edges"])
        assert line["edges"] == [round(at, 3) for at in line["edges"]]


def test_the_edges_of_a_round_extend_20_us_before_and_after_it() -> None:
    """
    at  -21  -20   -1    0   50  100  120  121 us of a round from 0 to 100, which begins 1 ms after the run
    A     0    1         0              1    0
    B                               0
    C                                        0
    D     1    0
    """
    wave = LastRound(("A", "B", "C", "D"))
    wave.subscribe(Recorder(), Timebase(150_000_000))
    us, began = 3000, 5_000_000
    edges = [(-21, 0, 0), (-21, 3, 1), (-20, 0, 1), (-20, 3, 0), (0, 0, 0), (100, 1, 0), (120, 0, 1), (121, 0, 0)]
    for at, line, level in [*edges, (121, 2, 0)]:
        wave.on_record(line, began + at * us, level)
    wave._round(Round(7, began, began, began + 100 * us))
    assert wave.wave(began - 1000 * us) == {
        "title": "round 7",
        "at_s": 0.00098,
        "length": 140.0,
        "lines": [
            {"name": "A", "first": 0, "edges": [0.0, 20.0, 140.0]},
            {"name": "B", "first": 1, "edges": [120.0]},
            {"name": "D", "first": 1, "edges": [0.0]},
        ],
    }
    alone = LastRound(("RX",))
    alone.subscribe(Recorder(), Timebase(150_000_000))
    assert alone.wave(0) is None
    for at, level in ((10_000, 0), (12_000, 1)):
        alone.on_record(alone.tag_of(Kind.EDGE, "RX", "level"), at * us, level)
    lines = [{"name": "RX", "first": 1, "edges": [20.0, 2020.0]}]
    assert alone.wave(0) == {"title": "the serial lines", "at_s": 0.00998, "length": 2040.0, "lines": lines}
    assert alone.tag_of(Kind.EDGE, "TX", "level") == UNWANTED
    for at in range(20_000, 20_000 + KEPT - 1):  # one of the earlier edges is kept
        alone.on_record(0, at, at & 1)
    alone.on_record(0, 12_000 * us, 0)
    full = alone.wave(0)
    assert full is not None and full["lines"][0]["edges"] == [2020.0]
    alone._round(Round(1, 0, 0, 12_000 * us))
    full = alone.wave(0)
    assert full is not None and len(full["lines"][0]["edges"]) == KEPT == 16_384


def test_without_rounds_the_wave_shows_the_serial_lines() -> None:
    imu = Imu()
    assert imu.wave is not None and imu.wave.wave(0) is None
    imu.line.write(b"\x55")
    imu.passes("0.5 ms")
    wave = imu.wave.wave(imu.session.scene.start)
    assert wave is not None and wave["title"] == "the serial lines"
    assert [(one["name"], len(one["edges"])) for one in wave["lines"] if one["edges"]][-1] == ("RX", 10)


def test_a_case_without_bus_or_sensors_has_neither_readings_nor_attitude() -> None:
    session = Session(case("uart_logger", ("SCI-A",)), ("RX",))
    imu = Imu()
    snapshot = Status(session, session.serial("scia"), imu.pacer, Board()).snapshot()
    assert (snapshot["readings"], snapshot["attitude"], snapshot["wave"], snapshot["budgets"]) == ([], None, None, [])


@pytest.fixture
def board() -> Board:
    return Board()


def test_a_reader_receives_only_newer_snapshots(board: Board) -> None:
    assert board.after(0, 0.0) == (0, None)
    board.put({"round": 1})  # type: ignore[typeddict-item]
    board.put({"round": 2})  # type: ignore[typeddict-item]
    assert board.after(0, 0.0) == board.after(1, 0.0) == (2, {"round": 2})
    assert board.after(2, 0.0) == (2, None)


@pytest.mark.parametrize("news", [lambda board: board.put({}), Board.close])
def test_a_waiting_reader_is_woken(board: Board, news) -> None:
    came: list[int] = []
    reader = threading.Thread(target=lambda: came.append(board.after(0, 60.0)[0]))
    reader.start()
    news(board)
    reader.join(30)
    assert came == [0 if board.closed else 1]
