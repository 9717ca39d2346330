"""Sweeps: rows and their order are equal with any executor, columns are arrays, and a failed run affects no other."""

from __future__ import annotations

import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from fractions import Fraction
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from periph_sim import BadCase, Sweep, run, sweep
from tests.interfaces.reports.sweep import programs

CASE = """\
name = "small"
duration = "300 us"

[unit.dsp]
firmware = "mine.py"
modules = ["SCI-A"]
[unit.dsp.settings]
work = "10 us"

[[budget]]
name = "work"
measure = "span:work"
max = "30 us"

[[budget]]
name = "never"
measure = "span:nothing"
max = "30 us"
"""
FIRMWARE = """\
from dataclasses import dataclass

from periph_sim.firmware import Duration

seen = []


@dataclass
class Settings:
    work: Duration


def main(dsp, settings):
    seen.append(settings.work)
    for _ in range(len(seen)):
        with dsp.span("work"):
            dsp.compute(settings.work)
    dsp.spin(lambda: dsp.module("SCI-A").SCIRXST.RXRDY == 1)
"""
LINE = """\
name = "line"
duration = "6 ms"

[unit.dsp]
firmware = "sci_echo"
modules = ["SCI-A", "GPIO"]

[host]
frames = 1
"""
BYTES = ("I2C bytes", "SCI bytes", "SCI bytes from units")
WORK = "unit.dsp.settings.work"
LENGTHS = [f"{length} us" for length in (20, 10, 40, 25)]
WORST = [20.0, 10.0, 40.0, 25.0]


@pytest.fixture
def case(tmp_path: Path) -> Path:
    (tmp_path / "mine.py").write_text(FIRMWARE, encoding="utf-8")
    file = tmp_path / "small.toml"
    file.write_text(CASE, encoding="utf-8")
    return file


class ReverseExecutor(Executor):
    """An executor that makes all its calls, in reverse order, when the first result is requested."""

    def __init__(self) -> None:
        self.waiting: list[tuple[Future[object], Callable[[], object]]] = []

    def submit(self, work, /, *args, **kwargs):  # type: ignore[no-untyped-def, override]
        future: Future[object] = Future()
        self.waiting.append((future, lambda: work(*args, **kwargs)))
        original = future.result

        def result(timeout: float | None = None) -> object:
            while self.waiting:
                which, make = self.waiting.pop()
                which.set_result(make())
            return original(timeout)

        future.result = result  # type: ignore[method-assign]
        return future


@contextmanager
def dask_executor() -> Iterator[Executor]:
    """Yield the executor of a local Dask cluster of two processes."""
    distributed = pytest.importorskip("distributed", reason="the extra dask is not there: pip install -e '.[dask]'")
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client.get_executor()


EXECUTORS: dict[str, Callable[[], object]] = {
    "threads": lambda: ThreadPoolExecutor(3),
    "processes": lambda: ProcessPoolExecutor(2, get_context("spawn")),
    "backwards": ReverseExecutor,
    "dask": dask_executor,
}


def figures(outcome: Sweep) -> dict[str, list[object]]:
    """Return all columns, with None in place of NaN."""
    return {
        name: [None if value != value else value for value in column.tolist()]
        for name, column in outcome.columns().items()
    }


STUCK = "stuck: dsp waits for SCI-A.SCIRXST.RXRDY since {} and would for ever: PCLKCR gives SCI-A no clock"


