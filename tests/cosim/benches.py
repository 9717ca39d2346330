"""Cases of the test benches, one run of all benches in a simulator, and their replay without a simulator."""

from __future__ import annotations

import json
import os
from fractions import Fraction
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from periph_sim.api import make_case
from periph_sim.cosim import simulate
from periph_sim.cosim.simulate import missing
from periph_sim.firmware import start_sci
from periph_sim.outside import replay
from periph_sim.records.recording import recording
from periph_sim.scene.case.model import Case
from periph_sim.scene.firmware_loader import Firmware

FIRMWARE = Path(__file__).parents[2] / "firmware" / "python"
RTL = [
    *sorted(Path(__file__).with_name("rtl").glob("*.v")),
    Path(__file__).parents[2] / "timing" / "rtl" / "i2c_master.v",
]
RUN_FOLDER = "COSIM_RUN_FOLDER"  # the folder of a run, with the settings in run.json and a folder for each bench


def case(firmware: str = "responder", modules: tuple[str, ...] = ("I2C-A",), settings: Any = None, **more: Any) -> Case:
    unit = {"firmware": str(FIRMWARE / f"{firmware}.py"), "modules": list(modules), "settings": settings or {}}
    return make_case(**({"name": "mine", "duration": "1 s", "unit": {"dsp": unit}} | more))


def head(address: int, duration: str) -> Case:
    """Return a case with the sensor head's firmware, which reads one chip at this address."""
    return case("sensor_head", ("I2C-A", "TIMER0"), {"order": [address], "period": "2 ms"}, duration=duration)


TABLE = {"0x68": "11 12 13 14 15 16", "0x53": "21 22 23 24 25 26", "0x1E": "31 32 33 34 35 36"}
MODULES = ("I2C-A", "SCI-A", "GPIO")
CASES = {
    "foreign_master": case(),
    "foreign_master_400k": case(),
    "three_chips_and_a_host": case(
        "imu_hil", MODULES, {"table": TABLE}, host={"period": "3 ms", "jitter": "0.5 ms"}, seed=1
    ),
    "frames_of_a_foreign_uart": case("imu_hil", MODULES),
    "registers": case("register_slave"),
    "registers_400k": case("register_slave"),
    "zero_hold_at_16_mhz": case("register_slave", settings={"registers": "5A A5 00 FF 81 7E"}),
    "foreign_memory": head(0x53, "12 ms"),
    "slave_in_logic": head(0x68, "5 ms"),
    "masters_in_logic": case("responder", settings={"replies": ["01 02 03 04", "05 06 07 08"]}),
    "serial_line": case("uart_logger", ("SCI-A",), duration="8 ms"),
}


def echo() -> Firmware:
    """Return firmware that answers each character with the next one."""

    def main(dsp: Any, settings: Any) -> None:
        sci = start_sci(dsp, "SCI-A", 40, 7, fifo=False)  # 37.5 MHz / (8 * 41): 114329 baud
        while True:
            dsp.spin(lambda: sci.SCIRXST.RXRDY == 1)
            word = sci.SCIRXBUF.RXDT
            dsp.spin(lambda: sci.SCICTL2.TXRDY == 1)
            sci.SCITXBUF.all = word + 1 & 0xFF

    return Firmware("echo", main, None)


PROGRAMS = {"serial_line": echo}


def run_settings() -> tuple[Path, dict[str, Any]]:
    """Return the folder of the run and its settings; for use within the simulator."""
    folder = Path(os.environ[RUN_FOLDER])
    return folder, json.loads((folder / "run.json").read_text())


def run_benches(folder: Path, rounds: int, phases: int, simulator: str = "icarus", **more: Any) -> None:
    """Run all benches in one simulation. The test is skipped, with what is missing, if there is no simulator.

    rounds: of each bench.
    phases: of the host's frames, one in each round of a bench with a host.
    """
    lack = missing(simulator)
    for package in ("i2c", "uart"):
        if not lack and (find_spec("cocotbext") is None or find_spec(f"cocotbext.{package}") is None):
            lack = f"cocotbext-{package} is not installed; pip install -e '.[dev]'"
    if lack:
        pytest.skip(lack)
    (folder / "run.json").write_text(json.dumps({"rounds": rounds, "phases": phases, "simulator": simulator}))
    simulate(
        RTL,
        "bus",
        "tests.cosim.benches_of",
        folder=folder,
        simulator=simulator,
        environment={RUN_FOLDER: str(folder)},
        build_args=["-Wno-fatal"] if simulator == "verilator" else [],
        **more,
    )


def found(folder: Path, bench: str) -> dict[str, Any]:
    """Return the findings of a bench."""
    return json.loads((folder / bench / "found.json").read_text())


def replayed(folder: Path, bench: str) -> bool:
    """True if the replay of the bench's log without a simulator gives the same recording, byte for byte."""
    again = folder / bench / "again.jsonl"
    begin = Fraction(found(folder, bench)["begin_ps"], 10**12)
    of = CASES[bench].model_copy(update={"start": begin})
    programs = {"dsp": PROGRAMS[bench]()} if bench in PROGRAMS else None
    with recording(again, of.recorded_modules) as (subscribe, ended_at):
        replay(of, folder / bench / "outside.jsonl", subscribe=subscribe, programs=programs)
        ended_at(0, {})  # nothing in this recording depends on it
    live = (folder / bench / "live.jsonl").read_bytes()
    return live.count(b"\n") > 200 and live == again.read_bytes()
