"""The origin of a report: commit of the case's repository, versions, and form of the core."""

from __future__ import annotations

import platform
import subprocess
from importlib.metadata import version
from pathlib import Path

from .... import form

LONGEST = 5  # seconds that git may take


def commit_of(folder: Path) -> str:
    """ "1a2b3c4d5e6f", with ", and uncommitted changes" if tracked files differ; "" without a repository,
    commit or git."""
    commit = _git(folder, "rev-parse", "--short=12", "HEAD")
    if not commit:
        return ""
    return (
        f"{commit}, and uncommitted changes"
        if _git(folder, "status", "--porcelain", "--untracked-files=no")
        else commit
    )


def _git(folder: Path, *command: str) -> str:
    try:
        done = subprocess.run(
            ["git", "-C", str(folder), *command],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=LONGEST,
            check=True,
        )
    except (OSError, subprocess.SubprocessError):
        return ""
    return done.stdout.strip()


def versions() -> str:
    return f"periph-sim {version('periph-sim')}, {form.running}, Python {platform.python_version()}"
