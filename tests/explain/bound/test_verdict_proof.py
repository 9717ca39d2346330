"""What a verdict proves: every phase where all its limits have bounds, else what was seen, with the reason."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import pytest
from msgspec.structs import replace

from periph_sim.explain.bound import verdict_proof
from periph_sim.explain.bound.verdict_proof import prove_verdicts
from periph_sim.processor.dsp import Dsp
from periph_sim.scene.case.model import Case
from periph_sim.scene.firmware_loader import Firmware
from periph_sim.scene.scene import Scene
from periph_sim.timing.budget_schema import Budget
from periph_sim.timing.verdict import Verdict
from tests.explain.bound.cases import imu_hil
from tests.scene.small import case


def judged(of: Case, programs: dict[str, Firmware] | None = None, seconds: str = "1/20") -> dict[str, Verdict]:
    """The verdicts of a run of so many seconds, by budget."""
    scene = Scene(of, programs=programs)
    result = scene.run(Fraction(seconds))
    prove_verdicts(scene, result.budgets)
    return {verdict.name: verdict for verdict in result.budgets}


def limited(measure: str, *changes: str, **limits: Any) -> Verdict:
    """The verdict of one budget of the IMU emulator."""
    budget = Budget.model_validate({"name": "it", "measure": measure, **limits})
    return judged(imu_hil(*changes).model_copy(update={"budget": (budget,), "breaks": ()}))["it"]


@pytest.mark.parametrize("level", ["adaptive", "byte"])
def test_the_bound_of_a_run_at_another_level_is_that_of_edges(level: str):
    edges, other = (limited("age", f"fidelity={each}", max="41 ms") for each in ("edge", level))
    assert edges.bound is not None and (other.bound, other.word) == (edges.bound, edges.word)


def test_a_budget_holds_for_every_phase_in_what_was_seen_or_is_broken():
    kept, luck, broken = (limited("age", f"host.first={first} ms", max=f"{ms} ms") for first, ms in COMBINED)
    assert (kept.word, kept.unbounded) == ("every phase", "")
    assert (luck.word, luck.verdict) == ("seen", "pass")
    assert luck.unbounded.startswith("its bound is beyond the limit by 14.3")
    assert (broken.word, broken.proof, broken.unbounded) == ("broken", "", "")
    assert kept.bound == luck.bound == broken.bound and kept.bound is not None and 39_000 < kept.bound < 40_000


COMBINED = [(2, 40), (2, 25), (7, 25)]  # host.first in ms, the limit


def test_the_bound_is_from_the_side_of_the_limit():
    slack = limited("slack", min="17 ms")
    assert slack.word == "every phase" and slack.bound is not None and slack.worst is not None
    assert slack.bound < slack.worst
    other = limited("slack", max="18 ms")
    assert (other.word, other.bound, other.unbounded) == ("seen", None, "it is bounded from below only")
    both = limited("round", min="1 ms", max="3 ms")
    assert (both.word, both.unbounded) == ("seen", "it is bounded from above only")


def test_a_percentile_shows_the_bound_of_the_maximum_only_where_that_keeps_the_limit():
    """Beyond the limit it says nothing of the percentile, and beside it would read as a failure."""
    kept, beyond, broken = (limited("age", p99=f"{ms} ms") for ms in (40, 25, 20))
    assert kept.word == "every phase" and kept.bound is not None and 39_000 < kept.bound < 40_000
    assert (beyond.word, beyond.bound, broken.word, broken.bound) == ("seen", None, "broken", None)
    assert beyond.unbounded.startswith("only the maximum is bounded, by 39.3")


def test_joined_conditions_must_all_be_bounded():
    joined = {"and": [{"measure": "stretch", "min": "0 us"}]}
    alone, with_other = limited("age", max="40 ms"), limited("age", max="40 ms", **joined)
    assert (alone.word, with_other.word) == ("every phase", "seen")
    assert with_other.unbounded == "it is bounded from above only"


def test_what_nobody_measured_is_not_judged_however_good_its_bound():
    silent = limited("age", "host.frames=0", max="40 ms")
    assert (silent.word, silent.proof) == ("not judged", "")


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        (
            ("unit.dsp.settings.model_cost=17379 us", "controller.first=20 ms"),
            "too late for what a bound needs in time (gyroscope asked)",
        ),
        (("host.twice=[1]",), "some frames are sent twice (host.twice), which no bound counts"),
        (('device.memory={model="24lc64", stretch="1 ms"}',), "the case has [device.NAME], which no bound counts"),
        (
            ('chip.c={model="itg3200", address=0x69, values={fixed=[0, 0, 0]}, stretch="1 ms"}',),
            "the case has stretch or fault in [chip.NAME], which no bound counts",
        ),
    ],
)
def test_where_there_is_no_closed_form_the_reason_says_why(changes: tuple[str, ...], reason: str):
    verdict = limited("response", *changes, max="100 us")
    assert verdict.word == "seen" and reason in verdict.unbounded and verdict.bound is None


def test_a_case_without_a_controller_holds_in_what_was_seen():
    plain = case(unit={"dsp": {"firmware": "given", "modules": []}}, budget=[cpu_load])
    assert judged(plain, given(lambda dsp: dsp.compute(5)))["load"].unbounded == (
        "bounds count from a controller's requests, and there is no [controller]; what a run shows is all there is"
    )


cpu_load = {"name": "load", "measure": "cpu load", "max": "100 %"}


def given(main: Callable[[Dsp], None]) -> dict[str, Firmware]:
    return {"dsp": Firmware("given", lambda dsp, settings: main(dsp), None)}


def test_firmware_that_fails_where_its_terms_are_measured_is_told():
    controller = {"request": [{"address": 0x50, "count": 1}]}
    plain = case("3 ms", unit={"dsp": {"firmware": "given", "modules": ["I2C-A"]}}, controller=controller)
    bounds, reason = verdict_proof.bounds_of(plain, given(lambda dsp: dsp.no_such_thing))  # type: ignore[attr-defined]
    assert bounds == () and reason.startswith(
        "a run that measures the bounds' terms ends with an error: dsp: AttributeError"
    )


def test_a_run_beyond_a_bound_is_never_a_proof(monkeypatch: pytest.MonkeyPatch):
    """The bound of the response is made one tick less than what every read takes."""
    real = verdict_proof.bounds_of

    def too_low(*args: Any) -> Any:
        bounds, reason = real(*args)
        low = [
            replace(b, floor=replace(b.floor, ticks=b.floor.ticks - 1)) if b.floor is not None else b for b in bounds
        ]
        return tuple(low), reason

    assert limited("response", max="5 us").word == "every phase"
    monkeypatch.setattr(verdict_proof, "bounds_of", too_low)
    verdict = limited("response", max="5 us")
    assert verdict.word == "seen" and "the run went beyond the bound of response" in verdict.unbounded


def test_bounds_are_kept_for_the_next_run_of_the_same_case_only(monkeypatch: pytest.MonkeyPatch):
    made: list[Case] = []
    real = verdict_proof.closed_form
    monkeypatch.setattr(verdict_proof, "closed_form", lambda case, firmware: made.append(case) or real(case, firmware))
    monkeypatch.setattr(verdict_proof, "_known", {})
    one = limited("response", max="5 us")
    assert limited("stretch", "seed=7", max="1 us").word == one.word == "every phase"
    assert len(made) == 1  # budgets and seed are not what bounds depend on
    assert limited("response", "unit.dsp.settings.model_cost=251 us", max="5 us").word == "every phase"
    assert len(made) == 2
