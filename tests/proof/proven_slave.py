"""A case with a saved proof: the register slave in machine code, in a folder of its own.

wrong bytes   proven
reaction      proven
round         its p99 describes a whole run
slack         depends on the start of the next round
load          a share of a whole run
"""

from __future__ import annotations

from pathlib import Path

from periph_sim.proof.dependencies import dependencies
from periph_sim.proof.proof_file import ProofFile, proof_of
from periph_sim.proof.saved_file import text_of
from periph_sim.proof.saved_paths import proof_path
from periph_sim.proof.stretch import Job
from periph_sim.proof.table_proof import prove
from tests.scene.runs import TIMING

FIRMWARE = "register_slave.asm"
PROVEN = ("wrong bytes", "reaction")
BUDGETS = """
[[budget]]
name = "reaction"
measure = "reaction"
max = "1 us"
coverage = "40 %"

[[budget]]
name = "round"
measure = "round"
p99 = "2.9 ms"
max = "3 ms"

[[budget]]
name = "slack"
measure = "slack"
min = "3 ms"

[[budget]]
name = "load"
measure = "cpu load"
max = "90 %"
"""


def write_slave(folder: Path, budgets: str = BUDGETS) -> Path:
    """Write the case and its firmware, and return the path of the case. budgets: its budgets beside "wrong bytes"."""
    source = TIMING.parent / "firmware" / "c28x"
    for name in (FIRMWARE, "f28335.inc", "start.inc"):
        (folder / name).write_bytes((source / name).read_bytes())
    text = (TIMING / "variants" / "image_register_slave.toml").read_text(encoding="utf-8")
    text = text.replace(f"../../firmware/c28x/{FIRMWARE}", FIRMWARE).replace('duration = "9 ms"', 'duration = "29 ms"')
    case = folder / "slave.toml"
    case.write_text(text + budgets, encoding="utf-8")
    return case


def save_proof(case: Path) -> ProofFile:
    """Make the table of a case, save its proof, and return the contents of the file."""
    made = prove(Job(str(case)))
    proof = proof_of(made, dependencies(case.parent, made.covered.case.files()))
    proof_path(case).parent.mkdir(exist_ok=True)
    proof_path(case).write_text(text_of(proof), encoding="utf-8")
    return proof
