"""`periph-sim trade`: tables, JSON, a picture, a bound, and what is said of mistakes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.commands.conftest import Run

TIMING = Path(__file__).resolve().parents[2] / "timing"
RESPONDER = str(TIMING / "responder.toml")
QUICK = ("trade", RESPONDER, "--seconds", "0.02", "--level", "adaptive", "--level", "poll_pass=21")


def test_what_levels_cost_and_how_far_they_are_off(periph_sim: Run):
    came = periph_sim(*QUICK)
    assert (came.status, came.err) == (0, "")
    assert came.out.startswith("responder: the first 20 ms of 100 ms, ")
    rows = [line.split() for line in came.out.splitlines()]
    edge, adaptive, slow = (
        next(row for row in rows if row[:1] == [name]) for name in ("edge", "adaptive", "poll_pass=21")
    )
    assert edge[-1] == "reference" and adaptive[-1] == "exact" and float(slow[-1]) > 1
    assert float(adaptive[4]) < float(edge[4])  # events a byte
    assert "100.0 % of the I2C bytes at byte level" in " ".join(came.out.split())


def test_one_json_object_with_every_observable(periph_sim: Run):
    told = json.loads(periph_sim(*QUICK, "--max-error", "1 ns", "--json").out)
    edge, adaptive, slow = told["levels"]
    assert [level["name"] for level in (edge, adaptive, slow)] == ["edge", "adaptive", "poll_pass=21"]
    assert adaptive["cost"]["events"] < edge["cost"]["events"]
    assert len(adaptive["observables"]) == len(slow["observables"]) > 20
    assert {each["worst"] for each in adaptive["observables"] if each["count"]} == {0}
    assert slow["worst_cycles"] > 0
    assert told["max_error"]["level"] == "adaptive"


def test_an_infinite_error_is_told_as_such_with_its_reason(periph_sim: Run, desk: Path):
    (desk / "late.py").write_text(LATE, encoding="utf-8")
    (desk / "late.toml").write_text(CASE, encoding="utf-8")
    told = json.loads(periph_sim("trade", "late.toml", "--level", "poll_pass=21", "--json").out)
    flag = next(one for one in told["levels"][1]["observables"] if one["name"] == "dsp.GPIO.GPADAT.GPIO0 set")
    assert (flag["worst"], flag["mean"], flag["lacking"]) == ("infinite", "infinite", 1)
    came = periph_sim("trade", "late.toml", "--level", "poll_pass=21")
    assert "dsp.GPIO.GPADAT.GPIO0 set: lacks 1\n" in came.out


LATE = """\
from periph_sim.firmware import start_pin


def main(dsp, settings):
    start_pin(dsp, 0)
    timer = dsp.module("TIMER0")
    timer.TCR.TRB = 1
    before = timer.TIM.all
    dsp.spin(lambda: timer.TIM.all < before - 200)
    if before - timer.TIM.all > 216:
        dsp.set_pin(0)
"""
CASE = """\
name = "late"
duration = "1 ms"

[unit.dsp]
firmware = "late.py"
modules = ["GPIO", "TIMER0"]
"""


def test_the_cheapest_level_within_a_bound_is_named(periph_sim: Run):
    came = periph_sim(*QUICK, "--max-error", "1 us")
    assert came.status == 0
    assert "within 1 us: adaptive is the cheapest, " in came.out


def test_a_level_that_is_off_by_more_is_not_taken(periph_sim: Run):
    came = periph_sim("trade", RESPONDER, "--seconds", "0.02", "--level", "poll_pass=21", "--max-error", "1 ns")
    assert came.status == 0 and "within 0.001 us: edge alone" in came.out
    assert "poll_pass=21 is off by " in " ".join(came.out.split())


@pytest.mark.parametrize("more", [(), ("--max-error", "1 us"), ("--json",)])
def test_a_part_in_which_nothing_occurs_is_refused(periph_sim: Run, more: tuple[str, ...]):
    came = periph_sim("trade", RESPONDER, "--seconds", "0", "--level", "adaptive", *more)
    assert (came.status, came.out) == (2, "")
    assert "nothing measured: no flag, interrupt or byte occurs in the first 0 ms of 100 ms" in came.err


def test_observables_that_do_not_occur_are_unmeasured(periph_sim: Run):
    short = ("trade", RESPONDER, "--seconds", "0.0005", "--level", "byte")
    said = " ".join(periph_sim(*short).out.split())
    assert "unmeasured, since they do not occur in it: wrong bytes, nacked rounds, missed rounds, response, " in said
    assert "no bus carries a byte in it, so errors in bytes are not known; simulate longer with --seconds" in said
    assert "no bus carries a byte" not in periph_sim(*QUICK).out
    told = json.loads(periph_sim(*short, "--json").out)
    assert "stretch" in told["unmeasured"] and "nacked" not in told["unmeasured"]
    shown = {each["name"]: each for each in told["levels"][1]["observables"]}
    assert (shown["stretch"]["count"], shown["stretch"]["mean"], shown["stretch"]["worst"]) == (0, None, None)
    exact = [each for each in shown.values() if each["worst"] == 0]
    assert all(each["count"] for each in exact) and f"byte: all {len(exact)} observables exact" in said


def test_a_refused_level_says_why(periph_sim: Run):
    came = periph_sim("trade", str(TIMING / "imu_hil.toml"), "--seconds", "0.01", "--level", "arithmetic=bytes")
    assert came.status == 0 and "refused" in came.out
    assert "needs an arithmetic to estimate" in " ".join(came.out.split())


def test_a_picture_is_written_whole_or_not_at_all(periph_sim: Run, desk: Path):
    came = periph_sim(*QUICK, "--plot", "trade.svg")
    assert came.status == 0 and came.out.endswith("written: trade.svg\n")
    drawn = (desk / "trade.svg").read_text(encoding="utf-8")
    assert drawn.startswith("<?xml") and all(f">{name}<" in drawn for name in ("edge", "adaptive", "poll_pass=21"))
    assert periph_sim(*QUICK, "--plot", "nowhere/trade.svg").status == 2
    assert not list(desk.glob("**/.trade*"))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((RESPONDER, "--max-error", "1"), "--max-error: '1' has no unit; write for instance"),
        ((RESPONDER, "--max-error", "-1 us"), "--max-error: '-1 us' is negative"),
        ((RESPONDER, "--level", "adaptiv"), "there is no level 'adaptiv' of this case; did you mean adaptive?"),
        ((RESPONDER, "--plot", "trade.png"), "trade.png: the picture is SVG"),
        ((RESPONDER, "--seconds", "long"), "--seconds: "),
        ((RESPONDER, "--set", "duraton=1 s"), "duraton"),
        (("nowhere.toml",), "nowhere.toml"),
    ],
)
def test_mistakes_are_one_sentence_and_status_2(periph_sim: Run, desk: Path, arguments: tuple[str, ...], message: str):
    came = periph_sim("trade", *arguments)
    assert came.status == 2 and came.out == ""
    assert message in came.err and "Traceback" not in came.err
