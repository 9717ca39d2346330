"""Instants at which failures become certain: the differences between the runs on both sides of a window's end."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from periph_sim import Scene, load
from periph_sim.core.records import Kind, Record
from periph_sim.interfaces.reports.certain_failure import (
    MOST_ENDS,
    NEAREST,
    CertainFailure,
    alike_after,
    certain_failures,
    steps_of,
)
from tests.proof.scenes import LISTENER, covered, in_row, listener, settings_of

LOW, HIGH = 8000, 8060
LINES = LISTENER.splitlines()
PHASES = range(600, 760)
PIN = f"main:{LINES.index('            dsp.set_pin(BAD)') + 1}"


def access(number: int, what: str, value: int, where: str = "dsp") -> Record:
    return Record(number, 10 * number, Kind.ACCESS, where, what, value, "", 0)


def both_ends(case: Path, changes: Sequence[str], name: str, phases: range = PHASES) -> list[CertainFailure]:
    found = [one for one in certain_failures(covered(case, changes, phases)) if one.name == name]
    assert [one.phase for one in found] == sorted(one.phase for one in found)
    return found


def test_the_first_access_that_only_failing_runs_have_is_named_at_both_ends(tmp_path: Path) -> None:
    """A character in the window leads to a pulse of the pin, which is the first difference between the accesses."""
    case = listener(tmp_path)
    first, last = both_ends(case, settings_of(low=LOW, high=HIGH), "bad")
    for one, beside in ((first, first.phase - 1), (last, last.phase + 1)):
        assert one.event is not None and one.instead is not None
        assert one.event.text.startswith("dsp: GPIO.GPBSET written, 0x0008")
        assert one.event.text.endswith(PIN) and PIN not in one.instead.text
        assert one.held == beside
        (begin, end) = one.shares
        assert begin.failing == NEAREST < begin.runs and (end.failing, end.runs) == (NEAREST, NEAREST)
        assert one.event.at_s == one.shares[-1].at_s


def test_the_instant_is_that_of_the_access_in_a_run_with_the_phase(tmp_path: Path) -> None:
    """A run of the case without the coverage has the access at the same time."""
    case = listener(tmp_path)
    changes = settings_of(low=LOW, high=HIGH)
    first, _ = both_ends(case, changes, "bad")
    records: list[Record] = []
    inputs = in_row("frames", load(case).host.first, load(case).host.period)(first.phase)  # type: ignore[union-attr]
    scene = Scene(
        load(case, [*changes, *inputs]), lambda recorder, _: recorder.subscribe([Kind.ACCESS], records.append)
    )
    scene.run()
    tick = next(record.tick for record in records if record.text == PIN)
    assert first.event is not None and first.event.at_s == pytest.approx(
        float(scene.timebase.seconds(tick - scene.start))
    )


def test_firmware_that_does_the_same_later_has_no_deciding_access(tmp_path: Path) -> None:
    """The character waits for the end of a computation, so the runs differ in times only from those that hold."""
    found = both_ends(listener(tmp_path), settings_of(begin=9000, busy=400), "late", range(1000, 1500))
    assert found and all(one.event is None and one.instead is None for one in found)
    assert all(one.shares == (one.shares[0],) for one in found)


def test_a_hang_is_certain_when_the_endless_wait_begins(tmp_path: Path) -> None:
    """The budget breaks when the FIFO is full, long after the wait began."""
    first, last = both_ends(listener(tmp_path), settings_of(low=LOW, high=HIGH, then="hang"), "high-water")
    for one in (first, last):
        assert one.event is not None and "SCI-A.SCIPRI read" in one.event.text
        assert one.instead is not None and "SCI-A.SCIPRI" not in one.instead.text


SLOWER = """\
from periph_sim.firmware import start_pin, start_sci

def main(dsp, settings):
    start_pin(dsp, 34)
    start_pin(dsp, 35)
    sci = start_sci(dsp, "SCI-A", brr=1)
    while True:
        dsp.spin(lambda: sci.SCIFFRX.RXFFST > 0)
        length = dsp.cpu.time.cycle % 15_000 // 20
        sci.SCIRXBUF.all
        dsp.compute(length)
        dsp.set_pin(34)
        if length >= 573:
            dsp.set_pin(35)
        dsp.clear_pin(34)
