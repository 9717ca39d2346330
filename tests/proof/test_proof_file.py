"""The saved proof of a case: its contents, and the changes that end it.

table --> proofs/slave.json --> proven budgets, as long as the case, its firmware and periph_sim are as they were
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import msgspec
import pytest

from periph_sim.proof.proof_file import ProofFile
from periph_sim.proof.saved_file import BadSavedFile, text_of
from periph_sim.proof.saved_paths import proof_path
from periph_sim.proof.stretch import PERCENTILE, CoveredCase, Job
from tests.proof.proven_slave import FIRMWARE, PROVEN, save_proof, write_slave


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, ProofFile]:
    """Return a case, and the contents of its saved proof."""
    case = write_slave(tmp_path_factory.mktemp("proof"))
    return case, save_proof(case)


def test_a_budget_is_proven_if_all_its_limits_are(desk: tuple[Path, ProofFile]):
    _, proof = desk
    assert tuple(proof.proven) == PROVEN
    assert proof.not_proven == {
        "round": PERCENTILE,
        "slack": "its values depend on the start of the next round",
        "load": "it is a share of a whole run",
    }
    assert proof.line.startswith("2 of 5 budgets proven for all sequences of rounds that start at least ")


def test_the_command_that_renews_a_proof_has_its_ranges(desk: tuple[Path, ProofFile]):
    proof = desk[1]
    assert proof.command == "prove --table --save"
    wide = msgspec.structs.replace(proof, within_ppm=5.0, host_within_ppm=12.3456789, any_tick=True)
    assert wide.command == "prove --table --ppm 5 --host-ppm 12.3456789 --any-tick --save"
    assert "within 5 ppm, and all bit rates of the host within 12.3456789 ppm" in wide.line


def test_a_proof_is_read_as_it_was_written(desk: tuple[Path, ProofFile]):
    case, proof = desk
    assert ProofFile.current(proof_path(case), case) == (proof, [])
    assert text_of(proof) == proof_path(case).read_text(encoding="utf-8")


def test_a_run_with_the_starts_of_a_worst_value_has_it_again(desk: tuple[Path, ProofFile]):
    case, proof = desk
    covered = CoveredCase(Job(str(case)))
    for name, proven in proof.proven.items():
        end = Fraction(proven.until, proof.ticks_per_second)
        result = covered.scene_of(covered.phases.inputs_at(proven.starts), end, covered.case.seed).run()
        (verdict,) = [one for one in result.budgets if one.name == name]
        assert verdict.worst == proven.worst.worst


@pytest.mark.parametrize("name", ["slave.toml", FIRMWARE, "start.inc"])
def test_a_changed_file_ends_a_proof(name: str, desk: tuple[Path, ProofFile]):
    case, proof = desk
    file = case.parent / name
    before = file.read_bytes()
    try:
        file.write_bytes(before + b"\n")
        assert ProofFile.current(proof_path(case), case) == (proof, [f"{name} has changed"])
    finally:
        file.write_bytes(before)


def test_a_copied_proof_is_of_the_case_from_which_it_was_copied(desk: tuple[Path, ProofFile]):
    case, proof = desk
    other = case.with_stem("other")
    other.write_bytes(case.read_bytes())
    proof_path(other).write_bytes(proof_path(case).read_bytes())
    assert ProofFile.current(proof_path(other), other) == (proof, ["it belongs to another case file than other.toml"])


@pytest.mark.parametrize("text", ["", "{}", '{"version": 2}', "not JSON", "\0"])
def test_a_file_that_is_not_a_proof_is_refused(text: str, tmp_path: Path):
    path = tmp_path / "slave.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(BadSavedFile, match=r"is no proof of this version of periph-sim .*; write it again with prove"):
        ProofFile.read(path)


def test_a_case_without_a_saved_proof_has_none(tmp_path: Path):
    case = tmp_path / "slave.toml"
    assert ProofFile.current(proof_path(case), case) is None
