"""Costs of a case in a simulator compared with a memory of cocotbext-i2c, which has the same master and harness.

    python -m tests.cosim.cost [--rounds 200] [--times 5] [--simulator icarus]

The parties run in turn, each in a process of its own, as often as requested; the CPU time of that process is measured
from the first round to the last. A round reads six bytes after a pointer from three addresses.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from pathlib import Path
from statistics import median

from periph_sim.scene.case.model import Case
from tests.cosim.benches import RTL, RUN_FOLDER, TABLE, case

CHIPS = (0x68, 0x53, 0x1E)
ROUND = ["11 12 13 14 15 16", "21 22 23 24 25 26", "31 32 33 34 35 36"]  # the data of TABLE
BYTES = 3 * 9  # in a round: address, pointer, address and six of data, for each chip
HOST = {"host": {}, "seed": 1}


def cases() -> dict[str, Case]:
    """Return the parties other than the memory. register_slave has only one address, which is read three times."""
    registers = {"address": 0x68, "registers": ROUND[0]}
    imu = {"table": TABLE}
    return {
        "imu_hil": case("imu_hil", ("I2C-A", "GPIO"), imu),
        "imu_hil and host frames": case("imu_hil", ("I2C-A", "SCI-A", "GPIO"), imu, **HOST),
        "register_slave": case("register_slave", ("I2C-A",), registers),
        "register_slave and host frames": case("register_slave", ("I2C-A", "SCI-A"), registers, **HOST),
    }


MEMORY = "memory of cocotbext-i2c"
PARTIES = (MEMORY, *cases())


def measured(party: str, rounds: int, simulator: str) -> dict[str, float]:
    """Return the CPU seconds of one run, and how often its timer woke the simulator."""
    from periph_sim.cosim import simulate

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "run.json").write_text(json.dumps({"party": party, "rounds": rounds}))
        environment = {RUN_FOLDER: name, "COCOTB_LOG_LEVEL": "WARNING"}
        simulate(
            RTL,
            "bus",
            "tests.cosim.cost_bench",
            folder=folder,
            simulator=simulator,
            environment=environment,
        )
        found: dict[str, float] = json.loads((folder / "found.json").read_text())
        return found


def table(found: dict[str, list[dict[str, float]]], rounds: int) -> str:
    """Return a table of the median times of each party in microseconds per byte, and relative to the memory."""
    memory = median(run["seconds"] for run in found[MEMORY])
    lines = []
    for party, runs in found.items():
        seconds = median(run["seconds"] for run in runs)
        wakes = runs[0]["wakes"] / rounds / BYTES
        lines.append(f"{party:32}{seconds / rounds / BYTES * 1e6:8.0f} us{seconds / memory:8.2f}{wakes:8.1f}")
    return "\n".join(["                                   a byte   times   wakes", *lines])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--rounds", type=int, default=200)
    parser.add_argument("--times", type=int, default=5)
    parser.add_argument("--simulator", default="icarus")
    parser.add_argument("--only", nargs="*", default=PARTIES, choices=PARTIES)
    asked = parser.parse_args()
    found: dict[str, list[dict[str, float]]] = {party: [] for party in asked.only}
    for _ in range(asked.times):
        for party, runs in found.items():
            runs.append(measured(party, asked.rounds, asked.simulator))
    print(table(found, asked.rounds))


if __name__ == "__main__":
    main()