def test_a_column_for_each_figure_and_an_entry_for_each_run(case: Path) -> None:
    parts: list[float] = []
    outcome = sweep(case, {WORK: LENGTHS}, jobs=1, on_progress=parts.append)
    assert len(outcome) == 4 and outcome.case == "small"
    assert parts == [0.25, 0.5, 0.75, 1.0]
    assert outcome.changes[WORK].tolist() == LENGTHS
    assert outcome.worst["work"].tolist() == WORST and outcome.worst["work"].dtype == np.float64
    work, never = outcome.budgets["work"], outcome.budgets["never"]
    assert (work.measure, work.unit, work.limit.tolist()) == ("span:work", "us", [30.0] * 4)
    assert work.margin.tolist() == [10.0, 20.0, -10.0, 5.0]
    assert work.verdict.tolist() == ["pass", "pass", "broken", "pass"]
    assert (work.count.tolist(), work.at_s.tolist()) == ([1] * 4, [0.0] * 4)
    assert np.isnan(never.worst).all() and never.verdict.tolist() == ["not judged"] * 4
    assert outcome.verdict.tolist() == ["fail"] * 4 and outcome.error[0] == STUCK.format("20.000 us")
    assert outcome.simulated_s.tolist() == [0.0003] * 4
    assert outcome.counts["overruns"].tolist() == [0] * 4


def test_each_run_equals_that_of_run(case: Path) -> None:
    outcome = sweep(case, {WORK: LENGTHS}, seconds="25 us", jobs=1)
    for row, length in enumerate(LENGTHS):
        alone = run(case, [f"{WORK}={length}"], seconds=Fraction(25, 1_000_000))
        words = ["pass" if one.passed else one.word for one in alone.budgets]
        assert [budget.verdict[row] for budget in outcome.budgets.values()] == words
        assert outcome.worst["work"][row] == alone.budgets[0].worst
        assert outcome.verdict[row] == alone.verdict
        assert (outcome.events[row], outcome.wire_bytes[row]) == (alone.events, alone.wire_bytes)


def test_bytes_of_the_bus_and_of_both_directions_of_the_sci_have_columns(tmp_path: Path) -> None:
    """A host sends a frame of 12 bytes; one program sends them back, and the other sends nothing."""
    case = tmp_path / "line.toml"
    case.write_text(LINE, encoding="utf-8")
    outcome = sweep(case, {"unit.dsp.firmware": ["sci_echo", "uart_logger"]}, jobs=1)
    assert (outcome.sci_bytes.tolist(), outcome.sci_bytes_sent.tolist()) == ([12, 12], [12, 0])
    table = outcome.columns()
    assert [table[name].tolist() for name in BYTES] == [[0, 0], [12, 12], [12, 0]]


@pytest.mark.parametrize("which", EXECUTORS)
def test_rows_and_their_order_are_the_same_with_any_executor(case: Path, which: str) -> None:
    changes = {"seed": range(3), WORK: LENGTHS}
    alone = sweep(case, changes, jobs=1)
    with ExitStack() as stack:
        made = EXECUTORS[which]()
        executor = made if isinstance(made, ReverseExecutor) else stack.enter_context(made)  # type: ignore[arg-type]
        outcome = sweep(case, changes, executor=executor)
        again = sweep(case, changes, executor=executor)  # the executor is still open
    assert figures(outcome) == figures(alone) == figures(again)
    assert alone.worst["work"].tolist() == WORST * 3


@pytest.mark.parametrize("jobs", [2, 3])
def test_rows_and_their_order_are_the_same_with_any_number_of_processes(case: Path, jobs: int) -> None:
    assert figures(sweep(case, {WORK: LENGTHS}, jobs=jobs)) == figures(sweep(case, {WORK: LENGTHS}, jobs=1))


def test_many_runs_are_submitted_in_groups_and_stay_in_order(case: Path) -> None:
    lengths = [f"{length} us" for length in range(70, 0, -1)]
    backwards = ReverseExecutor()
    outcome = sweep(case, {WORK: lengths}, seconds="80 us", executor=backwards)
    assert outcome.worst["work"].tolist() == [float(length) for length in range(70, 0, -1)]


