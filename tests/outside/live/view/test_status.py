"""What a live session says of itself, with nothing of it changed by being looked at."""

from __future__ import annotations

import json

import pytest

from periph_sim.outside.live.view.status import Status
from tests.outside.live.view.imu import FRAME, Imu

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


def test_a_snapshot_tells_counts_rates_readings_and_attitude() -> None:
    told = watched().status.snapshot()
    assert (told["case"], told["where"], told["said"], told["over"]) == ("mine", "/dev/pts/1", ["client 1 came"], False)
    assert told["simulated_s"] == pytest.approx(0.081)
    assert told["totals"] == {"SCI bytes in": 12, "SCI bytes out": 0, "waiting": 0, "I2C bytes": 108, "rounds": 4}
    assert told["rates"]["SCI bytes in"] == pytest.approx(12 / 0.080)
    assert told["rates"]["rounds"] == pytest.approx(4 / 0.080)
    assert told["rates"]["pace"] == pytest.approx(0.5)
    assert [(one["chip"], one["unit"]) for one in told["readings"]] == [
        ("gyroscope", "deg/s"),
        ("accelerometer", "g"),
        ("magnetometer", "gauss"),
    ]
    assert told["attitude"] == pytest.approx([17.2, -11.5, 57.3], abs=1.5)  # by the noise and the codes of 10 bits
    assert told["flags"] == []
    assert json.loads(json.dumps(told)) == told


def test_budgets_and_lateness_so_far() -> None:
    imu = watched()
    told = imu.status.snapshot()
    states = {one["name"]: (one["state"], one["limit"]) for one in told["budgets"]}
    assert states == {
        "round": ("pass", "3 ms"),
        "too much": ("fail", "1 us"),
        "half": ("pass", "p50 10 us"),
        "none yet": ("", "3 %"),
    }
    assert told["budgets"][0]["seen"] == "2.620 ms" and told["budgets"][3]["seen"] == "-"
    late = told["lateness"]
    assert late is not None and sum(late["counts"]) == 5 and len(late["counts"]) == len(late["steps"]) + 1
    assert late["worst"] == pytest.approx(0.081) and (late["late"], late["when_late"]) == (2, "catch-up")
    imu.status._percentiles["half"] = (0.0, {**told["budgets"][2], "seen": "looked at before"})
    assert imu.status.snapshot()["budgets"][2]["seen"] == "looked at before"


def test_flags_that_stand_are_named() -> None:
    imu = watched()
    imu.line.hold_break(True)
    imu.passes("1 ms")
    assert "dsp.SCI-A.SCIRXST.BRKDT" in imu.status.snapshot()["flags"]


def test_looking_changes_no_record() -> None:
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
    assert wave is not None and wave["of"] == "round 4"
    assert (wave["at_s"], wave["length"]) == (pytest.approx(0.062, abs=1e-4), pytest.approx(2660, abs=1))
    lines = {one["name"]: one for one in wave["lines"]}
    assert list(lines) == ["SCL", "SDA", "RX"]
    assert lines["RX"] == {"name": "RX", "first": 1, "edges": []}
    clocks = 27 * 9 * 2 + 3 * 4  # two edges a bit, and two more at each repeated START and STOP
    assert lines["SCL"]["first"] == 1 and len(lines["SCL"]["edges"]) == clocks
    for line in wave["lines"]:
        assert line["edges"] == sorted(line["edges"]) and all(0 <= at <= wave["length"] for at in line["edges"])


def test_without_rounds_it_is_what_the_serial_lines_did() -> None:
    imu = Imu()
    assert imu.wave is not None and imu.wave.wave(0) is None
    imu.line.write(b"\x55")
    imu.passes("0.5 ms")
    wave = imu.wave.wave(imu.session.scene.start)
    assert wave is not None and wave["of"] == "the serial lines"
    assert [(one["name"], len(one["edges"])) for one in wave["lines"] if one["edges"]][-1] == ("RX", 10)


def test_a_case_without_bus_or_sensors_has_neither_readings_nor_attitude() -> None:
    from periph_sim.outside import Session
    from tests.outside.sessions import case

    session = Session(case("uart_logger", ("SCI-A",)), ("RX",))
    imu = Imu()
    told = Status(session, session.serial("scia"), imu.pacer).snapshot()
    assert (told["readings"], told["attitude"], told["wave"], told["budgets"]) == ([], None, None, [])
