"""The sentence about a failure and its cause, from verdicts and chains built by hand."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from periph_sim.core.time import Timebase
from periph_sim.interfaces.reports.explain.chain import Chain, FirmwarePlace, Part, Step
from periph_sim.interfaces.reports.html.failure import Failure, SourceLines, failure, source_around
from periph_sim.timing.verdict import Verdict, broken
from tests.interfaces.reports.html.made import US, budget, run_of

LATE = budget("response", 12.0).verdict  # the limit is 10 us
PLACE = FirmwarePlace("batch_read", 98, Path("/home/somebody/imu_hil.py"))
RATE = 1_000_000 * US


def chain(*parts: Part, more: tuple[Part, ...] = (), blame: Part | None = None, length: int = 12 * US) -> Chain:
    return Chain(LATE, Timebase(RATE), length, (), parts, more=more, blame=blame)


def failure_of(verdict: Verdict, of: Chain | None = None, *numbers: int) -> Failure:
    return failure(verdict, False, of, run_of(list(numbers), max=10) if numbers else None, RATE)


def test_measure_limit_and_instant_are_worded_as_in_the_terminal() -> None:
    assert failure_of(LATE).what == "12.000 us is over its limit of 10.000 us, at 0.012345 s" == broken(LATE)
    words = replace(LATE, which="min", unit="words", worst=12, limit=13, margin=-1, at_s=None)
    assert failure_of(words).what == "12 words is under its limit of 13 words"


@pytest.mark.parametrize(
    ("numbers", "count"),
    [
        ([12, 11], "All 2 occurrences are beyond the limit"),
        ([12], ""),
        ([5, 12, 5], "It is the only one of 3 occurrences that is beyond the limit"),
        ([5, 11, 12], "2 of 3 occurrences are beyond the limit, the first at 0.002000 s"),
        ([5, 6], ""),  # a percentile, which no single value breaks
    ],
)
def test_the_number_of_violations_is_stated(numbers: list[int], count: str) -> None:
    assert failure_of(LATE, None, *numbers).count == count


WHERE = "imu_hil.py:98 (batch_read)"
HELD = Part("bus", "SCL low by the controller", 12 * US)
EXTRA = Part("span", "frame", 3 * US, 1, PLACE)
OVERRUN = "memory: the write at 0x001f went beyond its page's end"


@pytest.mark.parametrize(
    ("of", "why", "place"),
    [
        (
            chain(replace(HELD, length=5 * US), Part("interrupt", "SCIRXINTA", 7 * US, 1, PLACE)),
            "Most of that time, 7.000 us, went into SCIRXINTA at",
            WHERE,
        ),
        (
            chain(replace(HELD, length=7 * US), Part("wait", "AAS", 5 * US, 1, PLACE)),
            "The largest part of that time, 5.000 us, went into wait for AAS at",
            WHERE,
        ),
        (
            chain(HELD, more=(EXTRA,)),
            "3.000 us longer than in its least critical occurrence: span frame at",
            WHERE,
        ),
        (chain(blame=Part("code", "I2CDXR written", 0, 1, PLACE), length=0), "Cause: I2CDXR written at", WHERE),
        (chain(blame=Part("code", OVERRUN, 0), length=0), f"Cause: {OVERRUN}", ""),
        (chain(HELD), "Most of that time, 12.000 us, went into SCL low by the controller", ""),
        (chain(), "", ""),
    ],
)
def test_the_cause_is_the_blamed_part_of_the_chain_or_the_longest_one(of: Chain, why: str, place: str) -> None:
    found = failure_of(LATE, of)
    assert (found.why, found.place) == (why, place)


def test_a_budget_that_holds_has_no_sentence_and_a_known_break_has_one() -> None:
    assert failure(budget("a", 2.0).verdict, False, None, None, RATE) is None
    assert failure(LATE, True, None, None, RATE) == Failure("12.000 us is over its limit of 10.000 us, at 0.012345 s")


def test_a_fixed_bug_and_a_budget_that_was_not_judged_have_a_sentence() -> None:
    gone = failure(budget("a", 2.0).verdict, True, None, None, RATE)
    assert gone == Failure("2.000 us holds, but the budget is listed in breaks")
    unjudged = replace(budget("a", 2.0).verdict, verdict="not judged")
    assert failure_of(unjudged).what == "not judged: nothing was measured by 'response'"
    assert failure_of(replace(unjudged, found="no event matched 'x'")).what == "not judged: no event matched 'x'"


def test_the_line_of_the_cause_is_shown_with_its_neighbours(tmp_path: Path) -> None:
    file = tmp_path / "slave.py"
    file.write_text("import x\n\ndef main():\n    if a:\n        b()\n    c()\n", encoding="utf-8")
    part = Part("span", "frame", 12 * US, 1, FirmwarePlace("main", 4, file))
    found = failure_of(LATE, chain(part))
    lines = ((2, ""), (3, "def main():"), (4, "    if a:"), (5, "        b()"), (6, "    c()"))
    assert found.source == SourceLines("slave.py:4 (main)", 4, lines)
    near_end = source_around(FirmwarePlace("main", 6, file))
    assert near_end is not None and near_end.lines == ((4, "if a:"), (5, "    b()"), (6, "c()"))
    steps = (Step(0, "a", place=FirmwarePlace("main", 4, file)), Step(1, "b"))  # the cause is on the bus
    of_step = failure_of(LATE, replace(chain(Part("bus", "bits", 12 * US)), steps=steps))
    assert (of_step.place, of_step.source) == ("", found.source)


@pytest.mark.parametrize("line", [0, 2])
def test_a_line_that_is_not_in_the_file_is_not_shown(tmp_path: Path, line: int) -> None:
    file = tmp_path / "slave.py"
    assert source_around(FirmwarePlace("main", 1, file)) is None  # there is no such file
    file.write_text("one\n", encoding="utf-8")
    assert source_around(FirmwarePlace("main", line, file)) is None
    assert source_around(FirmwarePlace("main", 1, None)) is None
