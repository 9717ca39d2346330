"""Run a function of the bench in a separate process, in the given form of the core, and return its result as JSON.

python -m tests.bench.child MODULE FUNCTION JSON-ARGUMENTS
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from periph_sim import form

ROOT = Path(__file__).parents[2]
TIMING = ROOT / "timing"


def forms() -> list[str]:
    """Return the interpreted form, and the compiled one if a core is built of these sources."""
    built = form.usable(form.PACKAGE, form.BUILT)[0]
    return [form.INTERPRETED, form.COMPILED] if built else [form.INTERPRETED]


def environment(which: str) -> dict[str, str]:
    """Return the environment variables of a process in this form."""
    kept = {key: value for key, value in os.environ.items() if key != form.VARIABLE}
    return {**kept, form.VARIABLE: form.INTERPRETED} if which == form.INTERPRETED else kept


def in_form(which: str, module: str, function: str, *arguments: object) -> Any:
    """Return the result of tests.bench.MODULE.FUNCTION(*arguments) in a new process."""
    command = [sys.executable, "-m", "tests.bench.child", module, function, json.dumps(arguments)]
    done = subprocess.run(command, cwd=ROOT, env=environment(which), capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{' '.join(command)} failed:\n{done.stderr}")
    return json.loads(done.stdout.splitlines()[-1])


def main(arguments: Sequence[str]) -> None:
    module, function, given = arguments
    print(json.dumps(getattr(import_module(f"tests.bench.{module}"), function)(*json.loads(given))))


if __name__ == "__main__":
    main(sys.argv[1:])
