"""Commands whose process is ended by user code: status 0 requires the whole output, and nothing is left behind.

shell --signal, exit status--> waiting process --> worker that runs firmware
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import partial
from pathlib import Path
from subprocess import PIPE, Popen

import pytest

CASE = """\
name = "short"
duration = "1 ms"

[unit.dsp]
firmware = "short.py"
modules = ["I2C-A"]

[[budget]]
name = "load"
measure = "cpu load"
max = "100 %"
"""
LOST = b"exit status 3 is no verdict\n"
BEFORE = b"before its output was complete"
COMMAND = (sys.executable, "-m", "periph_sim")


def case_of(folder: Path, code: str) -> Path:
    """Write a case whose firmware executes `code` in main."""
    text = f"import atexit, ctypes, os, signal, sys, threading, time\ndef main(dsp, settings):\n    {code}\n"
    (folder / "short.py").write_text(text, encoding="utf-8")
    path = folder / "short.toml"
    path.write_text(CASE, encoding="utf-8")
    return path


def run(case: Path) -> tuple[int, bytes, bytes]:
    result = subprocess.run([*COMMAND, "run", case], capture_output=True, timeout=60)
    return result.returncode, result.stdout, result.stderr


@pytest.mark.parametrize(
    "code",
    [
        "os._exit(0)",
        "os._exit(1)",
        "os.execv(sys.executable, [sys.executable, '-c', ''])",
        "threading.Timer(0, os._exit, (0,)).start(); time.sleep(60)",
        "os.closerange(3, 100)",
    ],
    ids=["_exit", "_exit with a status", "execv", "a thread", "closed descriptors"],
)
def test_a_process_that_ends_before_its_verdict_has_status_3(tmp_path: Path, code: str):
    status, _, err = run(case_of(tmp_path, code))
    assert status == 3 and err.endswith(LOST) and BEFORE in err


@pytest.mark.parametrize("code", ["os._exit(0)", "os.kill(os.getpid(), signal.SIGKILL)"])
def test_a_process_that_ends_before_its_verdict_leaves_no_temporary_files(tmp_path: Path, code: str):
    case = case_of(tmp_path, f"os.chdir('/'); {code}")
    outputs = ("--record", "run.psr", "--html", "page.html")
    result = subprocess.run([*COMMAND, "run", case.name, *outputs], capture_output=True, timeout=60, cwd=tmp_path)
    assert result.returncode in (3, -signal.SIGKILL) and BEFORE in result.stderr
    assert {path.name for path in tmp_path.iterdir()} == {"short.py", "short.toml"}


@pytest.mark.parametrize(
    ("code", "number"),
    [("os.kill(os.getpid(), signal.SIGKILL)", signal.SIGKILL), ("ctypes.CDLL(None).abort()", signal.SIGABRT)],
    ids=["kill", "abort in C"],
)
def test_the_caller_receives_the_signal_that_ended_the_process(tmp_path: Path, code: str, number: int):
    status, out, err = run(case_of(tmp_path, code))
    assert (status, out) == (-number, b"") and BEFORE in err


@pytest.mark.parametrize(
    ("code", "status"),
    [
        ("os.dup2(os.open(os.devnull, os.O_WRONLY), 1)", 3),
        ("os.close(1)", 2),
        ("sys.__stdout__.close()", 2),
    ],
    ids=["dup2", "close", "sys.stdout"],
)
def test_lost_standard_output_is_no_pass(tmp_path: Path, code: str, status: int):
    result = run(case_of(tmp_path, code))
    assert result[:2] == (status, b"") and b"standard output" in result[2] and result[2].count(b"\n") == 1


def test_a_command_that_is_started_without_standard_output_is_no_pass(tmp_path: Path):
    result = subprocess.run([*COMMAND, "run", case_of(tmp_path, "pass")], stderr=PIPE, preexec_fn=lambda: os.close(1))
    assert result.returncode == 2 and result.stderr.startswith(b"Error: standard output is closed")


@pytest.mark.parametrize("errors", [None, "/dev/full"], ids=["closed", "full"])
def test_a_verdict_does_not_depend_on_standard_error(tmp_path: Path, errors: str | None):
    def close() -> None:
        if errors is None:
            os.close(2)
        else:
            os.dup2(os.open(errors, os.O_WRONLY), 2)

    code = "print('hello', file=sys.stderr)\n    try: os.write(2, b'hello')\n    except OSError: pass"
    result = subprocess.run([*COMMAND, "run", case_of(tmp_path, code)], stdout=PIPE, preexec_fn=close)
    assert result.returncode == 0 and result.stdout.startswith(b"short: PASS") and b"hello" not in result.stdout


def test_the_launcher_of_an_older_installation_has_a_waiting_process(tmp_path: Path):
    """It calls `periph_sim.cli.main`, as former entry points did."""
    code = "import sys; from periph_sim.cli import main; sys.exit(main())"
    result = subprocess.run([sys.executable, "-c", code, "run", case_of(tmp_path, "os._exit(0)")], capture_output=True)
    assert result.returncode == 3 and result.stderr.endswith(LOST)


def test_a_thread_that_still_runs_ends_with_the_command(tmp_path: Path):
    status, out, err = run(case_of(tmp_path, "threading.Thread(target=time.sleep, args=(600,), name='idle').start()"))
    assert status == 0 and out.startswith(b"short: PASS") and b"ended thread 'idle'" in err


@pytest.mark.parametrize(("exits_with", "status"), [(0, 0), (5, 3)])
def test_an_exit_status_that_contradicts_the_verdict_is_no_verdict(tmp_path: Path, exits_with: int, status: int):
    result, out, err = run(case_of(tmp_path, f"atexit.register(os._exit, {exits_with})"))
    assert result == status and out.startswith(b"short: PASS") and err.endswith(LOST) == (status == 3)


def test_a_fork_that_writes_the_verdict_twice_is_no_pass(tmp_path: Path):
    status, out, _ = run(case_of(tmp_path, "os.waitpid(child, 0) if (child := os.fork()) else None"))
    assert status == 3 and out.count(b"short: PASS") == 2


# Signals -----------------------------------------------------------------------------------

SLOW = 'open(f"began{settings.number}", "w").close(); time.sleep(600 if settings.number else 0)'


@pytest.fixture
def slow(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A case whose run takes ten minutes, except with number = 0."""
    monkeypatch.chdir(tmp_path)
    case = case_of(tmp_path, SLOW)
    settings = "from dataclasses import dataclass\n@dataclass\nclass Settings:\n    number: int = 1\n"
    firmware = tmp_path / "short.py"
    firmware.write_text(settings + firmware.read_text("utf-8"), encoding="utf-8")
    return case


