"""Run a command of periph-sim without the modules and functions of POSIX that Windows lacks.

python -m tests.platforms.without_posix run timing/imu_hil.toml
python -m tests.platforms.without_posix imports      imports every module of the package that Windows can import

The standard library is imported first, because its modules for POSIX need what is removed here. Worker processes are
started by spawn, the only method of Windows; they import this module, so the same is removed in them.
"""

from __future__ import annotations

import asyncio
import concurrent.futures.process
import importlib
import multiprocessing
import multiprocessing.forkserver
import multiprocessing.popen_spawn_posix
import os
import pdb
import pkgutil
import select
import signal
import socket
import subprocess
import sys
import tempfile
from importlib.util import find_spec

if find_spec("serial") is not None:
    import serial.tools.miniterm  # noqa: F401  # on Windows, pyserial has modules without fcntl and termios

MODULES = ("fcntl", "grp", "pty", "pwd", "readline", "resource", "syslog", "termios", "tty")
NAMES = {
    asyncio: ("create_unix_server",),
    os: (
        *("fork", "forkpty", "getuid", "geteuid", "getgid", "killpg", "setsid", "getpgid", "setpgid", "mkfifo"),
        *("openpty", "ttyname", "chown", "sched_getaffinity", "pread", "pwrite", "sysconf", "nice", "wait4"),
        *("WNOHANG", "O_NONBLOCK", "O_CLOEXEC", "O_DIRECTORY", "O_NOFOLLOW", "O_NOCTTY", "posix_spawn", "getloadavg"),
    ),
    select: ("poll", "epoll"),
    signal: (
        *("SIGALRM", "SIGCHLD", "SIGCONT", "SIGHUP", "SIGPIPE", "SIGQUIT", "SIGSTOP", "SIGTSTP", "SIGUSR1"),
        *("SIGUSR2", "SIGWINCH", "alarm", "pause", "pthread_kill", "setitimer", "sigwait"),
    ),
    socket: ("AF_UNIX",),
}
PRIMED = (concurrent.futures.process, multiprocessing, multiprocessing.forkserver, pdb, subprocess, tempfile)


def remove() -> None:
    """Remove the modules and functions from this process."""
    for name in MODULES:
        sys.modules[name] = None  # type: ignore[assignment]  # `import` raises ModuleNotFoundError
    for module, names in NAMES.items():
        for name in names:
            if hasattr(module, name):
                delattr(module, name)
    multiprocessing.get_all_start_methods = lambda: ["spawn"]  # type: ignore[method-assign]


def import_all() -> list[str]:
    """Import every module of the package. Return those that could not be imported, each with the reason."""
    import periph_sim

    failed = []
    for found in pkgutil.walk_packages(periph_sim.__path__, "periph_sim."):
        try:
            importlib.import_module(found.name)
        except Exception as error:
            failed.append(f"{found.name}: {error}")
    return failed


remove()

if __name__ == "__main__":
    if sys.argv[1] == "imports":
        print("\n".join(import_all()))
    else:
        from periph_sim.__main__ import main

        main()
