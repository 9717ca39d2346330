"""`fidelity`, one word or a table: which level each bus has, and what is refused with the way out."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from periph_sim.scene.case.fidelity import bus_levels, fidelity_text
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase
from periph_sim.scene.case.wiring import wiring_of
from periph_sim.scene.result import BYTE_LEVEL, FRAMES, FRAMES_PASSED
from periph_sim.scene.scene import Scene
from tests.scene import small
from tests.scene.runs import TIMING, run_file

UNITS = {
    "left": {"firmware": "none", "modules": ["I2C-A", "SCI-A", "GPIO"]},
    "right": {"firmware": "none", "modules": ["SCI-A", "SCI-B"]},
}
CABLE = [{"from": "left.SCI-A.TX", "to": "right.SCI-B.RX"}]
LEFT = {"left.SCI-A.TX", "left.SCI-A.RX"}


def levels(fidelity: Any) -> tuple[str, dict[str, str]]:
    case = small.case(unit=UNITS, cable=CABLE, fidelity=fidelity)
    found = bus_levels(case, wiring_of(case))
    return found.i2c, dict(found.lines)


def test_one_word_is_the_level_of_every_bus():
    assert levels("edge") == ("edge", {})
    i2c, lines = levels("byte")
    assert i2c == "byte" and set(lines.values()) == {"byte"} and len(lines) == 5


def test_a_table_names_buses_and_the_others_are_at_edges():
    assert levels({"I2C-A": "byte"}) == ("byte", {})
    i2c, lines = levels({"left": {"SCI-A": "adaptive"}, "right.SCI-A": "byte"})
    assert i2c == "edge" and lines["right.SCI-A.RX"] == lines["right.SCI-A.TX"] == "byte"
    assert lines["left.SCI-A.RX"] == "adaptive"
    assert "left.SCI-A.TX" not in lines  # it is also the line of right.SCI-B, which is at edges


def test_a_line_of_two_is_as_the_one_that_is_closer_to_edges():
    _, lines = levels({"left.SCI-A": "byte", "SCI-B": "adaptive"})
    assert lines["left.SCI-A.TX"] == lines["SCI-B.TX"] == "adaptive" and lines["left.SCI-A.RX"] == "byte"


@pytest.mark.parametrize(
    ("fidelity", "why"),
    [
        ({"SCI-C": "byte"}, "fidelity.SCI-C: there is no SCI 'SCI-C'; "),
        ({"SCI-A": "byte"}, "left and right have SCI-A; say whose is meant: left.SCI-A"),
        ({"left": {"SCI-B": "byte"}}, "unit left has no SCI-B; add it to its modules"),
        ({"RX": "byte"}, "there is no SCI 'RX'"),
        (
            {"right.SCI-B": "byte", "SCI-B": "edge"},
            "fidelity.SCI-B: that is right.SCI-B, which has a level already; leave one of them out",
        ),
    ],
)
def test_a_bus_that_there_is_not_is_refused_as_the_scene_is_built(fidelity: dict[str, Any], why: str):
    with pytest.raises(BadCase) as refused:
        levels(fidelity)
    assert why in str(refused.value)


def test_i2c_that_nobody_is_on_is_refused():
    with pytest.raises(BadCase, match=r"fidelity\.I2C-A: nobody is on I2C-A; there is dsp\.SCI-A"):
        Scene(load(TIMING / "uart_logger.toml", ["fidelity.I2C-A=byte"]))


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ("fidelity=bytes", "it is one of edge, adaptive, byte, or a table with one of them for each bus"),
        ("fidelity=3", "it is one of edge"),
        ("fidelity=schedule", "fidelity: level 'schedule' was removed: its arithmetic"),
        ("fidelity.SCI-A=schedule", "level 'schedule' was removed"),
        ("fidelity.SCI-A=bytes", "SCI-A: there is no level 'bytes' of a bus; did you mean byte?"),
        ("fidelity.SCI-A=[]", "SCI-A: there is no level [] of a bus"),
    ],
)
def test_a_level_that_there_is_not_is_refused_as_the_case_is_read(change: str, why: str):
    with pytest.raises(BadCase) as refused:
        load(TIMING / "uart_logger.toml", [change])
    assert why in str(refused.value) and "\n" not in str(refused.value)


def test_in_a_file_a_table_reads_as_it_is_meant(tmp_path: Path):
    text = (TIMING / "uart_logger.toml").read_text("utf-8")
    (tmp_path / "mine.toml").write_text(f'{text}\n[fidelity]\ndsp.SCI-A = "adaptive"\n', "utf-8")
    case = load(tmp_path / "mine.toml")
    assert case.fidelity == {"dsp.SCI-A": "adaptive"} and fidelity_text(case.fidelity) == "dsp.SCI-A=adaptive"
    (tmp_path / "mine.toml").write_text(f'{text}\n[fidelity]\ndsp.SCI-B = "adaptive"\n', "utf-8")
    with pytest.raises(BadCase, match=r"mine\.toml, line 25: fidelity\.dsp\.SCI-B: unit dsp has no SCI-B"):
        Scene(load(tmp_path / "mine.toml"))


def test_each_bus_runs_at_its_own_level():
    edge = run_file("imu_hil", "0.05").result
    events = {}
    for change, counts in {
        "fidelity.I2C-A=adaptive": {BYTE_LEVEL},
        "fidelity.SCI-A=adaptive": {FRAMES, FRAMES_PASSED},
        "fidelity=adaptive": {BYTE_LEVEL, FRAMES, FRAMES_PASSED},
    }.items():
        result = run_file("imu_hil", "0.05", change).result
        assert result.counts.keys() - edge.counts.keys() == counts
        assert result.budgets == edge.budgets
        events[change] = edge.events - result.events
    assert events["fidelity=adaptive"] == sum(events.values()) / 2 and min(events.values()) > 50
    assert run_file("imu_hil", "0.02", "fidelity.I2C-A=adaptive").result.fidelity == "I2C-A=adaptive"


def test_a_bus_that_cannot_be_at_byte_level_is_named_and_another_may_be():
    broken = "imu_hil_broken_line"
    with pytest.raises(BadCase, match=r'fidelity\.SCI-A: "byte" cannot be: fault 0 \(spike\) may pull RX edge by edge'):
        run_file(broken, "0.02", "fidelity.SCI-A=byte")
    result = run_file(broken, "0.02", "fidelity.I2C-A=byte", "fidelity.SCI-A=adaptive").result
    assert result.counts[BYTE_LEVEL] > 20 and result.counts[FRAMES_PASSED] == 0
