"""`periph-sim serve`: a case as a serial port of this computer, up to its final verdict."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest

from periph_sim.interfaces.commands.serve import _slower
from tests.interfaces.commands.conftest import Run
from tests.outside.live import registers
from tests.outside.live.echo import written

serial = pytest.importorskip("serial", reason="pyserial is not installed: the extra live has it")


Serve = Callable[..., subprocess.Popen[str]]


@pytest.fixture
def serve() -> Iterator[Serve]:
    """A function that starts `periph-sim serve` in another process.

    A process that still runs after the test is killed. A failed test would leave it running, and it would read from
    pseudo-terminals of later tests that get the same name.
    """
    started: list[subprocess.Popen[str]] = []

    def start(*arguments: str) -> subprocess.Popen[str]:
        command = [sys.executable, "-m", "periph_sim", "serve", *arguments]
        started.append(subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True))
        return started[-1]

    yield start
    for process in started:
        process.kill()
        process.communicate()


@pytest.mark.posix("pseudo-terminals")
def test_a_script_uses_the_port_until_ctrl_c(tmp_path: Path, serve: Serve) -> None:
    link, log = tmp_path / "dsp", tmp_path / "live.jsonl"
    served = serve(str(written(tmp_path)), "--pty", str(link), "--log", str(log), "--warm-up", "5 ms")
    assert served.stdout is not None
    assert served.stdout.readline().startswith("/dev/")
    for data, answer in ((b"hello", b"ifmmp"), (b"abc", b"bcd")):
        with serial.Serial(str(link), 115_200, timeout=30) as port:
            port.write(data)
            assert port.read(len(data)) == answer
    served.send_signal(signal.SIGINT)
    message, mistakes = served.communicate(timeout=60)
    assert served.returncode == 0, mistakes
    assert "echo: NOT JUDGED" in message and "8 SCI bytes" in message and "lateness: 99 % of " in message
    assert not link.is_symlink()
    end = json.loads(log.read_text().splitlines()[-1])
    assert end["end"] > 0


@pytest.mark.posix("pseudo-terminals")
def test_a_real_port_is_served_like_a_pseudo_terminal(tmp_path: Path, serve: Serve) -> None:
    ours, port = os.openpty()  # in place of a cable to another computer
    served = serve(str(written(tmp_path)), "--port", os.ttyname(port), "--json")
    assert served.stderr is not None
    assert served.stderr.readline().strip() == os.ttyname(port)
    time.sleep(0.1)
    os.write(ours, b"hello")
    got = b""
    while len(got) < 5:
        got += os.read(ours, 100)
    assert got == b"ifmmp"
    served.send_signal(signal.SIGINT)
    message, _ = served.communicate(timeout=60)
    report = json.loads(message)
    assert report["verdict"] == "not judged" and set(report["lateness"]) == {"worst_s", "p99_s", "late", "slips"}


@pytest.mark.posix("pseudo-terminals")
def test_an_unmodified_i2cdriver_program_reads_the_bus(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, serve: Serve
) -> None:
    i2cdriver = pytest.importorskip("i2cdriver", reason="i2cdriver is not installed: the extra drivers has it")
    opened = i2cdriver.serial.Serial
    monkeypatch.setattr(i2cdriver.serial, "Serial", lambda port, baud, timeout: opened(port, baud, timeout=120))
    link = tmp_path / "i2c"
    served = serve(str(registers.written(tmp_path)), "--i2cdriver", str(link), "--json")
    assert served.stderr is not None
    assert served.stderr.readline() == "SDA and SCL are driven from outside, in place of [controller]\n"
    assert served.stderr.readline().startswith("/dev/")
    driver = i2cdriver.I2CDriver(str(link))
    assert driver.scan(silent=True) == [0x50]
    assert driver.regwr(0x50, 4, [1, 2]) and driver.regrd(0x50, 2, 4) == b"\x33\x44\x01\x02"
    driver.ser.close()
    served.send_signal(signal.SIGINT)
    message, mistakes = served.communicate(timeout=60)
    report = json.loads(message)
    assert served.returncode == 1 and not link.is_symlink(), mistakes
    assert report["verdict"] == "fail" and report["wire_bytes"] >= 112 + 4 + 7
    verdicts = [(one["name"], one["verdict"]) for one in report["budgets"]]
    assert verdicts == [("all rounds", "fail"), ("work", "pass")]  # the program does not start a round each ms


@pytest.mark.parametrize(
    ("more", "status", "sentence"),
    [
        ((), 2, "give one of --pty, --rfc2217, --port and --i2cdriver as the place of the port"),
        (
            ("--i2cdriver", "--sci", "scia", "--frame", "8e1"),
            2,
            "--sci and --frame: for serial ports only; --i2cdriver",
        ),
        (("--pty", "{taken}", "--port", "/dev/ttyS0"), 2, "give one of --pty, --rfc2217, --port"),
        (("--i2cdriver",), 2, "there is no wire 'SDA'"),
        (("--rfc2217", "localhost"), 2, "--rfc2217 'localhost': expected a port up to 65535, or ADDRESS:PORT"),
        (("--port", "/dev/none"), 2, "/dev/none"),
        (("--pty", "{taken}"), 2, "File exists; give the link another name"),
        (("--pty", "--pace", "fast"), 2, "--pace 'fast': expected a number, as in 1 or 0.5"),
        (("--pty", "--for", "10 parsec"), 2, "--for: '10 parsec'"),
        (("--pty", "--sci", "scib"), 2, "there is no SCI 'SCI-B'; it has dsp.SCI-A"),
        (("--pty", "--frame", "9n1"), 2, "format '9n1': expected data bits 5 to 8"),
        (("--pty", "--view"), 2, "--view needs a terminal; --browser shows the same on a page"),
        (("--pty", "--browser", "all"), 2, "--browser 'all': expected a port up to 65535, or ADDRESS:PORT"),
        (("--rfc2217", "0", "--browser", "--pace", "0", "--for", "10 ms"), 0, ""),
    ],
)
def test_wrong_options_are_one_error_message(
    more: tuple[str, ...], status: int, sentence: str, tmp_path: Path, periph_sim: Run
) -> None:
    taken = tmp_path / "taken"
    taken.touch()
    outcome = periph_sim("serve", str(written(tmp_path)), *(part.format(taken=taken) for part in more))
    assert outcome.status == status, outcome.err
    assert sentence in outcome.err.replace("\n", " ") and "Traceback" not in outcome.err


@pytest.mark.posix("pseudo-terminals")
def test_the_host_of_a_case_is_replaced_and_its_budgets_are_omitted(serve: Serve) -> None:
    case = Path(__file__).parents[3] / "timing" / "imu_hil.toml"
    message, mistakes = serve(str(case), "--pty", "--pace", "0", "--for", "30 ms").communicate(timeout=60)
    replaced = "RX is driven from outside, in place of [host]; left out, since nothing else can judge them:"
    assert f"{replaced} 'wrong bytes', 'data age'" in mistakes
    assert replaced in message.replace("\n", " ") and " wrong bytes  " not in message


def test_the_reason_for_slow_simulated_time_is_printed() -> None:
    result = SimpleNamespace(wall_s=3.0, simulated_s=1.5)
    case = SimpleNamespace(unit={"dsp": SimpleNamespace(image=None)})
    message = "a simulated second takes 2.0 s of this computer's time"
    assert _slower(case, result) == f"{message}; it keeps --pace 0.4"
    case.unit["dsp"].image = "firmware.out"
    why = "dsp runs an image, instruction by instruction, its polls included"
    assert _slower(case, result) == f"{message}: {why}; it keeps --pace 0.4"
