"""The saved proof of a case: which verdicts of a run are proven, and why the others are not.

case --proof file--> ProofReport --mark--> Verdict.proven, a line, and reasons for `--guaranteed`
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from msgspec import Struct

from ...proof.saved_paths import proof_path
from ...timing.verdict import Verdict


class ProofReport(Struct, frozen=True):
    """Summary of the proof file of a case.

    line: a sentence about the file; "" if there is no file, or the case was read with changes.
    proven: the names of the proven budgets. It is empty if the file is out of date or cannot be read.
    reasons: the reason why a budget is not proven, by its name. The file has it for some budgets.
    otherwise: the reason for all other budgets that are not proven.
    """

    line: str
    proven: frozenset[str] = frozenset()
    reasons: dict[str, str] = {}
    otherwise: str = ""

    def missing(self, verdicts: Sequence[Verdict]) -> list[tuple[str | None, str]]:
        """Return the name and a sentence with the reason for each budget that is not proven.

        If the file proves no budget at all, return only one pair, with None as the name.
        """
        missing = [one for one in verdicts if not one.proven]
        if missing and not self.proven:
            return [(None, f"no budget is proven: {self.otherwise}")]
        return [
            (one.name, f"{one.name} is not proven: {self.reasons.get(one.name, self.otherwise)}") for one in missing
        ]

    def line_beside(self, texts: Iterable[str]) -> str:
        """Return `line`; "" if one of these texts, which are shown with it, already contains it."""
        return "" if any(self.line in text for text in texts) else self.line


NO_PROOF = ProofReport("")


def proof_report(case: Path, changes: Sequence[str] = ()) -> ProofReport:
    """Return what the proof file of a case says.

    changes: the "key=value" texts with which the case is read. A proof holds for the unchanged case only.
    """
    path = proof_path(case)
    if not path.exists():
        return ProofReport("", otherwise=f"there is no {path.as_posix()}; prove --table --save writes it")
    from ...proof.proof_file import ProofFile  # imported only here, because few cases have a proof
    from ...proof.saved_file import BadSavedFile

    if changes:
        return ProofReport("", otherwise=f"{path.as_posix()} holds for the unchanged case only")
    try:
        found = ProofFile.current(path, case)
    except BadSavedFile as error:
        return ProofReport(str(error), otherwise=str(error))
    if found is None:  # the file was removed since the call of `exists`
        return ProofReport("", otherwise=f"there is no {path.as_posix()}")
    file, differences = found
    if differences:
        more = f" and {len(differences) - 1} more" if len(differences) > 1 else ""
        line = f"{path.as_posix()} is out of date: {differences[0]}{more}; write it again with {file.command}"
        return ProofReport(line, otherwise=line)
    line = f"{path.as_posix()}: {file.line}"
    return ProofReport(line, frozenset(file.proven), file.not_proven, f"{path.as_posix()} has no entry for it")


def mark_proven(case: Path, changes: Sequence[str], verdicts: Sequence[Verdict]) -> ProofReport:
    """Set `proven` in the verdicts of a case's run, and return what the proof file says."""
    report = proof_report(case, changes)
    for verdict in verdicts:
        verdict.proven = verdict.name in report.proven
    return report
