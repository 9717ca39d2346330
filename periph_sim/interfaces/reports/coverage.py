"""Coverage of a case: all chosen phases, run in worker processes, and the windows at which budgets are broken.

    chosen phases --parts--> worker processes --> results, in the order of the phases --> windows, worst values
                                                  '--saved--> coverage file --continue--> the parts that are missing

The parts do not depend on the number of processes, so neither does the result. The glossary in `periph_sim.proof` has
the terms.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from time import monotonic, process_time

from msgspec.structs import replace

from ...proof import coverage_file
from ...proof.cover import Covered, Coverer, Window, cover_part, joined_at_end, nothing, windows_of
from ...proof.coverage_file import Choice, CoverageFile
from ...proof.dependencies import Dependencies, dependencies, files_read
from ...proof.near import chosen_phases, parts_of
from ...proof.saved_file import BadSavedFile, text_of
from ...proof.stretch import CoveredCase, Job
from .baselines.files import write_all
from .cluster import ClusterError, ClusterExecutor, worker_pool
from .processes import results_of

PART = 512  # number of phases of a part
TRIED = 64  # maximum number of phases that are run to estimate the time
STOPPED = "stopped by Ctrl-C or SIGTERM"
SAVED_EVERY = 10.0  # minimum number of seconds between two writes of the coverage file


@dataclass
class Coverage:
    """A coverage and its results so far.

    job: the case and its changes, in a form that can be sent to another process. case: the case.
    chosen: the phases to run, in ascending order.
    choice: how the phases were chosen.
    depends: the files, packages and versions on which the results depend.
    seconds: the estimated CPU time of all runs, if nothing fails.
    found: the results of the finished parts.
    finished: the number of finished parts.
    windows: the windows. They are set after all parts are finished.
    is_complete: True if all phases were run and all windows were found.
    stopped: the reason why phases, windows or events at their ends are missing; "" if nothing is missing.
    """

    job: Job
    case: CoveredCase
    chosen: list[int]
    choice: Choice
    depends: Dependencies
    seconds: float
    found: Covered = field(default_factory=nothing)
    finished: int = 0
    windows: list[Window] = field(default_factory=list)
    is_complete: bool = False
    stopped: str = ""

    @property
    def run_count(self) -> int:
        """The number of different phases that were run. A phase is the distance of a start from a reference time."""
        return len({*self.found.held, *self.found.failed})

    @property
    def missing(self) -> int:
        """The number of chosen phases in the unfinished parts."""
        return sum(map(len, self.parts[self.finished :]))

    @property
    def parts(self) -> list[list[int]]:
        """The chosen phases, in lists of up to PART phases."""
        return list(parts_of(self.chosen, PART))

    def saved(self) -> CoverageFile:
        """Return the contents of the coverage file."""
        ranges = coverage_file.to_ranges(self.found.held, self.chosen)
        return CoverageFile(
            case=self.case.case.name,
            choice=self.choice,
            dependencies=self.depends,
            finished=self.finished,
            parts=len(self.parts),
            run_count=self.run_count,
            held=ranges,
            found=replace(self.found, held=[]),
            windows=self.windows if self.is_complete else None,
        )

    def continue_from(self, saved: CoverageFile) -> bool:
        """Take the results of a coverage file, to continue from there, and return True.

        If the file has other phases or dependencies than this coverage, change nothing, and return False.
        """
        if saved.choice != self.choice or saved.dependencies != self.depends:
            return False
        self.found, self.finished = saved.found, saved.finished
        self.found.held = coverage_file.from_ranges(saved.held, self.chosen)
        return True

    @property
    def is_whole(self) -> bool:
        """True if the phases were chosen from a whole period, without the option `--phases`."""
        return self.choice.bounds == (0, self.choice.count - 1)


def choose(job: Job, step: int, only: tuple[Fraction, Fraction] | None) -> Coverage:
    """Return a coverage without results. A few of its phases are run to estimate the time.

    step: the distance between two chosen phases that are not near a write of the firmware, in cycles.
    only: the times, in seconds, between which phases are chosen; None for all phases of a period.
    """
    with files_read() as read:
        case = CoveredCase(job)
        phases = case.phases
        bounds = (0, phases.count - 1) if only is None else phases.between(*only)
        chosen, near = chosen_phases(case, step, bounds)
        seconds = _estimated_time(case, chosen)
        folder = Path(job.file).parent
        depends = dependencies(folder, [*read, *case.case.files()])
    cycle = float(phases.seconds(1) * 10**12)
    digest = coverage_file.digest_of(chosen)
    moved = phases.moved, phases.start_up, phases.count, cycle
    choice = Choice(*moved, len(chosen), near, step, phases.rounds, bounds, digest)
    return Coverage(job, case, chosen, choice, depends, seconds)


def _estimated_time(case: CoveredCase, chosen: Sequence[int]) -> float:
    """Return the CPU time for these phases, in seconds, estimated from a run of the first TRIED of them."""
    tried = chosen[: 1 if case.phases.is_one_a_run else TRIED]
    case.run(tried[:1], case.case.seed)  # not timed, because the first run also imports modules
    began = process_time()
    case.run(tried, case.case.seed)
    return (process_time() - began) / len(tried) * len(chosen)


def run_coverage(
    coverage: Coverage,
    jobs: int,
    on_progress: Callable[[float], None] | None = None,
    save_to: Path | None = None,
    cluster: ClusterExecutor | None = None,
) -> None:
    """Run the parts that are not finished, add their results, and find the windows.

    After Ctrl-C, or if a worker process dies or the cluster is lost, the coverage has the results of the finished
    parts, and `stopped` has the reason.

    jobs: number of worker processes.
    save_to: the coverage file, which is written every SAVED_EVERY seconds and at the end; None for no file.
    cluster: the cluster that runs the parts; None for worker processes of this computer.
    """
    parts, saved_at = coverage.parts, monotonic()
    missing = parts[coverage.finished :]
    try:
        for found in _results(coverage, missing, jobs, cluster):
            coverage.found.add(found)
            coverage.finished += 1
            if on_progress is not None:
                on_progress(coverage.finished / len(parts))
            if save_to is not None and monotonic() - saved_at > SAVED_EVERY:
                save(coverage, save_to)
                saved_at = monotonic()
    except KeyboardInterrupt:
        coverage.stopped = STOPPED
    except ClusterError as error:
        coverage.stopped = str(error)
    except BrokenProcessPool:
        first = coverage.choice.time(parts[coverage.finished][0])
        coverage.stopped = f"a process died while it ran the phases from {first}"
    if save_to is not None:
        save(coverage, save_to)
    try:
        _finish(coverage)
    except KeyboardInterrupt:
        coverage.stopped = coverage.stopped or STOPPED
    coverage.is_complete = not coverage.stopped
    if save_to is not None and coverage.is_complete:
        save(coverage, save_to)


def save(coverage: Coverage, path: Path) -> None:
    """Write the coverage file, completely or not at all. An incomplete coverage does not replace a complete one."""
    saved = coverage.saved()
    if not saved.is_complete and _has_complete_coverage(path):
        return
    write_all({path: text_of(saved)})


def _has_complete_coverage(path: Path) -> bool:
    """Return True if a file is a complete coverage."""
    try:
        there = CoverageFile.read(path)
    except BadSavedFile:
        return False
    return there is not None and there.is_complete


def _results(
    coverage: Coverage, parts: Sequence[list[int]], jobs: int, cluster: ClusterExecutor | None
) -> Iterator[Covered]:
    """Run parts, and yield their results in order. Each part has its own seed, and so other random values."""
    calls = [(coverage.job, part, seed) for seed, part in enumerate(parts, coverage.case.case.seed + coverage.finished)]
    if jobs == 1 and cluster is None:
        yield from (cover_part(*call) for call in calls)
        return
    with worker_pool(jobs, cluster) as pool:
        yield from results_of(pool, cover_part, calls)


def _finish(coverage: Coverage) -> None:
    """Find the windows. Then run the phase of each worst value alone, if the value is from a run of several phases.

    If such a run has the same worst value, it replaces the longer run in the results. Values without an instant are
    skipped, because their phase is not known.
    """
    if not coverage.found.held and not coverage.found.failed:
        return
    coverer = Coverer(coverage.case, coverage.case.case.seed, coverage.found)
    windows = windows_of(coverage.found, coverer.status, coverage.choice.bounds)
    # The phases of frames and rounds repeat in each period, so a window can continue from the last phase to the first.
    if coverage.is_whole and not coverage.case.phases.is_one_a_run:
        windows = joined_at_end(windows, coverage.choice.count, coverer.status)
    coverage.windows = windows
    for worst in list(coverage.found.worst.values()):
        at = worst.verdict.at_s
        if len(worst.phases) > 1 and at is not None:
            Coverer(coverage.case, worst.seed, coverage.found).repeat(coverage.case.phases.phase_at(worst.phases, at))
