"""Clean copies of the committed tree, in which mutants are tested."""

from __future__ import annotations

import io
import os
import subprocess
import tarfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from .sample import Mutant


def commit_of(root: Path, name: str = "HEAD") -> str:
    """Return the commit to be tested, without uncommitted changes. Raise SystemExit if it does not exist."""
    command = ["git", "rev-parse", "--verify", f"{name}^{{commit}}"]
    result = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False)
    if result.returncode:
        raise SystemExit(f"there is no commit {name!r}")
    return result.stdout.strip()


def unpack(root: Path, commit: str, folder: Path) -> None:
    """Extract the files of a commit to a new folder."""
    folder.mkdir(parents=True)
    packed = subprocess.run(["git", "archive", commit], cwd=root, capture_output=True, check=True).stdout
    with tarfile.open(fileobj=io.BytesIO(packed)) as archive:
        archive.extractall(folder, filter="data")


@dataclass(frozen=True)
class Tree:
    """One copy of the tree, for one trial at a time."""

    folder: Path

    def environment(self) -> dict[str, str]:
        """Return the environment of processes that import this copy, without variables that refer to another one."""
        kept = {name: value for name, value in os.environ.items() if not name.startswith(("PYTEST", "COV_", "PYTHON"))}
        return {**kept, "PYTHONPATH": str(self.folder)}

    @contextmanager
    def mutated(self, mutant: Mutant) -> Iterator[None]:
        """Insert the mutant inside the context. Its bytecode, which Python checks by second and size, is deleted."""
        path = self.folder / mutant.path
        stat, own = path.stat(), path.read_bytes()
        lines = own.splitlines(keepends=True)
        place = mutant.change.line - 1
        lines[place] = mutant.change.applied(lines[place])
        path.write_bytes(b"".join(lines))
        self._forget(path)
        try:
            yield
        finally:
            path.write_bytes(own)
            os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))
            self._forget(path)

    @staticmethod
    def _forget(path: Path) -> None:
        for compiled in (path.parent / "__pycache__").glob(f"{path.stem}.*.pyc"):
            compiled.unlink()
