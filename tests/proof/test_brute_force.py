"""The coverage against brute force: each phase of a short range in an ordinary run of its own.

phases   0 1 2 3 4 5 6 7 8 9
fails        x x x               brute force: ten runs
         |---|---|               coverage: one run of all phases, and those that find both ends
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from tests.proof.scenes import (
    CYCLE,
    MS,
    assert_same,
    covered,
    each_alone,
    ends_of,
    in_row,
    in_seconds,
    listener,
    node,
    settings_of,
)
from tests.scene.runs import TIMING

PASS = 0.2  # microseconds of a pass of a wait
CHARACTER = 640  # cycles
FRAME = in_row("frames", Fraction(0), MS / 10)  # the frames of the listener
EXAMPLES = settings(
    max_examples=4,
    derandomize=True,
    phases=[Phase.generate],  # an example takes half a second, so examples are not shrunk
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)


def test_the_published_firmware_has_the_windows_of_brute_force() -> None:
    """The service routine takes 200 us. The phases have ends of windows of a hang, missed rounds and late responses."""
    case, changes = TIMING / "imu_hil_published.toml", ['unit.dsp.settings.frame_cost="200 us"']
    alone = each_alone(case, changes, in_row("frames", 5 * MS, 20 * MS), range(3435, 3555))
    coverage = covered(case, changes, range(3435, 3555))
    assert_same(coverage, alone)
    assert {one.name for one in coverage.windows} == {"response", "stretch", "stuck", "missed rounds"}


def test_the_responder_holds_as_in_brute_force() -> None:
    case, changes = TIMING / "responder.toml", ["controller.jitter=1 ms"]  # jitter does not apply to chosen rounds
    phases = range(749_970, 750_000)
    coverage = covered(case, changes, phases)
    assert_same(coverage, each_alone(case, changes, in_row("rounds", 1 * MS, 5 * MS), phases))
    assert (coverage.windows, len(coverage.found.held)) == ([], 30)


def test_collisions_of_an_rs485_node_are_those_of_brute_force(tmp_path: Path) -> None:
    case, phases = node(tmp_path), range(60, 125)

    def later(phase: int) -> list[str]:
        return [f"inputs.sends_later={in_seconds(phase * CYCLE)}", f"duration={in_seconds(3 * MS + phase * CYCLE)}"]

    coverage = covered(case, (), phases)
    assert_same(coverage, each_alone(case, [], later, phases))
    assert [one.name for one in coverage.windows] == ["collisions"]


def test_an_image_has_the_values_of_brute_force() -> None:
    """The head and the unit have the clocks of crystals at both ends of their tolerance."""
    case, period = TIMING / "imu_hil_image.toml", 20 * MS / (1 - 30 * Fraction(1, 10**6))
    first = 8 * MS / (1 - 30 * Fraction(1, 10**6))
    phases = range(12)
    alone = each_alone(case, [], in_row("frames", first, period), phases)
    assert_same(covered(case, (), phases), alone, near=PASS)


def test_a_run_that_begins_later_has_the_same_phases(tmp_path: Path) -> None:
    case, changes = listener(tmp_path), ["start=3 s", *settings_of(low=8000, high=8030)]
    phases = range(610, 680)
    coverage = covered(case, changes, phases)
    assert_same(coverage, each_alone(case, changes, FRAME, phases))
    assert len(coverage.windows) == 1


def test_the_first_frame_of_the_case_moves_the_time_from_which_phases_count(tmp_path: Path) -> None:
    case, changes = listener(tmp_path), ["host.first=10 us", *settings_of(low=8000, high=8050)]
    phases = range(390, 460)
    coverage = covered(case, changes, phases)
    assert_same(coverage, each_alone(case, changes, in_row("frames", Fraction(10, 10**6), MS / 10), phases))
    assert len(coverage.windows) == 1


def test_a_unit_of_90_mhz_has_cycles_of_its_own(tmp_path: Path) -> None:
    case, changes = listener(tmp_path), ["unit.dsp.pll=6", *settings_of(low=8000, high=8030)]
    cycle = Fraction(1, 90_000_000)
    phases = range(40)
    coverage = covered(case, changes, phases, cycle=cycle)
    assert coverage.case.phases.count == 9000
    assert_same(coverage, each_alone(case, changes, in_row("frames", Fraction(0), MS / 10, cycle), phases))


def test_a_period_that_is_no_whole_number_of_cycles_is_exact(tmp_path: Path) -> None:
    """The clocks of host and unit are 60 ppm fast, so a period has 14,999.1 of the cycles in which phases count."""
    case, changes = listener(tmp_path), ["host.ppm=60", "unit.dsp.ppm=60", *settings_of(low=8000, high=8050)]
    phases = range(610, 680)
    coverage = covered(case, changes, phases)
    period = MS / 10 / (1 + 60 * Fraction(1, 10**6))
    assert coverage.case.phases.count == 14_999
    assert_same(coverage, each_alone(case, changes, in_row("frames", Fraction(0), period), phases), PASS)


@EXAMPLES
@given(begin=st.integers(5000, 12_000), busy=st.integers(160, 400), place=st.integers(0, 60))
def test_windows_of_a_loop_that_is_busy_anywhere_are_those_of_brute_force(
    tmp_path: Path, begin: int, busy: int, place: int
) -> None:
    """A character that ends in the busy span waits until the span is over."""
    case, changes = listener(tmp_path), settings_of(begin=begin, busy=busy)
    first = begin - 4 * CHARACTER + 40 - place  # the fourth character ends near the begin of the span
    phases = range(first, first + 60)
    assert_same(covered(case, changes, phases), each_alone(case, changes, FRAME, phases), PASS)


@EXAMPLES
@given(
    low=st.integers(7000, 9000),
    width=st.integers(50, 70),
    turns=st.integers(0, 2),
    then=st.sampled_from(["pin", "hang", "error"]),
)
def test_failures_that_come_late_or_stay_have_the_windows_of_brute_force(
    tmp_path: Path, low: int, width: int, turns: int, then: str
) -> None:
    """A pin rises in the same period or up to two periods later, the firmware waits for ever, or it raises an error."""
    case, changes = listener(tmp_path), settings_of(low=low, high=low + width, turns=turns, then=then)
    first = (low - 7390) % CHARACTER + CHARACTER  # some character is then read shortly before `low`
    phases = range(first, first + 90)
    coverage = covered(case, changes, phases)
    assert_same(coverage, each_alone(case, changes, FRAME, phases), PASS)
    assert ends_of(coverage)
