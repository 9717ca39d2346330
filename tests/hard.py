"""Run tests with the hard build of the core, which stops at the first fault.

    python -m tests.hard [--short] [--cases COUNT] [--seed SEED] [PYTEST OPTIONS]
    python -m tests.hard --memcheck

    make core HARD=1 --> build/hard --+--> pytest: the tests of what is compiled
                                      +--> random cases (tests/form/random_cases.py): the same records as interpreted
                                      +--> shipped cases with a collection of garbage at each new object: the same

Everything runs in processes with the sanitizers loaded and a small stack. --short builds only the kernel and the wires,
and runs their tests and the shipped cases; random cases need all modules in one build. With paths of tests, only these
tests run. The seed is random unless it is given.

Address sanitizer checks the heap. Python's objects are allocated individually (PYTHONMALLOC), so that each is checked.
Leaks are not reported, because Python keeps objects until it ends, and stacks cannot be checked, because greenlets copy
them. --memcheck covers stacks: a case runs with the usual build under valgrind, which reports each use of an
uninitialised value, on a stack or on the heap, and each access outside of allocated heap memory.
"""

from __future__ import annotations

import argparse
import os
import re
import resource
import subprocess
import sys
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import zip_longest
from pathlib import Path
from random import SystemRandom

from periph_sim import form
from periph_sim.form import build

ROOT = Path(__file__).parents[1]
STACK = 2 << 20  # bytes; the usual size is 8 MB
COLLECTED = ("imu_hil", "imu_hil_image", "imu_chips", "eeprom_log", "two_dsps", "uart_logger")
RECORD = ("-m", "tests.bench.record_hashes", "--collect", "--seconds")
# Reports of memcheck that are not faults: CPython 3.11 multiplies an uninitialised digit by zero when it makes the
# integer 0, so the address of this integer counts as uninitialised; and the loader compares texts word by word.
NOT_OURS = re.compile(r"was created by a heap allocation\n.*\n.*: _PyLong_New |: is_dst \(")
SHORT_MODULES = ("core",)
SHORT_TESTS = ("tests/core", "tests/form/test_none.py", "tests/form/test_linked.py")
LONG_TESTS = (
    "tests/core",
    "tests/f28335",
    "tests/processor/c28x",
    "tests/processor",
    "tests/scene",
    "tests/replay",
    "tests/form/test_none.py",
)


def environment() -> dict[str, str]:
    """Return the environment of a process that loads a library with sanitizers. Raise NoBuild without a sanitizer.

    The C++ library is preloaded, too, or address sanitizer would not find it when greenlet throws an exception.
    """
    sanitizer, cpp = (_library(name) for name in ("libasan.so", "libstdc++.so.6"))
    if not Path(sanitizer).is_file():
        raise build.NoBuild("the C compiler has no address sanitizer (libasan.so); install gcc's libasan")
    return {
        **os.environ,
        form.VARIABLE: form.HARD,
        "LD_PRELOAD": f"{sanitizer} {cpp}",
        "PYTHONMALLOC": "malloc",
        "ASAN_OPTIONS": "detect_leaks=0:detect_stack_use_after_return=0:allocator_may_return_null=1",
        "UBSAN_OPTIONS": "print_stacktrace=1:halt_on_error=1",
    }


def _library(name: str) -> str:
    """Return the path of a library of the C compiler, or its bare name if it does not exist."""
    command = [*build.compiler().split(), f"-print-file-name={name}"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def small_stack() -> None:
    resource.setrlimit(resource.RLIMIT_STACK, (STACK, STACK))


def run_hard(command: Sequence[str], variables: Mapping[str, str] = {}) -> subprocess.CompletedProcess[str]:
    """Run a command of this Python in such a process, and return its output."""
    return subprocess.run(
        [sys.executable, *command],
        cwd=ROOT,
        env={**environment(), **variables},
        preexec_fn=small_stack,
        capture_output=True,
        text=True,
        check=False,
    )


def compare(command: Sequence[str]) -> tuple[bool, str]:
    """Return True if a command writes the same lines with the hard build as interpreted, and a report.

    Both processes run at the same time. The report has the first difference.
    """
    with ThreadPoolExecutor(1) as other:
        interpreted = other.submit(run_interpreted, command)
        hard = run_hard(command)
        plain = interpreted.result()
    lines, wanted = hard.stdout.splitlines(), plain.stdout.splitlines()
    report = [f"{' '.join(command)}: {len(wanted)} cases"]
    if (hard.returncode, plain.returncode) == (0, 0) and lines == wanted:
        return True, report[0]
    for line, other_line in zip_longest(lines, wanted, fillvalue="nothing"):
        if line != other_line:
            report += [f"hard build:  {line}", f"interpreted: {other_line}"]
            break
    for name, done in (("hard build", hard), ("interpreted", plain)):
        report.append(f"{name}: exit status {done.returncode}\n{done.stderr}")
    return False, "\n".join(report)


def run_interpreted(command: Sequence[str]) -> subprocess.CompletedProcess[str]:
    """Run a command of this Python with the interpreted form."""
    env = {**os.environ, form.VARIABLE: form.INTERPRETED}
    return subprocess.run([sys.executable, *command], cwd=ROOT, env=env, capture_output=True, text=True, check=False)


def memcheck() -> int:
    """Run a few milliseconds of a case with the usual build under valgrind. Print errors; return 1 if there are any."""
    options = ["--quiet", "--track-origins=yes", "--num-callers=40"]
    done = subprocess.run(
        ["valgrind", *options, sys.executable, *RECORD, "0.006", COLLECTED[0]],
        cwd=ROOT,
        env={**os.environ, form.VARIABLE: form.COMPILED, "PYTHONMALLOC": "malloc"},
        capture_output=True,
        text=True,
        check=False,
    )
    errors = [one for one in re.sub(r"(?m)^==\d+== ?", "", done.stderr).split("\n\n") if one.strip()]
    found = [one for one in errors if not NOT_OURS.search(one)]
    print(*found, done.stdout, f"{len(errors) - len(found)} known reports of CPython and the loader", sep="\n")
    return int(done.returncode != 0 or bool(found))


def main(options: list[str]) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--short", action="store_true")
    parser.add_argument("--memcheck", action="store_true")
    parser.add_argument("--cases", type=int, default=500)
    parser.add_argument("--seed", type=int, default=SystemRandom().randrange(10**9))
    given, others = parser.parse_known_args(options)
    if given.memcheck:
        return build.main() or memcheck()
    status = build.main(["--hard", *(SHORT_MODULES if given.short else ())])
    if status:
        return status
    chosen = any(one.startswith("tests") for one in others)
    paths = () if chosen else SHORT_TESTS if given.short else LONG_TESTS
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *(["-m", "not long"] * given.short)]
    checks = [] if chosen else [(*RECORD, "0.008", *COLLECTED)]
    if checks and not given.short:
        checks.append(("-m", "tests.form.random_cases", "--seed", str(given.seed), "--count", str(given.cases)))
    with ThreadPoolExecutor(1) as beside:  # the tests use only one core
        compared = [beside.submit(compare, one) for one in checks]
        status = subprocess.run(
            [*command, *others, *paths], cwd=ROOT, env=environment(), preexec_fn=small_stack, check=False
        ).returncode
    results = [one.result() for one in compared]
    for _, report in results:
        print(report)
    return status or not all(same for same, _ in results)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