@pytest.mark.parametrize(
    ("changes", "columns"),
    [
        ({"seed": [1, 2], WORK: ["1 us", "2 us"]}, {"seed": [1, 1, 2, 2], WORK: ["1 us", "2 us"] * 2}),
        ([{"seed": 1}, {WORK: "2 us"}], {"seed": ["1", ""], WORK: ["", "2 us"]}),
        (["seed=1", [f"{WORK}=2 us", "seed = 3"]], {"seed": ["1", "3"], WORK: ["", "2 us"]}),
        ({"seed": np.arange(2)}, {"seed": [0, 1]}),
        ({"strict": [True, False]}, {"strict": [True, False]}),
        ({"unit.dsp.ppm": [0.5, 2]}, {"unit.dsp.ppm": [0.5, 2.0]}),
        ({"unit.dsp.modules": [["SCI-A", "TIMER0"]]}, {"unit.dsp.modules": ["['SCI-A', 'TIMER0']"]}),
    ],
)
def test_changes_are_given_as_a_table_or_a_list(case: Path, changes, columns: dict[str, list[object]]) -> None:
    outcome = sweep(case, changes, jobs=1)
    assert {key: column.tolist() for key, column in outcome.changes.items()} == columns
    assert all(error.startswith("stuck: dsp waits") for error in outcome.error)


