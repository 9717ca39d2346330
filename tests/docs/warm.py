"""A `periph-sim` for shells that run the commands of pages, without a new import for each: a folder for their PATH.

    shell --> CLIENT, called periph-sim --arguments, folder, environment, files 0 to 2--> server --fork--> periph-sim
          <-- exit status --                                                            <--          <--

Importing takes longer than most of these commands. The server has imported all commands and executed none, so a fork
of it is equivalent to a newly started process.
"""

from __future__ import annotations

import importlib
import os
import select
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
from ast import literal_eval
from functools import cache
from pathlib import Path

MOST = 100_000  # bytes of arguments and environment

# Without site packages, because finding them takes longer than the client's work.
CLIENT = """\
#!{python} -IS
import os, sys
from socket import AF_UNIX, SOCK_SEQPACKET, send_fds, socket
with socket(AF_UNIX, SOCK_SEQPACKET) as line:
    line.connect({address!r})
    send_fds(line, [repr((sys.argv, os.getcwd(), dict(os.environ))).encode()], [0, 1, 2])
    status = line.recv(16)
sys.exit(int(status) if status else "periph-sim: the server that tests run commands by has ended")
"""

# Modules that most commands import only when they need them.
USED = (
    "periph_sim.interfaces.reports.explain.explain",
    "periph_sim.interfaces.reports.explain.chain",
    "numpy.ma",
    "numpy.random",
    "rich.text",
)

_running: list[subprocess.Popen[str]] = []  # a deleted Popen would close its pipes


@cache
def folder_of_commands(path: str, root: Path) -> str:
    """Return a folder whose `periph-sim` runs the package in `root`. It exists as long as this process.

    `path` is the PATH of the server; a command has the environment in which it is called.
    """
    server = subprocess.Popen(
        [sys.executable, "-P", __file__],
        env={"PATH": path, "PYTHONPATH": str(root), "LC_ALL": "C.UTF-8"},
        stdin=subprocess.PIPE,  # is closed at the end of this process, which ends the server
        stdout=subprocess.PIPE,
        text=True,
    )
    _running.append(server)
    assert server.stdout is not None
    return server.stdout.readline().strip()


def main() -> None:
    os.environ["OPENBLAS_NUM_THREADS"] = "1"  # as periph-sim sets it before its imports
    from periph_sim import cli

    for package in cli.PACKAGES:
        for file in sorted(cli.ROOT.joinpath(*package.split(".")).glob("[!_]*.py")):
            importlib.import_module(f"periph_sim.{package}.{file.stem}")
    for module in USED:
        importlib.import_module(module)
    folder = Path(tempfile.mkdtemp())
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as server:
        _listen(server, folder)
        print(folder, flush=True)
        signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # the children that wait for a command are not waited for
        while sys.stdin not in select.select([server, sys.stdin], [], [])[0]:
            line, _ = server.accept()
            with line:
                if not os.fork() and _is_command(line):
                    server.close()
                    cli.run_command()
    shutil.rmtree(folder)


def _listen(server: socket.socket, folder: Path) -> None:
    address = str(folder / "server")
    server.bind(address)
    server.listen()
    command = folder / "periph-sim"
    command.write_text(CLIENT.format(python=sys.executable, address=address), encoding="utf-8")
    command.chmod(0o755)


def _is_command(line: socket.socket) -> bool:
    """Fork again. Return True in the child, set up for its client; the parent sends the child's status and ends."""
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    child = os.fork()
    if child:
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        line.send(str(status if status >= 0 else 128 - status).encode())
        os._exit(0)
    asked, files, _, _ = socket.recv_fds(line, MOST, 3)
    sys.argv, folder, environment = literal_eval(asked.decode())
    for number, file in enumerate(files):
        os.dup2(file, number)
        os.close(file)
    sys.path.insert(0, str(Path(sys.executable).parent))  # the folder of the installed command
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    return True


if __name__ == "__main__":
    main()
