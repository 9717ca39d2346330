"""Date and machine of a bench: processor, cores, Python, versions, forms."""

from __future__ import annotations

import os
import platform
from collections.abc import Sequence
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import periph_sim
from periph_sim.form import COMPILED, INTERPRETED

COMPARED = ("Cython", "greenlet", "numpy", "simpy", "cocotb", "cocotbext-i2c")


def machine(forms: Sequence[str]) -> dict[str, Any]:
    return {
        "date": f"{datetime.now(UTC):%Y-%m-%d}",
        "periph_sim": periph_sim.__version__,
        "forms": sorted(forms, key=[COMPILED, INTERPRETED].index),
        "processor": processor(),
        "cores": os.cpu_count(),
        "load": round(os.getloadavg()[0], 2),  # of the last minute; far above 0, other work ran, too
        "system": f"{platform.system()} {platform.machine()}",
        "python": f"{platform.python_implementation()} {platform.python_version()}",
        "with": {name: found for name in COMPARED if (found := _version(name))},
    }


def processor() -> str:
    """Return the name of the processor as the system reports it, without the common prefix."""
    file = Path("/proc/cpuinfo")
    lines = file.read_text("utf-8").splitlines() if file.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return (names or [platform.processor() or "unknown"])[0]


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return ""
