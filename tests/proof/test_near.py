"""The phases that are run cycle by cycle: those at which the interrupt of a frame comes near a write of the firmware.

round       --w----w--w------w---     writes of registers
near        fff--fffff-----fff---     400 cycles before a write to 60 after it
frame       p.........i               the interrupt i comes 12 characters and its latency after the phase p
"""

from __future__ import annotations

import pytest

from periph_sim.proof import near
from periph_sim.proof.near import AFTER, BEFORE, Observed, chosen_phases
from periph_sim.proof.stretch import CoveredCase, Job
from tests.scene.runs import TIMING

FRAME = 120 * 150_000_000 // 115_200  # cycles of 12 characters of 10 bits


@pytest.fixture(scope="module")
def published() -> CoveredCase:
    return CoveredCase(Job(str(TIMING / "imu_hil_published.toml")))


@pytest.fixture(scope="module")
def observed(published: CoveredCase) -> Observed:
    return Observed(published)


def test_the_delay_is_that_of_a_frame_and_the_writes_are_those_of_a_round(observed: Observed) -> None:
    """A round of 3 x 6 data bytes and 3 pointers takes 2.62 ms; the models that follow it take 250 us."""
    (delay,) = observed.delays
    assert FRAME <= delay < FRAME + 200
    assert len(observed.writes) >= 18
    assert 393_000 <= max(observed.writes) - min(observed.writes) < 3_000_000


def test_near_phases_have_the_interrupt_beside_a_write(observed: Observed, published: CoveredCase) -> None:
    count, (delay,) = published.phases.count, observed.delays
    found = observed.near(count)
    for write in observed.writes:
        ends = [(write + at - delay) % count for at in (-BEFORE - 1, -BEFORE, AFTER, AFTER + 1)]
        assert ends[1] in found and ends[2] in found
        others = observed.writes - {write}
        alone = all(abs(write - other) > BEFORE + AFTER + 2 for other in others)
        assert not alone or (ends[0] not in found and ends[3] not in found)


def test_the_frames_that_are_observed_are_spread_over_the_period(observed: Observed) -> None:
    """The service routine's writes are seen at eight places of the round, about an eighth of a period apart."""
    eighths = {write * near.OBSERVED // 3_000_000 for write in observed.writes}
    assert len(eighths) >= near.OBSERVED - 1


def test_only_phases_within_the_bounds_are_chosen_with_both_bounds(published: CoveredCase, observed: Observed) -> None:
    inside = sorted(observed.near(published.phases.count))
    first, last = inside[0], inside[900]
    chosen, count = chosen_phases(published, 97, (first, last))
    assert (chosen[0], chosen[-1], chosen) == (first, last, sorted(set(chosen)))
    assert count == sum(first <= phase <= last for phase in inside) and set(inside[:901]) <= set(chosen)
    steps = [phase for phase in chosen if phase not in set(inside)]
    assert all((phase - first) % 97 == 0 or phase == last for phase in steps)


def test_too_many_near_phases_are_left_to_the_step(
    published: CoveredCase, observed: Observed, monkeypatch: pytest.MonkeyPatch
) -> None:
    bounds = (0, published.phases.count - 1)
    many = len(observed.near(published.phases.count))
    monkeypatch.setattr(near, "MAX_NEAR", many)
    assert chosen_phases(published, 9973, bounds)[1] == many
    monkeypatch.setattr(near, "MAX_NEAR", many - 1)
    chosen, count = chosen_phases(published, 9973, bounds)
    assert count == 0 and len(chosen) == -(-published.phases.count // 9973) + 1


def test_inputs_that_are_drawn_are_named() -> None:
    case = CoveredCase(Job(str(TIMING / "imu_hil.toml"), ("controller.jitter=1 us", "host.frames=9")))
    assert case.left_out["host.jitter"] == "each start comes at its phase"
    assert case.left_out["controller.jitter"] == "it is drawn"
    assert case.left_out["host.frames"] == "frames are sent in each period"
