"""Write recordings of runs as an analyser saves them to traces/i2c_*: `python -m tests.captures.make_captures`.

    case --run--> edges of SCL and SDA --sampled at another rate, a stretch cut out--> traces/i2c_*

They have features that drawn waves lack: edges of both lines in one sample, a beginning and an end within a transfer, a
slave that does not acknowledge while it writes, one that stretches SCL, time stamps instead of samples. The decode by
sigrok-cli is written to a file beside each capture.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from fractions import Fraction
from pathlib import Path

from periph_sim.scene.case.load import load
from periph_sim.scene.scene import Scene
from periph_sim.traces import formats
from periph_sim.traces.capture.capture import Capture, Span, with_channels, within
from periph_sim.traces.capture.sampling import resampled
from tests.replay.make_session import samples
from tests.replay.slow import slow_case
from tests.scene.runs import Edges
from tests.traces.formats.writers import sr_bytes

FOLDER = Path(__file__).resolve().parents[2] / "traces"
LINES = ("SCL", "SDA")
STAMPS = {"i2c_slow_slave": 125_000_000}  # the sampling rate of files that only have times

# The decoders of each capture with their options. The head of a decode has the versions and the command.
DECODERS = {
    "imu_round": ["i2c:scl=SCL:sda=SDA"],
    "nack": ["i2c:scl=SCL:sda=SDA"],
    "host_frames": ["uart:rx=RX:baudrate=115200"],
    "imu_session": ["i2c:scl=SCL:sda=SDA", "uart:rx=RX:baudrate=115200"],
    "i2c_eeprom_busy": ["i2c:scl=SCL:sda=SDA"],
    "i2c_slow_slave": ["i2c:scl=SCL:sda=SDA"],
    "uart_7e1_break": ["uart:rx=RX:baudrate=19200:data_bits=7:parity=even"],
    "uart_glitch_4f": ["uart:rx=RX:baudrate=115200"],
}
OF_I2C = "i2c=addr-data:warnings"
OF_UART = "uart=" + ":".join(
    f"rx-{what}" for what in ("start", "data", "parity-ok", "parity-err", "stop", "warnings", "break")
)

EEPROM = """
name = "eeprom"
duration = "2 ms"

[unit.master]
firmware = "captured_master"
modules = ["I2C-A"]

[unit.master.settings]
low = 8
high = 7
script = ["50 W 00 11 22", "50 W", "50 W", "50 W", "50 W", "50 W 00 Sr 50 R 4", "50 R 8"]
pauses = ["100 us", "60 us", "60 us", "60 us", "60 us", "60 us", "40 us"]

[unit.slave]
firmware = "responder"
modules = ["I2C-A"]
ppm = 40

[unit.slave.settings]
replies = ["11 22 33 44", "01 02 03 04 05 06 07 08"]
busy = ["330 us"]
"""

CONTROLLER = """
[controller]
rate = "100 kHz"
first = "1 ms"
period = "1 ms"
check = "expect"

[[controller.request]]
name = "one byte"
address = 0x50
count = 1
expect = "a7"
"""


def recorded(case: Path, *changes: str) -> Capture:
    """Return SCL and SDA of a whole run."""
    edges = Edges()
    scene = Scene(load(case, list(changes)), edges.subscribe)
    scene.run(scene.case.duration)
    return with_channels(edges.capture(scene.kernel.now + 1), LINES)


def eeprom_busy() -> None:
    """Write a capture of 400 kHz at 2 MHz that begins and ends within a transfer.

    A memory is written, polled five times while it is busy, and read.
    """
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "eeprom.toml").write_text(EEPROM)
        capture = resampled(recorded(Path(folder) / "eeprom.toml"), Fraction(2_000_000))
    first, last = (int(capture.channel("SCL").edges[n]) for n in (20, -60))
    capture = within(capture, Span(first, last))
    (FOLDER / "i2c_eeprom_busy.sr").write_bytes(sr_bytes(list(LINES), "2 MHz", samples(capture)))


def slow_slave() -> None:
    """Write a capture with times only: 100 kHz, recorded at 125 MHz, with a slave that holds SCL while it computes."""
    with tempfile.TemporaryDirectory() as folder:
        case = slow_case(Path(folder), more=CONTROLLER)
        capture = recorded(case, "duration='3.9 ms'", "unit.dsp.settings.wait=83")
    formats.write(capture, FOLDER / "i2c_slow_slave.csv", rate=Fraction(STAMPS["i2c_slow_slave"]))


def decode(name: str) -> None:
    """Write the decodes of a capture by sigrok-cli to the files beside it."""
    source = next(path for path in FOLDER.iterdir() if path.stem == name and path.suffix in (".sr", ".csv"))
    tool = " ".join(_output("--version").splitlines()[0].split())
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / f"{name}.sr"
        rate = STAMPS.get(name)
        formats.write(formats.read(source, None if rate is None else Fraction(rate)), file)
        for decoder in DECODERS[name]:
            kind = decoder.partition(":")[0]
            options = ["-P", decoder, "-A", OF_I2C if kind == "i2c" else OF_UART, "--protocol-decoder-samplenum"]
            command = f"sigrok-cli -i {name}.sr {' '.join(options)}"
            head = f"# oracle: {tool}\n# command: {command}\n# first-last sample, decoder: annotation\n"
            (FOLDER / f"{name}.{kind}.txt").write_text(head + _output("-i", str(file), *options))


def _output(*arguments: str) -> str:
    return subprocess.run(["sigrok-cli", *arguments], capture_output=True, text=True, check=True).stdout


if __name__ == "__main__":
    if "--decodes" not in sys.argv:
        eeprom_busy()
        slow_slave()
    for name in DECODERS:
        decode(name)
