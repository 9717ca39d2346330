"""Run pytest in forks of a process that has imported every module that no mutant of a room can affect.

    start --> pytest, libraries, every own module that can be imported without the room --> waits on stdin
    {"arguments": [...], "seconds": s, "cpu": c} --fork--> pytest in the child --> {"status": n, "output": t, "cpu": c}

It is started as `python warm.py PACKAGE...` in the folder of a tree, with the packages of the room. Importing takes
longer than most tests that kill a mutant, and a fork has the imported modules. Modules that import the room, directly
or indirectly, are imported again by each child; they are found by trying, with the room locked.
"""

from __future__ import annotations

import gc
import importlib
import json
import os
import resource
import signal
import sys
import tempfile
import time
from importlib.abc import MetaPathFinder
from pathlib import Path
from typing import IO, Any

NOT_OURS_TO_IMPORT = ("tests", "__main__")  # pytest rewrites the asserts of tests, and importing a main module runs it
PLUGINS = ("pytest", "pytest_timeout", "xdist.plugin", "hypothesis", "hypothesis.core", "_hypothesis_pytestplugin")
LONGEST = 100_000  # maximum number of characters returned, from the end of the output
PAUSE = 0.01  # seconds between checks of the child


class Locked(BaseException):
    """A module of the room was imported. Not an Exception, so that it is not handled as a missing library."""


class Lock(MetaPathFinder):
    def __init__(self, packages: list[str]) -> None:
        self._packages = packages

    def find_spec(self, name: str, *_: Any) -> None:
        if any(f"{name}.".startswith(f"{package}.") for package in self._packages):
            raise Locked(name)


def modules(folder: Path) -> list[str]:
    """Return the names of the modules in a tree's packages."""
    parts = [path.relative_to(folder).with_suffix("").parts for path in folder.glob("*/**/*.py")]
    names = {".".join(of).removesuffix(".__init__") for of in parts if not {*of} & {*NOT_OURS_TO_IMPORT}}
    return sorted(name for name in names if (folder / name.partition(".")[0] / "__init__.py").exists())


def open_to_all(names: list[str]) -> list[str]:
    """Return the modules that can be imported, tried in a child, because a failed import leaves others imported."""
    reader, writer = os.pipe()
    child = os.fork()
    if not child:
        found: list[str] = []
        for name in names:
            before = {*sys.modules}
            try:
                importlib.import_module(name)
            except (Locked, Exception):
                for left in {*names} & {*sys.modules} - before:
                    del sys.modules[left]  # its package failed after importing it, so it cannot be imported alone
                continue
            found.append(name)
        os.write(writer, json.dumps(found).encode())
        os._exit(0)
    os.close(writer)
    with os.fdopen(reader) as output:
        found = json.loads(output.read() or "[]")
    os.waitpid(child, 0)
    return list(found)


def run_pytest(arguments: list[str], seconds: float, cpu: int) -> dict[str, object]:
    """Run pytest in a child with its own process group. The status is None if it was killed after `seconds`.

    After `cpu` seconds of processor time, the system ends it with SIGXCPU.
    """
    with tempfile.TemporaryFile() as out:
        child = os.fork()
        if not child:
            _be_pytest(arguments, out, cpu)
        end = time.monotonic() + seconds
        status: int | None = None
        while status is None and time.monotonic() < end:
            done, how, used = os.wait4(child, os.WNOHANG)
            if done:
                status = os.waitstatus_to_exitcode(how)
            else:
                time.sleep(PAUSE)
        if status is None:
            os.killpg(child, signal.SIGKILL)
            _, _, used = os.wait4(child, 0)
        out.seek(0)
        output = out.read().decode(errors="replace")[-LONGEST:]
        return {"status": status, "output": output, "cpu": used.ru_utime + used.ru_stime}


def _be_pytest(arguments: list[str], out: IO[bytes], cpu: int) -> None:
    import pytest

    os.setsid()
    resource.setrlimit(resource.RLIMIT_CPU, (cpu, resource.RLIM_INFINITY))
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(out.fileno(), 1)
    os.dup2(out.fileno(), 2)
    try:
        status = int(pytest.main(arguments))
        sys.stdout.flush()
        sys.stderr.flush()
    finally:
        os._exit(locals().get("status", 70))


def main(packages: list[str]) -> None:
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    for name in PLUGINS:
        importlib.import_module(name)
    lock = Lock(packages)
    sys.meta_path.insert(0, lock)
    for name in open_to_all(modules(Path.cwd())):
        importlib.import_module(name)
    sys.meta_path.remove(lock)
    gc.freeze()
    for line in iter(sys.stdin.readline, ""):
        request = json.loads(line)
        print(
            json.dumps(run_pytest(request["arguments"], request["seconds"], request["cpu"])), file=answers, flush=True
        )


if __name__ == "__main__":
    main(sys.argv[1:])
