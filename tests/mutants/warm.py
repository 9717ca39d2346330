"""Pytest in a process that has imported all that no mutant of a room can touch: arguments in, what it said out.

    start --> pytest, libraries, every module of ours that can be imported without the room's --> waits on stdin
    {"arguments": [...], "seconds": s, "cpu": c} --fork--> pytest in the child --> {"status": n, "told": ..., "cpu": c}

Started as `python warm.py PACKAGE...` in the folder of a tree; the packages are the room's. Importing costs more than
most tests that kill a mutant, and a fork starts with all of it done. What imports the room, be it at second hand, is
imported by each child anew: which modules those are is not worked out but tried, with the room locked.
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

NOT_OURS_TO_IMPORT = ("tests", "__main__")  # pytest rewrites the asserts of tests; a main runs
PLUGINS = ("pytest", "pytest_timeout", "xdist.plugin", "hypothesis", "hypothesis.core", "_hypothesis_pytestplugin")
LONGEST = 100_000  # characters handed back, the last ones
PAUSE = 0.01  # seconds between looks at the child


class Locked(BaseException):
    """A module of the room was asked for. No Exception, so that nobody takes it for a missing library."""


class Lock(MetaPathFinder):
    def __init__(self, packages: list[str]) -> None:
        self._packages = packages

    def find_spec(self, name: str, *_: Any) -> None:
        if any(f"{name}.".startswith(f"{package}.") for package in self._packages):
            raise Locked(name)


def modules(folder: Path) -> list[str]:
    """The modules of a tree's packages, by name."""
    parts = [path.relative_to(folder).with_suffix("").parts for path in folder.glob("*/**/*.py")]
    names = {".".join(of).removesuffix(".__init__") for of in parts if not {*of} & {*NOT_OURS_TO_IMPORT}}
    return sorted(name for name in names if (folder / name.partition(".")[0] / "__init__.py").exists())


def open_to_all(names: list[str]) -> list[str]:
    """Those that can be imported, tried in a child: one that fails half-way leaves what it had imported behind."""
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
                    del sys.modules[left]  # of a package that failed after importing it: alone it cannot be had
                continue
            found.append(name)
        os.write(writer, json.dumps(found).encode())
        os._exit(0)
    os.close(writer)
    with os.fdopen(reader) as told:
        found = json.loads(told.read() or "[]")
    os.waitpid(child, 0)
    return list(found)


def ran(arguments: list[str], seconds: float, cpu: int) -> dict[str, object]:
    """pytest in a child, with a process group of its own. Status: None if it was ended after so many seconds.

    cpu: seconds of processor time, after which the system ends it with SIGXCPU.
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
        told = out.read().decode(errors="replace")[-LONGEST:]
        return {"status": status, "told": told, "cpu": used.ru_utime + used.ru_stime}


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
        print(json.dumps(ran(request["arguments"], request["seconds"], request["cpu"])), file=answers, flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
