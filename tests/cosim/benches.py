"""What test benches and their tests share: cases, one simulated run, and the same once more without a simulator."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import pytest

from periph_sim.api import make_case
from periph_sim.cosim import simulate
from periph_sim.cosim.simulate import missing
from periph_sim.outside import replay
from periph_sim.records.recording import recording
from periph_sim.scene.case.model import Case

FIRMWARE = Path(__file__).parents[2] / "firmware" / "python"
RTL = Path(__file__).with_name("rtl")
TOLD = "COSIM_TOLD"  # the folder of a run, and beside its files what a bench is told and tells


def case(firmware: str = "responder", modules: tuple[str, ...] = ("I2C-A",), **more: Any) -> Case:
    unit = {"dsp": {"firmware": str(FIRMWARE / f"{firmware}.py"), "modules": list(modules), **more.pop("dsp", {})}}
    return make_case(name="mine", **({"duration": "1 s", "unit": unit} | more))


def told() -> tuple[Path, dict[str, Any]]:
    """In the simulator: the folder of the run, and what the test says of it."""
    folder = Path(os.environ[TOLD])
    return folder, json.loads((folder / "told.json").read_text())


def run(
    folder: Path, bench: str, *sources: str, simulator: str = "icarus", toplevel: str = "bus", **settings: Any
) -> Any:
    """What the bench left in found.json. Skipped, with what is missing, where there is no simulator."""
    lack = missing(simulator) or missing_packages(bench)
    if lack:
        pytest.skip(lack)
    (folder / "told.json").write_text(json.dumps(settings))
    simulate(
        [RTL / source for source in sources or ("bus.v",)],
        toplevel,
        "tests.cosim.benches_of",
        folder=folder,
        simulator=simulator,
        tests=f"^{bench}$|\\.{bench}$",
        environment={TOLD: str(folder)},
    )
    return json.loads((folder / "found.json").read_text())


def missing_packages(bench: str) -> str:
    from importlib.util import find_spec

    for package in ("i2c", "uart"):
        if package in bench and find_spec(f"cocotbext.{package}") is None:
            return f"cocotbext-{package} is not installed; pip install -e '.[dev]'"
    return ""


def replayed(folder: Path, of: Case) -> bool:
    """Whether the run's log makes the same records without a simulator, byte for byte."""
    again = folder / "again.jsonl"
    with recording(again, of.recorded_modules) as (subscribe, ended_at):
        replay(of, folder / "outside.jsonl", subscribe=subscribe)
        ended_at(0)  # nothing in such a file depends on it
    live = (folder / "live.jsonl").read_bytes()
    return live.count(b"\n") > 200 and live == again.read_bytes()
