"""A run at the cheapest level within a bound: measured on its first part, watched, made again on edges if need be."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.api import make_case
from periph_sim.bus.i2c.transfer import Phase, Transfer
from periph_sim.core.records import UNHEARD, Kind
from periph_sim.reports.level_choice.auto import STRETCHED, UnmetWatch, run_within
from periph_sim.reports.level_choice.choose import best_within
from periph_sim.reports.level_choice.compared import compare_levels
from periph_sim.reports.level_choice.levels import level_of
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase, Case

TIMING = Path(__file__).resolve().parents[3] / "timing"
US = 1e-6

LATER = """\
from periph_sim.firmware import start_i2c, start_pin


def main(dsp, settings):
    start_pin(dsp, 0)
    start_i2c(dsp, 0x50)
    i2c = dsp.module("I2C-A")
    i2c.I2CMDR.IRS = 1
    for number in range(1000):
        dsp.spin(lambda: i2c.I2CSTR.RRDY == 1)
        i2c.I2CDRR.all
        if number == {number}:
            dsp.set_pin(0)
"""


def made(path: Path, *changes: str) -> Callable[[Sequence[str]], Case]:
    return lambda more: load(path, [*changes, *more])


def later(folder: Path, number: int) -> Callable[[Sequence[str]], Case]:
    """One byte every millisecond; with the one of this number a pin rises for the first time."""
    (folder / "later.py").write_text(LATER.format(number=number), encoding="utf-8")
    request = [{"name": "byte", "address": 0x50, "write": "11", "count": 0}]
    return lambda more: make_case(
        more,
        name="later",
        duration="200 ms",
        unit={"dsp": {"firmware": str(folder / "later.py"), "modules": ["I2C-A", "GPIO"]}},
        controller={"first": "1 ms", "period": "1 ms", "request": request},
    )


def test_the_cheapest_within_a_bound_runs_the_whole_scene():
    scene, result, choice = run_within(made(TIMING / "responder.toml"), US, None)
    assert (choice.level, choice.unmet, result.fidelity) == ("byte", "", "byte")
    assert (choice.measured_s, choice.used_s) == (0.06, 0.1) and choice.cpu_s > 0
    assert choice.heading() == "; byte, measured on 60 ms, used for 100 ms"
    assert choice.total_cpu_s > choice.cpu_s and "CPU time" in choice.sentence()
    assert result.simulated_s == 0.1 and scene.case.fidelity == "byte"


def test_a_bound_below_what_byte_is_off_by_takes_a_level_that_is_exact():
    _, result, choice = run_within(made(TIMING / "trade" / "nack_interrupt.toml"), US, Fraction(1, 10))
    assert (choice.level, result.fidelity) == ("adaptive", "adaptive")
    _, result, _ = run_within(made(TIMING / "trade" / "nack_interrupt.toml"), 6 * US, Fraction(1, 10))
    assert result.fidelity == "byte"  # its NACK is 5 us late


def test_what_was_not_met_in_the_measured_part_is_run_on_edges(tmp_path: Path):
    scene, result, choice = run_within(later(tmp_path, 100), US, None)
    assert choice.best.level is not None and choice.best.level.name == "byte"
    assert (choice.level, result.fidelity, scene.case.fidelity) == ("edge", "edge", "edge")
    assert choice.unmet.startswith("dsp.GPIO GP") and ", at 101." in choice.unmet  # by the access that sets the pin
    assert f"fell back to edges at {choice.unmet}" in choice.sentence()
    assert result.simulated_s == 0.2


def test_what_was_met_there_may_come_again(tmp_path: Path):
    _, result, choice = run_within(later(tmp_path, 10), US, None)
    assert (choice.level, choice.unmet, result.fidelity) == ("byte", "", "byte")


def test_a_part_in_which_nothing_occurs_is_refused(tmp_path: Path):
    nothing = "nothing measured: no flag, interrupt or byte occurs in the first"
    with pytest.raises(BadCase, match=f"{nothing} 0 ms of 100 ms, .*; simulate longer with --seconds"):
        run_within(made(TIMING / "responder.toml"), US, Fraction(0))
    chips = made(TIMING / "imu_chips.toml", "controller.first=70 ms")
    with pytest.raises(BadCase, match=f"{nothing} 60 ms of .*; give --fidelity adaptive, which needs no measurement"):
        run_within(chips, US, Fraction(1, 10))


def test_a_budget_that_does_not_occur_in_the_first_part_keeps_byte_from_being_chosen():
    """Nothing but set-up takes place in the first 60 ms."""
    _, result, choice = run_within(made(TIMING / "responder.toml", "controller.first=70 ms"), US, None)
    assert result.fidelity == "edge"
    assert (
        "byte has no known error in wrong bytes, nacked rounds, missed rounds, unmeasured in 60 ms" in choice.best.why
    )


def test_a_budget_that_does_not_occur_keeps_no_level_with_the_records_of_edge_from_being_chosen():
    late = made(TIMING / "imu_moving.toml")  # values are judged from 60 ms on
    found = compare_levels(late, (level_of("edge"), level_of("adaptive"), level_of("byte")), Fraction(3, 100))
    assert "value error of gyroscope" in found.unmeasured_budgets
    levels = [best_within(found, bound_s=1, whole_s=whole).level for whole in (0.3, 0.03)]
    assert [level and level.name for level in levels] == ["adaptive", "byte"]  # nothing else comes in 0.03 s of 0.03 s


def test_the_watch_hears_only_what_was_not_met():
    flag = (Kind.FLAG, "dsp.I2C-A", "I2CSTR.AL")
    ack, both = (Kind.BUS, "controller", "byte"), (Kind.FLAG, "dsp.I2C-A", "I2CSTR.BB")
    watch = UnmetWatch({ack: frozenset({0}), both: frozenset({0, 1})}, stretched=True)
    assert watch.tag_of(*both) == UNHEARD and watch.tag_of(Kind.EDGE, "SCL", "level") == UNHEARD
    bytes_tag, flag_tag = watch.tag_of(*ack), watch.tag_of(*flag)
    watch.hear(bytes_tag, 5, 0xA0)
    assert watch.first is None
    watch.hear(bytes_tag, 7, 0xA1)  # NACK
    watch.hear(flag_tag, 9, 1)
    assert watch.first == ("controller byte", 7)


@pytest.mark.parametrize(("before", "noticed"), [(False, (STRETCHED, 42)), (True, None)])
def test_a_byte_that_is_stretched_for_the_first_time_is_noticed(before: bool, noticed: tuple[str, int] | None):
    watch = UnmetWatch({}, stretched=before)
    watch.transfer(Transfer("smooth", [Phase(0x50, read=True)], stop_at=30))
    assert watch.first is None
    watch.transfer(Transfer("held", [Phase(0x50, read=True, stretch=1)], stop_at=42))
    assert watch.first == noticed
