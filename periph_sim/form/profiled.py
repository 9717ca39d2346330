"""Compilation of the core with profiles of the cases that a user runs most: gcc optimizes the code that they execute.

python -m periph_sim.form.profiled CASE [CASE ...]

    sources --gcc, counting--> a library --runs of the cases--> counts --gcc, using them--> compiled/

Every module is compiled twice. Records and verdicts are equal to those of other builds. `make core` keeps the result
until a source changes. clang stores counts in another way, so the compiler must be gcc.
"""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from subprocess import run

from . import BUILT, PACKAGE, VARIABLE
from .build import NORMAL, BuildSettings, NoBuild, build, compiler, jobs, status_of

RELATIVE = "-fprofile-prefix-path={folder}"  # gcc leaves this folder out of the names of the files with counts
# Code that no run has executed is optimized as in an ordinary build, because other cases may execute it.
PARTIAL = "-fprofile-partial-training"


def counting(counts: Path) -> BuildSettings:
    """Return the settings of a build whose runs write counts into the folder `counts`."""
    generate = f"-fprofile-generate={counts}"
    return NORMAL._replace(flags=(*NORMAL.flags, generate, RELATIVE), link=(generate,))


def using(counts: Path) -> BuildSettings:
    """Return the settings of a build that is optimized with the counts in the folder `counts`."""
    return NORMAL._replace(flags=(*NORMAL.flags, f"-fprofile-use={counts}", PARTIAL, RELATIVE))


def require_gcc(cc: str) -> None:
    """Raise NoBuild if the compiler does not know the flags of this build."""
    with tempfile.TemporaryDirectory() as folder:
        flags = ["-Werror", "-fprofile-use", PARTIAL, RELATIVE.format(folder=folder)]
        command = [*cc.split(), *flags, "-c", "-x", "c", os.devnull, "-o", os.path.join(folder, "empty.o")]
        done = run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise NoBuild(
            f"{cc} cannot optimize for a case; name gcc 12 or newer in the variable CC. {cc} says:\n{done.stderr}"
        )


def count(case: str, package: Path, built: Path) -> None:
    """Run a case with the build `built`. The run counts for gcc how often each part of the code is executed.

    Raise NoBuild with the last line of the error message if the run fails.
    """
    # gcc's library writes the counts when the process ends in the normal way. The command `run` ends by `os._exit`,
    # after which no counts are written, so the function `run` is called instead.
    # With -P, Python does not import a package of this name from the current folder.
    command = [sys.executable, "-P", "-c", f"import sys, {package.name}; {package.name}.run(sys.argv[1])", case]
    done = run(command, env={**os.environ, VARIABLE: str(built)}, capture_output=True, text=True, check=False)
    if done.returncode:
        # If a signal ends the process, there is no message, and the exit status is shown instead.
        last = (done.stderr.strip().splitlines() or [f"exit status {done.returncode}"])[-1]
        raise NoBuild(f"{case} does not run, so nothing was counted; {last}")


def build_for(cases: Sequence[str], package: Path, built: Path, jobs: int) -> None:
    """Compile the core so that it runs these cases fast, and replace the build in the folder `built`.

    Raise NoBuild if no case is named, a suitable gcc, Cython or Python.h is missing, a module does not compile, a case
    does not run, or no case uses the compiled core.
    """
    if not cases:
        raise NoBuild("no case is named; name the cases to optimize for: python -m periph_sim.form.profiled CASE ...")
    require_gcc(compiler())
    with tempfile.TemporaryDirectory() as name:
        counts, counted = Path(name, "counts"), Path(name, "counted")
        counts.mkdir()
        build(package, counted, jobs, counting(counts))
        for case in cases:
            count(case, package, counted)
            print(f"counted {case}", flush=True)
        if not any(counts.iterdir()):
            raise NoBuild("the runs did not use the compiled core, so nothing was counted")
        build(package, built, jobs, using(counts), keep=False)


def main(cases: Sequence[str]) -> int:
    """Build the core so that it runs these cases fast. Return the exit status: 0, or 1 if the last build was kept."""
    return status_of(lambda: build_for(cases, PACKAGE, BUILT, jobs()), "the build is left as it was")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