def test_a_run_with_an_error_states_the_reason_and_affects_no_other(
    case: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(case.parent)
    outcome = sweep(
        "small.toml", [f"{WORK}=20 us", f"{WORK}=3 parsec", "unit.dsp.firmware=none.py", f"{WORK}=25 us"], jobs=1
    )
    assert outcome.verdict.tolist() == ["fail", "error", "error", "fail"]
    assert outcome.error.tolist() == [
        STUCK.format("20.000 us"),
        f"small.toml, --set '{WORK}=3 parsec': {WORK}: '3 parsec': unit 'parsec' is none of ns, us, ms, s, min, h, d",
        "small.toml, --set 'unit.dsp.firmware=none.py': unit.dsp.firmware: there is no firmware file 'none.py'; "
        "its path counts from the folder of the case",
        STUCK.format("25.000 us"),
    ]
    work = outcome.budgets["work"]
    assert figures(outcome)["work: worst"] == [20.0, None, None, 25.0]
    assert (work.count.tolist(), work.verdict.tolist()) == ([1, -1, -1, 1], ["pass", "", "", "pass"])
    assert outcome.counts["resets"].tolist() == [0, -1, -1, 0]


def test_a_worker_that_dies_affects_only_its_run(case: Path) -> None:
    case.write_text(CASE.replace("mine.py", "given").replace('[unit.dsp.settings]\nwork = "10 us"\n', ""))
    dies = {"dsp": programs.dying, "other": programs.pausing}
    case.write_text(case.read_text() + '\n[unit.other]\nfirmware = "given"\nmodules = []\n')
    with pytest.raises(BadCase, match="its process died before it finished; periph-sim run shows"):
        sweep(case, {"seed": [1, 2]}, programs=dies, jobs=2)  # every run dies
    (case.parent / "mine.py").write_text(
        "import os\nfrom dataclasses import dataclass\n\n\n@dataclass\nclass Settings:\n    work: str\n\n\n"
        "def main(dsp, settings):\n    dsp.compute(100)\n    settings.work == 'die' and os._exit(3)\n"
        "    with dsp.span('work'):\n        dsp.compute(300)\n"
    )
    case.write_text(CASE)
    outcome = sweep(case, {WORK: ["a", "die", "b", "c"]}, jobs=2)
    assert figures(outcome)["work: worst"] == [2.0, None, 2.0, 2.0]
    assert ["died before it finished" in error for error in outcome.error] == [False, True, False, False]


def test_firmware_defined_in_a_module_runs_in_other_processes(case: Path) -> None:
    case.write_text(CASE.replace("mine.py", "given").replace('[unit.dsp.settings]\nwork = "10 us"\n', ""))
    outcome = sweep(case, {"seed": [1, 2]}, programs={"dsp": programs.pausing}, jobs=2)
    assert (outcome.worst["work"].tolist(), outcome.budgets["work"].count.tolist()) == ([10.0, 10.0], [10, 10])


def test_firmware_that_waits_for_ever_ends_in_the_thread_that_ran_it(case: Path) -> None:
    ended: list[bool] = []

    def waiting(dsp: Any, settings: Any) -> None:
        began = threading.get_ident()
        try:
            dsp.spin(lambda: False)
        finally:
            ended.append(threading.get_ident() == began)

    case.write_text(CASE.replace("mine.py", "given").replace('[unit.dsp.settings]\nwork = "10 us"\n', ""))
    with ThreadPoolExecutor(2) as threads:
        sweep(case, {"seed": range(6)}, programs={"dsp": waiting}, executor=threads)
        assert ended == [True] * 6  # before the threads end and before garbage is collected


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda case: sweep(case, {"seeed": [1]}), "--set 'seeed=1': there is no key 'seeed'; did you mean seed?"),
        (
            lambda case: sweep(case, [{"seed": 1}, {"unit.dsp.modul": 2}]),
            "no key 'unit.dsp.modul'; did you mean modules?",
        ),
        (lambda case: sweep(case, {"budget.wrok.max": ["1 us"]}), "there is no entry 'wrok'; did you mean work?"),
        (lambda case: sweep(case, {"name.x": [1]}), "--set 'name.x=1': name is a value, not a table"),
        (
            lambda case: sweep(case, {"unit.dsp.settings.wrk": ["1 us"]}, jobs=1),
            "mine.py has no setting 'wrk'; did you mean work?",
        ),
        (
            lambda case: sweep(case, {"host.jitter": ["1 parsec"]}, jobs=1),
            "host.jitter: '1 parsec': unit 'parsec' is none of",
        ),
        (lambda case: sweep(case, {}), "changes: they contain no run; give each key at least one value"),
        (lambda case: sweep(case, {"seed": []}), "changes: they contain no run"),
        (lambda case: sweep(case, "seed=1"), "changes='seed=1': give a list of runs, or a table of keys"),
        (lambda case: sweep(case, ["seed"]), "changes, run 0: 'seed': expected key=value"),
        (lambda case: sweep(case, {"seed": "12"}), "'seed' has '12'; give a list of its values"),
        (lambda case: sweep(case, {"seed": 12}), "'seed' has 12; give a list of its values"),
        (lambda case: sweep(case, {"seed": [None]}), "'seed' has None; expected a number, true or false"),
        (lambda case: sweep(case, {"duration": [Fraction(1, 3)]}), "has no unit; write a text, for instance '10 ms'"),
        (lambda case: sweep(case, ["seed=1"], seconds="3"), "seconds='3': '3' has no unit"),
        (lambda case: sweep(case, ["seed=1"], jobs=0), "jobs=0: expected 1 or more"),
        (lambda case: sweep(case, ["seed=1"], jobs=1, executor=ReverseExecutor()), "jobs=1 with an executor"),
        (lambda case: sweep(case, ["seed=1"], programs={"dps": programs.pausing}), "has no unit 'dps'; it has dsp"),
        (lambda case: sweep(case.with_name("none.toml"), ["seed=1"]), "none.toml: cannot be read"),
        (
            lambda case: sweep(case, {"seed": [1, 2]}, programs={"dsp": lambda dsp, settings: None}, jobs=2),
            "programs: 'dsp' cannot be sent to another process; define it in a module, not in another function, or",
        ),
    ],
)
def test_a_wrong_argument_is_one_error_message(case: Path, call: Callable[[Path], object], sentence: str) -> None:
    with pytest.raises(BadCase) as error:
        call(case)
    assert sentence in str(error.value) and "\n" not in str(error.value)


def test_a_script_without_a_main_guard_is_an_error_at_once(case: Path) -> None:
    """Each worker process imports the script, which would start the sweep again."""
    script = case.with_name("script.py")
    script.write_text(
        "import periph_sim\n"
        "try:\n"
        "    periph_sim.sweep('small.toml', {'seed': range(1000)}, jobs=2)\n"
        "except periph_sim.BadCase as error:\n"
        "    print(error)\n"
    )
    outcome = subprocess.run(
        [sys.executable, script.name], cwd=case.parent, capture_output=True, text=True, check=False
    )
    assert outcome.stdout.endswith("; or give jobs=1\n") and outcome.stdout.startswith(
        "no process can be started for the runs"
    )
    assert outcome.returncode == 0