"""


def test_a_difference_after_the_failure_is_not_its_cause(tmp_path: Path) -> None:
    """The pin rises later if the character is later: up to the failure, only times differ, and after it, accesses."""
    case = listener(tmp_path)
    (tmp_path / "listener.py").write_text(SLOWER, encoding="utf-8")
    slow = "{name='slow', measure='from access R SCI-A.SCIRXBUF to edge SEEN rise', max='3.876 us'}"
    other = "{name='other', measure='count of edge BAD rise', max=0}"
    found = certain_failures(covered(case, [f"budget=[{slow},{other}]"], range(500, 1000)))
    assert [one.name for one in found] == ["other", "slow"] and found[0].phase == found[1].phase
    assert found[0].event is not None and "GPBSET" in found[0].event.text
    assert found[1].event is None and found[1].instead is None


def test_an_error_ends_the_run_without_a_further_access(tmp_path: Path) -> None:
    first, _ = both_ends(listener(tmp_path), settings_of(low=LOW, high=HIGH, then="error"), "ended by an error")
    assert first.event is None and first.instead is not None
    assert [share.failing < share.runs for share in first.shares] == [True]


def test_an_end_whose_neighbour_was_not_run_is_left_out(tmp_path: Path) -> None:
    case, changes = listener(tmp_path), settings_of(low=LOW, high=HIGH)
    first, last = both_ends(case, changes, "bad")
    (only,) = both_ends(case, changes, "bad", range(first.phase + 5, PHASES[-1]))
    assert only.phase == last.phase


def test_a_coverage_without_windows_has_no_certain_failure(tmp_path: Path) -> None:
    assert certain_failures(covered(listener(tmp_path), (), range(4))) == []


def test_the_number_of_examined_ends_is_limited(tmp_path: Path) -> None:
    found = covered(listener(tmp_path), settings_of(low=LOW, high=HIGH), PHASES)
    found.windows *= MOST_ENDS
    assert len(certain_failures(found)) == MOST_ENDS


def test_consecutive_reads_of_an_equal_value_are_one_step() -> None:
    records = [access(n, "R I2C-A.I2CSTR", value) for n, value in enumerate((1, 1, 2, 2, 2, 1))]
    records.append(access(9, "W I2C-A.I2CSTR", 1))
    records.append(access(10, "W I2C-A.I2CSTR", 1))
    steps = steps_of(records)["dsp"]
    assert [step.record.number for step in steps] == [0, 2, 5, 9, 10]
    words = [access(n, "R SCI-A.SCIRXBUF", 7) for n in range(3)]  # each read removes another word from the FIFO
    assert len(steps_of(words)["dsp"]) == 3


@pytest.mark.parametrize("name", ["SCI-A.SCIRXBUF", "I2C-A.I2CDRR", "I2C-A.I2CDXR", "TIMER0.TIM"])
def test_values_of_data_and_timer_registers_are_not_compared(name: str) -> None:
    one, two = (steps_of([access(1, f"R {name}", value)]) for value in (1, 2))
    assert one["dsp"][0].content == two["dsp"][0].content
    one, two = (steps_of([access(1, "R I2C-A.I2CSTR", value)]) for value in (1, 2))
    assert one["dsp"][0].content != two["dsp"][0].content


@given(st.lists(st.lists(st.tuples(st.sampled_from("ab"), st.integers(0, 1)), max_size=6), min_size=1, max_size=6))
def test_runs_are_alike_while_each_unit_makes_the_same_accesses(words: list[list[tuple[str, int]]]) -> None:
    runs = {
        phase: steps_of([access(n, "W I2C-A.I2CSTR", value, unit) for n, (unit, value) in enumerate(word)])
        for phase, word in enumerate(words)
    }

    def begins_alike(other: list[tuple[str, int]], length: int) -> bool:
        own = words[0][:length]
        return all(
            [v for u, v in other if u == unit][: len(mine)] == mine
            for unit in "ab"
            for mine in [[v for u, v in own if u == unit]]
        )

    found = [alike for _, _, alike in alike_after(runs, 0)]
    assert found == [
        {phase for phase, word in enumerate(words) if begins_alike(word, length)}
        for length in range(1, len(words[0]) + 1)
    ]