def wait_until_begun(process: Popen[bytes], name: str) -> None:
    """Wait until the firmware has begun."""
    while not Path(name).exists():
        assert process.poll() is None
        time.sleep(0.01)


def descendants(pid: int) -> Iterator[int]:
    """Yield the descendants of a process, without those of threads that end meanwhile."""
    children: list[int] = []
    with suppress(FileNotFoundError, ProcessLookupError):
        for thread in Path(f"/proc/{pid}/task").iterdir():
            with suppress(FileNotFoundError, ProcessLookupError):
                children += map(int, (thread / "children").read_text().split())
    for child in children:
        yield child
        yield from descendants(child)


def runs(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


def wait_until_ended(pids: list[int]) -> None:
    """Wait until these processes have ended."""
    while any(map(runs, pids)):
        time.sleep(0.01)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
@pytest.mark.parametrize("send", [os.kill, os.killpg], ids=["one process", "both"])
def test_a_signal_stops_a_run_and_removes_its_temporary_files(
    slow: Path, number: int, send: Callable[[int, int], None]
):
    """A terminal and `timeout` send the signal to both processes, so the worker receives it twice."""
    process = Popen(
        [*COMMAND, "run", slow, "--html", "page.html"],
        stdout=PIPE,
        stderr=PIPE,
        start_new_session=True,
        preexec_fn=partial(signal.signal, number, signal.SIG_DFL),  # `nohup` and `&` of a script ignore some signals
    )
    wait_until_begun(process, "began1")
    assert any(path.name.startswith(".page") for path in Path().iterdir())
    send(process.pid, number)
    out, err = process.communicate()
    assert (process.returncode, out, err) == (2, b"", b"\nstopped\n")
    assert not any(path.name.startswith(".page") for path in Path().iterdir())


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux tells a process that its parent was killed")
@pytest.mark.parametrize(("command", "number"), [("sweep", signal.SIGKILL), ("check", signal.SIGTERM)])
def test_a_stopped_command_leaves_no_process_and_keeps_what_is_done(slow: Path, command: str, number: int):
    """After SIGKILL the waiting process can do nothing; the worker receives a signal and writes its rows."""
    rows = Path("rows")
    if command == "sweep":
        options = [slow, "--vary", "unit.dsp.settings.number=0, 1, 2", "--csv", rows]
    else:
        quick = slow.with_name("quick.toml")
        quick.write_text(slow.read_text("utf-8").replace('"short"', '"quick"') + "[unit.dsp.settings]\nnumber = 0\n")
        options = [quick, slow, "--junit", rows]
    process = Popen([*COMMAND, command, *options, "--jobs", "2"], stdout=PIPE, stderr=PIPE)
    wait_until_begun(process, "began1")
    if command == "sweep":
        wait_until_begun(process, "began2")
    processes = list(descendants(process.pid))
    assert len(processes) >= 3  # the worker, the server, and one for each run
    process.send_signal(number)
    process.communicate()
    wait_until_ended(processes)
    assert process.returncode == (2 if number == signal.SIGTERM else -number)
    done = rows.read_text("utf-8")
    if command == "sweep":
        assert [line.split(",")[:3] for line in done.splitlines()[1:]] == [["0", "0", "pass"]]
    else:
        assert 'name="quick"' in done and "the check was stopped" in done


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
@pytest.mark.parametrize(
    ("code", "status", "message"),
    [
        ("os.register_at_fork(after_in_child=interrupt); supervise(int, 'tried')", -signal.SIGINT, b""),
        ("supervise(interrupt, 'tried')", 2, b"stopped\n"),
        ("atexit.register(interrupt); supervise(int, 'tried')", 0, b""),
    ],
    ids=["before the work", "in the work", "after the work"],
)
def test_ctrl_c_outside_of_a_command_has_no_traceback(code: str, status: int, message: bytes):
    begin = (
        "import atexit, os, signal; from periph_sim.supervisor import supervise\n"
        "def interrupt(): os.kill(os.getpid(), signal.SIGINT)\n"
    )
    result = subprocess.run(
        [sys.executable, "-c", begin + code],
        capture_output=True,
        timeout=60,
        preexec_fn=partial(signal.signal, signal.SIGINT, signal.default_int_handler),
    )
    assert (result.returncode, result.stderr) == (status, message)
