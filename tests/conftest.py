"""Settings of all tests: differing timing diagrams are shown one above the other; properties have no deadline.

`make test` runs each test once. `make coverage` counts lines of the interpreted core in tests that are neither `long`
nor `uncounted`. `long` are properties, whole recordings, whole cases, all rows of a parametrized test except the first,
and tests marked by hand: they execute lines that short tests execute, too. `uncounted` are tests that take seconds each
when interpreted and execute lines that other tests execute.

A session runs in one form of the core, including the commands that tests start; its first line names the form.
"""

from __future__ import annotations

import gc
import os
import signal
import sys
import threading
from collections.abc import Generator
from pathlib import Path

import pytest
from _pytest.pytester import SysModulesSnapshot
from hypothesis import is_hypothesis_test, settings
from hypothesis.internal.conjecture import providers

from periph_sim import form
from tests.waves import Diagram

pytest_plugins = [
    "pytester",  # runs the pytest plugin as in a user's project
    "tests.headless_browser",
    "tests.rules.outcomes",  # reports which rules of the manuals are proved
]

if form.running == form.INTERPRETED:
    os.environ[form.VARIABLE] = form.INTERPRETED  # so that no command reports a build of other sources

ROOT = Path(__file__).parents[1]

# Hypothesis also draws constants that it reads from the source of all modules imported so far, so that examples would
# depend on the tests that ran before in the same process.
providers.is_local_module_file = lambda path: False

# pytester removes the modules that were imported by a session inside the process. If a later test imported a module of
# ours again, each of its classes would exist twice, and numpy cannot be imported again.
KEPT = ("periph_sim.", "_firmware_shipped", "numpy")
_restore_modules = SysModulesSnapshot.restore


def _restore_others(snapshot: SysModulesSnapshot) -> None:
    kept = {name: module for name, module in sys.modules.items() if name.startswith(KEPT)}
    _restore_modules(snapshot)
    sys.modules.update(kept)


SysModulesSnapshot.restore = _restore_others

# Time is not tested, because machines are shared. Examples are the same each time, so that results depend on the
# change only; `make explore` looks for new ones, and failures that it finds are kept as an @example.
settings.register_profile("periph-sim", deadline=None, derandomize=True, max_examples=50)
settings.register_profile("explore", deadline=None, max_examples=1000)
settings.load_profile("periph-sim")


# Files whose import needs POSIX, with the reasons; single tests in other files have the marker `posix`.
NEED_POSIX = {
    "tests/docs/test_warm.py": "sockets of a Unix domain that pass on files",
    "tests/outside/drivers/test_i2c_dev.py": "fcntl.ioctl",
    "tests/outside/drivers/test_i2cdriver_port.py": "pseudo-terminals",
    "tests/outside/live/test_i2cdriver_door.py": "pseudo-terminals",
    "tests/outside/live/test_openings.py": "inotify",
    "tests/outside/live/test_port_door.py": "a pseudo-terminal as the real port",
    "tests/outside/live/test_pty_door.py": "pseudo-terminals",
    "tests/outside/test_log.py": "a log of pseudo-terminals",
    "tests/platforms/test_without_posix.py": "what it removes",
    "tests/test_supervisor.py": "fork and signals",
    "tests/test_wheel.py": "a lock of fcntl",
}

# Whole cases execute lines that the tests of the parts execute, too.
WHOLE = (
    "tests/scene/test_cases.py",
    "tests/scene/test_copy_points.py",
    "tests/scene/test_determinism.py",
    "tests/scene/test_responder.py",
    "tests/scene/test_two_dsps.py",
    "tests/captures/",
    "tests/interfaces/commands/test_all_measures.py",
    "tests/interfaces/commands/test_check.py",
    "tests/imu/commands/test_moving.py",
    "tests/imu/test_attitude.py",
    "tests/interfaces/commands/test_worst.py",
    "tests/imu/extremes/test_extremes.py",
    "tests/imu/moving/test_on_wires.py",
    "tests/interfaces/reports/html/test_browser.py",
    "tests/interfaces/reports/html/test_browser_page.py",
    "tests/rules/",
    "tests/test_event_counts.py",
    "tests/timing/test_model_age.py",
    "tests/interfaces/reports/explain/test_window.py",
)


