"""A wheel that carries the compiled core: HATCH_BUILD_HOOKS_ENABLE=1 pip wheel --no-deps .

    sources, a C compiler --periph_sim.form.build--> periph_sim/compiled --> a wheel of this Python, for this platform

Without the variable the wheel is pure: it runs interpreted, until `python -m periph_sim.form.build` compiles its core.
"""

from __future__ import annotations

import subprocess
import sys
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class CompiledCore(BuildHookInterface[Any]):
    """Compiles what is not compiled yet, and has it packed."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        if version == "editable":  # what is installed in place is compiled in place, by `make core`
            return
        if subprocess.run([sys.executable, "-m", "periph_sim.form.build"], cwd=self.root, check=False).returncode:
            sys.exit("no wheel with a compiled core; leave HATCH_BUILD_HOOKS_ENABLE out for one without")
        for name in ("core.*", "manifest.json"):  # which git ignores; object files stay behind
            build_data["artifacts"].append(f"periph_sim/compiled/{name}")
        build_data["pure_python"] = False
        build_data["infer_tag"] = True
