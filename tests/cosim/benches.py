"""What test benches and their tests share: cases, one run of all benches, and each once more without a simulator."""

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
TOLD = "COSIM_TOLD"  # the folder of a run: told.json says how many rounds, each bench has a folder there


def case(firmware: str = "responder", modules: tuple[str, ...] = ("I2C-A",), settings: Any = None, **more: Any) -> Case:
    unit = {"firmware": str(FIRMWARE / f"{firmware}.py"), "modules": list(modules), "settings": settings or {}}
    return make_case(**({"name": "mine", "duration": "1 s", "unit": {"dsp": unit}} | more))


def head(address: int, duration: str) -> Case:
    """The sensor head's firmware, with one chip at this address."""
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
    """Each character comes back plus one."""

    def main(dsp: Any, settings: Any) -> None:
        sci = start_sci(dsp, "SCI-A", 40, 7, fifo=False)  # 37.5 MHz / (8 * 41): 114329 baud
        while True:
            dsp.spin(lambda: sci.SCIRXST.RXRDY == 1)
            word = sci.SCIRXBUF.RXDT
            dsp.spin(lambda: sci.SCICTL2.TXRDY == 1)
            sci.SCITXBUF.all = word + 1 & 0xFF

    return Firmware("echo", main, None)


PROGRAMS = {"serial_line": echo}


def told() -> tuple[Path, dict[str, Any]]:
    """In the simulator: the folder of the run, and what the test says of it."""
    folder = Path(os.environ[TOLD])
    return folder, json.loads((folder / "told.json").read_text())


def run_benches(folder: Path, rounds: int, phases: int, simulator: str = "icarus", **more: Any) -> None:
    """All benches in one simulation. phases: of a host's frames, in a round each.

    Skipped, with what is missing, where there is no simulator.
    """
    lack = missing(simulator)
    for package in ("i2c", "uart"):
        if not lack and (find_spec("cocotbext") is None or find_spec(f"cocotbext.{package}") is None):
            lack = f"cocotbext-{package} is not installed; pip install -e '.[dev]'"
    if lack:
        pytest.skip(lack)
    (folder / "told.json").write_text(json.dumps({"rounds": rounds, "phases": phases, "simulator": simulator}))
    simulate(
        RTL,
        "bus",
        "tests.cosim.benches_of",
        folder=folder,
        simulator=simulator,
        environment={TOLD: str(folder)},
        build_args=["-Wno-fatal"] if simulator == "verilator" else [],
        **more,
    )


def found(folder: Path, bench: str) -> dict[str, Any]:
    """The findings of a bench."""
    return json.loads((folder / bench / "found.json").read_text())


def replayed(folder: Path, bench: str) -> bool:
    """Whether the bench's log makes the same records without a simulator, byte for byte."""
    again = folder / bench / "again.jsonl"
    begin = Fraction(found(folder, bench)["begin_ps"], 10**12)
    of = CASES[bench].model_copy(update={"start": begin})
    programs = {"dsp": PROGRAMS[bench]()} if bench in PROGRAMS else None
    with recording(again, of.recorded_modules) as (subscribe, ended_at):
        replay(of, folder / bench / "outside.jsonl", subscribe=subscribe, programs=programs)
        ended_at(0, {})  # nothing in such a file depends on it
    live = (folder / bench / "live.jsonl").read_bytes()
    return live.count(b"\n") > 200 and live == again.read_bytes()