# Tests with many scenes of tenths of a second.
UNCOUNTED = (
    "tests/devices/test_host_pc.py",
    "tests/interfaces/commands/test_prove_questions.py",
    "tests/interfaces/reports/baselines/test_check.py",
    "tests/proof/test_clock_errors.py",
    "tests/proof/test_table_tries.py",
    "tests/scene/test_event_budgets.py",
    "tests/scene/test_flagship.py",
    "tests/scene/test_imu_models.py",
    "tests/scene/test_long_runs.py",
    "tests/scene/test_model_order.py",
    "tests/scene/test_real_chips.py",
    "tests/timing/measures/test_value.py",
    "tests/timing/test_age.py",
    "tests/timing/test_margins.py",
    "tests/timing/test_measuring_costs.py",
    "tests/timing/test_pairs.py",
    "tests/timing/test_rounds.py",
    # The work is done in other processes, whose lines are not counted, or outside of the package.
    "tests/bench/",
    "tests/docs/",
    "tests/firmware_mutants/",
    "tests/form/test_c_checks.py::test_an_index_outside_of_its_array_ends_the_process_with_a_sentence",
    "tests/form/test_linked.py",
    "tests/form/test_none.py",
    "tests/processor/host_code/test_sources.py",
    "tests/test_earlier_project.py",
    "tests/mutants/",
    "tests/options/test_unrecorded.py",
    "tests/processor/test_stall_watch.py::test_a_stall_in_a_worker_process_is_stopped",
    "tests/interfaces/pytest_plugin/test_collected.py::test_xdist_workers_print_the_same_table",
    "tests/interfaces/pytest_plugin/test_start.py",
    "tests/interfaces/pytest_plugin/test_whole_session.py",
    "tests/scene/test_absent.py",
    "tests/test_supervisor.py",
    "tests/test_timeouts.py",
    "tests/test_touched.py",
    # These read the sources of all modules once more, as tests/form/test_declarations.py does, or run all forms of
    # instructions once more, as tests/processor/c28x/execution/test_known_results.py does.
    "tests/processor/c28x/execution/test_depends.py",
    "tests/form/test_c_checks.py::test_every_array_declaration_of_the_package_is_read",
    "tests/form/test_source_copy.py::test_every_free_list_of_the_package_is_inserted",
    # These use large inputs.
    "tests/traces/formats/test_sigrok_sr.py::test_the_memory_needed_depends_on_the_edges_and_not_on_the_length",
    "tests/traces/formats/test_vcd.py::test_a_line_without_an_end_and_too_many_changes_are_rejected",
)


# A shell makes background processes ignore Ctrl-C. Commands would inherit that, but tests end them by Ctrl-C.
if threading.current_thread() is threading.main_thread() and signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

gc.disable()  # collected tests stay, so garbage collections would examine them in vain


@pytest.hookimpl(trylast=True)
def pytest_collection_finish() -> None:
    gc.freeze()
    gc.enable()


_was_full = False  # True if the garbage collector has examined all objects since the last `gc.freeze`


def _note_full_collection(phase: str, info: dict[str, int]) -> None:
    global _was_full
    _was_full = _was_full or (phase == "stop" and info["generation"] == 2)


gc.callbacks.append(_note_full_collection)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item, nextitem: pytest.Item | None) -> Generator[None, object, object]:
    """Exclude the objects that a file of tests leaves, such as shared results, from later garbage collections."""
    global _was_full
    outcome = yield
    if _was_full and nextitem is not None and nextitem.path != item.path:
        gc.collect()
        gc.freeze()
        _was_full = False
    return outcome


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    seen: set[str] = set()
    for item in items:
        function = item.nodeid.partition("[")[0]
        again = function in seen
        if again or is_hypothesis_test(getattr(item, "obj", None)) or item.nodeid.startswith(WHOLE):
            item.add_marker("long")
        if item.nodeid.startswith(UNCOUNTED):
            item.add_marker("uncounted")
        if reason := NEED_POSIX.get(item.nodeid.partition("::")[0]):
            item.add_marker(pytest.mark.posix(reason))
        if os.name != "posix" and (posix := item.get_closest_marker("posix")) is not None:
            item.add_marker(pytest.mark.skip(reason=f"needs Linux or macOS: {posix.args[0]}"))
        seen.add(function)


def pytest_ignore_collect(collection_path: Path) -> bool | None:
    file = collection_path.relative_to(ROOT).as_posix() if collection_path.is_relative_to(ROOT) else ""
    return True if os.name != "posix" and file in NEED_POSIX else None


def pytest_report_header() -> str:
    return f"core: {form.running}" + (f" ({form.note})" if form.note else "")


def pytest_assertrepr_compare(op: str, left: object, right: object) -> list[str] | None:
    if op != "==" or not (isinstance(left, Diagram) and isinstance(right, Diagram)):
        return None
    lines = ["the timing diagram differs from the expected one:"]
    for came, wanted in zip(left.splitlines(), right.splitlines(), strict=False):
        lines.append(f"  actual    {came}")
        if came != wanted:
            lines.append(f"  expected  {wanted}")
            lines.append("            " + "".join(" ^"[a != b] for a, b in zip(came, wanted, strict=False)))
    return lines
