"""What a case costs in a simulator beside a memory of cocotbext-i2c, with the same master in the same harness.

    python -m tests.cosim.cost [--rounds 200] [--times 5] [--simulator icarus]

Each party is run in turn, in a process of its own, as often as asked; CPU time is of that process, from the first round
to the last. A round reads six bytes behind a pointer from three addresses.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from pathlib import Path
from statistics import median

from periph_sim.scene.case.model import Case
from tests.cosim.benches import RTL, TABLE, TOLD, case

CHIPS = (0x68, 0x53, 0x1E)
ROUND = ["11 12 13 14 15 16", "21 22 23 24 25 26", "31 32 33 34 35 36"]  # as TABLE has them
BYTES = 3 * 9  # of a round: address, pointer, address, six of data
HOST = {"host": {}, "seed": 1}


def cases() -> dict[str, Case]:
    """The parties but for the memory. register_slave has one address, and the same bytes behind each."""
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
    """CPU seconds of one run, wake-ups of the simulator by our timer."""
    from periph_sim.cosim import simulate

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "told.json").write_text(json.dumps({"party": party, "rounds": rounds}))
        environment = {TOLD: name, "COCOTB_LOG_LEVEL": "WARNING"}
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
    """Median of the times of each party, in microseconds a byte, against that of the memory."""
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
