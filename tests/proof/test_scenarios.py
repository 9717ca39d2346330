"""Values from a closed table are those of ordinary runs with the same starts, round by round.

starts, drawn from seeds or not --table--> values [scenario, round]
                                --Scene--> kept values of the budget, by round
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from periph_sim import sweep
from periph_sim.proof.scenarios import Scenarios, worst_in_rounds
from periph_sim.proof.stretch import CoveredCase, Job
from periph_sim.scene.case.inputs_table import InputsTable
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase, Case
from periph_sim.scene.scene import Scene
from periph_sim.timing.budgets import Values
from tests.proof.proven_slave import write_slave
from tests.proof.test_closed_table import write_echo
from tests.scene.runs import TIMING

ROUNDS = 12
SEEDS = (0, 1, 2, 77)
DELAYED = ["host.first=10 ms", "host.jitter=3 ms"]
ANSWER = """
[[budget]]
name = "answer"
measure = "from bus START to access W I2C-A.I2CDXR, same transfer"
max = "1 ms"
coverage = "10 %"

[[budget]]
name = "set-up"
measure = "from access W I2C-A.I2CIER to access W PIE.PIEACK, next"
max = "1 s"
"""
NEVER = '\n[[budget]]\nname = "never"\nmeasure = "from access W I2C-A.I2CSAR to bus STOP"\nmax = "1 s"\n'


@pytest.fixture(scope="module")
def echo(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Scenarios]:
    """Return the case of the fast echo, and its scenarios."""
    case = write_echo(tmp_path_factory.mktemp("echo"))
    return case, Scenarios(case)


@pytest.fixture(scope="module")
def delayed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Scenarios]:
    """Return the case of the fast echo, and its scenarios with the jitter of DELAYED."""
    case = write_echo(tmp_path_factory.mktemp("delayed"))
    return case, Scenarios(case, DELAYED)


def drawn(scenarios: Scenarios, count: int, seed: int) -> NDArray[np.int64]:
    """Return starts that are the least distance or up to a millisecond more apart."""
    random = np.random.default_rng(seed)
    distances = scenarios.apart + random.integers(0, scenarios.ticks_per_second // 1000, (count, ROUNDS))
    distances[random.random((count, ROUNDS)) < 0.2] = scenarios.apart
    distances[:, 0] = scenarios.first
    return np.cumsum(distances, axis=1)


def in_run(case: Case, starts: NDArray[np.int64], budget: str) -> NDArray[np.float64]:
    """Run a case and return the largest value of a budget in each round; NaN for none.

    starts: the starts of the rounds, and one that comes after the end of the run.
    """
    found = np.full(starts.shape, np.nan)
    scene = Scene(case, keep_values=True)
    end = Fraction(int(starts[-1]) - 1, scene.timebase.per_second)
    scene.run(end)
    (limit,) = (one for one in scene.limits if one.budget.name == budget)
    values = limit.values(scene.start)
    assert values is not None
    for value, at in zip(values.values, values.at, strict=True):
        place = int(np.searchsorted(starts, at, "right")) - 1
        found[place] = np.fmax(found[place], float(limit.show(int(value))))
    return found[:-1]


def in_runs(case: Path, scenarios: Scenarios, starts: NDArray[np.int64], budget: str) -> NDArray[np.float64]:
    """Run each scenario, and return the largest value of a budget in each round; NaN for none."""
    found = np.full(starts.shape, np.nan)
    for number, row in enumerate(starts):
        times = tuple(Fraction(int(start), scenarios.ticks_per_second) for start in row)
        inputs = InputsTable(frames=times) if scenarios.moved == "frames" else InputsTable(rounds=times)
        loaded = load(case).model_copy(update={"inputs": inputs})
        found[number] = in_run(loaded, np.append(row, row[-1] + scenarios.apart), budget)
    return found


def test_values_are_those_of_ordinary_runs(echo: tuple[Path, Scenarios]):
    case, scenarios = echo
    starts = drawn(scenarios, 25, 1)
    values = scenarios.values(starts)["echo"]
    assert np.array_equal(values, in_runs(case, scenarios, starts, "echo"))
    assert len(np.unique(values)) > 20


def test_rounds_of_a_controller_and_budgets_that_are_left_out(tmp_path: Path):
    case = write_slave(tmp_path)
    scenarios = Scenarios(case)
    assert (scenarios.budgets, scenarios.moved) == (("reaction",), "rounds")
    assert scenarios.left_out == {
        "wrong bytes": "it has one number for the whole run",
        "round": "a percentile describes all occurrences of a run",
        "slack": "its values depend on the start of the next round",
        "load": "it is a share of a whole run",
    }
    starts = drawn(scenarios, 10, 2)
    assert np.array_equal(scenarios.values(starts)["reaction"], in_runs(case, scenarios, starts, "reaction"))


@pytest.mark.parametrize(("limits", "worst"), [({"max": 10}, 12), ({"min": 3}, -5), ({"min": 3, "max": 10}, -5)])
def test_the_worst_value_of_a_round_is_the_one_nearest_to_a_limit(limits: dict[str, int], worst: int):
    values, at = np.array([7, 12, -5, 4, 9, 5]), np.array([1, 12, 14, 15, 22, 23])
    found = worst_in_rounds(Values("count", values, at, limits), np.array([10, 20, 30]))
    assert found == [(0, worst), (1, 9 if "max" in limits else 5)]


def check_seeds(case: Path, scenarios: Scenarios, changes: Sequence[str], budget: str) -> None:
    """Check that the values for some seeds are those of runs with these seeds, and differ."""
    starts = scenarios.starts(SEEDS, ROUNDS + 1)
    values = scenarios.values(starts[:, :-1])[budget]
    cases = [load(case, [*changes, f"seed={seed}"]) for seed in SEEDS]
    runs = [in_run(one, row, budget) for one, row in zip(cases, starts, strict=True)]
    assert np.array_equal(values, runs)
    assert len(np.unique(values)) > 10


@pytest.mark.parametrize("paced_by", ["schedule", "pause"])
def test_frames_drawn_from_seeds_are_those_of_runs(paced_by: str, delayed: tuple[Path, Scenarios]):
    case, scenarios = delayed
    changes = [*DELAYED, f"host.paced_by={paced_by}"]
    if paced_by == "pause":
        scenarios = Scenarios(case, changes)
    check_seeds(case, scenarios, changes, "echo")


def test_rounds_drawn_from_seeds_are_those_of_runs(tmp_path: Path):
    changes = ["controller.jitter=3 ms", "controller.first=10 ms"]
    case = write_slave(tmp_path, ANSWER)
    scenarios = Scenarios(case, changes)
    assert scenarios.left_out["set-up"] == "it has values before the first start"
    check_seeds(case, scenarios, changes, "answer")


def test_the_worst_values_of_seeds_are_those_of_a_sweep(delayed: tuple[Path, Scenarios]):
    case, scenarios = delayed
    changes = [[*DELAYED, f"seed={seed}"] for seed in SEEDS]
    came = sweep(case, changes, seconds="110 ms", jobs=1)
    values = scenarios.values(scenarios.starts(SEEDS, 5))["echo"]
    assert came.worst["echo"].tolist() == values.max(axis=1).tolist()
    assert set(came.verdict.tolist()) == {"pass"}


def test_without_jitter_all_seeds_have_the_starts_of_the_case(echo: tuple[Path, Scenarios]):
    case, scenarios = echo
    starts = scenarios.starts([3, 4], ROUNDS)
    assert np.array_equal(starts[0], starts[1])
    values = scenarios.values(starts[:, :-1])["echo"]
    assert np.array_equal(values[0], in_run(load(case), starts[0], "echo"))


def test_starts_of_seeds_that_the_case_does_not_have_are_refused(echo: tuple[Path, Scenarios]):
    case, scenarios = echo
    with pytest.raises(ValueError, match=r"^rounds: 0; expected 1 or more$"):
        scenarios.starts([1], 0)
    with pytest.raises(ValueError, match=r"^starts: int64 of shape \(0, 3\)"):
        scenarios.starts([], 3)
    limited = Scenarios(case, ["host.frames=3"])
    assert limited.starts([1], 3).tolist() == scenarios.starts([1], 3).tolist()
    with pytest.raises(ValueError, match=r"^rounds: 4; expected 1 to 3, since the case has no more frames$"):
        limited.starts([1], 4)


def test_the_number_of_frames_does_not_change_the_delays_of_seeds(delayed: tuple[Path, Scenarios]):
    """`Scenarios.starts` adds these delays to the instants at which the starts are due."""
    every, limited = (CoveredCase(Job(str(delayed[0]), (*DELAYED, *frames))) for frames in ((), ("host.frames=3",)))
    assert len({*every.phases.delays(1, 3)}) == 3
    assert limited.phases.delays(1, 3) == every.phases.delays(1, 3)


def test_values_do_not_depend_on_the_number_of_scenarios(echo: tuple[Path, Scenarios]):
    _, scenarios = echo
    starts = drawn(scenarios, 5000, 3)
    values = scenarios.values(starts)["echo"]
    assert np.array_equal(scenarios.values(starts[17:18])["echo"], values[17:18])
    assert np.array_equal(scenarios.values(starts[:, :3])["echo"], values[:, :3])


def test_a_budget_without_values_is_left_out(tmp_path: Path):
    """The slave never writes I2CSAR."""
    scenarios = Scenarios(write_slave(tmp_path, NEVER))
    assert scenarios.budgets == ()
    assert scenarios.left_out["never"].startswith("a round has too few measured values")


@pytest.mark.parametrize(
    ("starts", "reason"),
    [
        (np.array([1]), r"int64 of shape \(1,\); expected int64 of shape \(n, rounds\)"),
        (np.zeros((0, 3), np.int64), r"int64 of shape \(0, 3\)"),
        (np.array([[0.5]]), "float64 of shape"),
        ([[1, 2]], "a first start is not at tick "),
    ],
)
def test_starts_that_the_table_does_not_cover_are_refused(
    starts: NDArray[np.int64], reason: str, echo: tuple[Path, Scenarios]
):
    with pytest.raises(ValueError, match=f"^starts: .*{reason}"):
        echo[1].values(starts)


def test_seeds_are_integers(echo: tuple[Path, Scenarios]):
    with pytest.raises(TypeError, match="'float' object cannot be interpreted as an integer"):
        echo[1].starts([1.5], 3)  # type: ignore[list-item]


def test_a_free_first_start_may_be_later_but_not_earlier(delayed: tuple[Path, Scenarios]):
    scenarios = delayed[1]
    assert scenarios.values(np.array([[scenarios.first], [scenarios.first + 12345]]))["echo"].shape == (2, 1)
    with pytest.raises(ValueError, match=f"^starts: a first start is before tick {scenarios.first}, where"):
        scenarios.values(np.array([[scenarios.first], [scenarios.first - 1]]))


def test_starts_that_are_too_close_are_refused(echo: tuple[Path, Scenarios]):
    scenarios = echo[1]
    starts = np.array([[scenarios.first, scenarios.first + scenarios.apart - 1]])
    with pytest.raises(ValueError, match=f"the starts [0-9] and [0-9] are less than {scenarios.apart} ticks apart"):
        scenarios.values(starts)
    assert scenarios.values(np.add(starts, [[0, 1]]))["echo"].shape == (1, 2)


def test_a_case_without_a_table_and_one_that_breaks_a_budget_are_refused(tmp_path: Path):
    with pytest.raises(BadCase, match=r"^responder has no closed table: unit dsp runs Python firmware"):
        Scenarios(TIMING / "responder.toml")
    with pytest.raises(BadCase, match=r"^fast_echo: echo failed in a run of its table; "):
        Scenarios(write_echo(tmp_path, 0.2))
