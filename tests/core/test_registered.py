"""Packages whose names are imported at first use."""

from __future__ import annotations

import importlib
import subprocess
import sys

import pytest

PACKAGES = ("periph_sim.timing",)


@pytest.mark.parametrize("package", PACKAGES)
def test_each_name_is_found_and_an_unknown_one_is_an_error(package: str) -> None:
    module = importlib.import_module(package)
    assert [getattr(module, name).__name__ for name in module.__all__] == module.__all__
    with pytest.raises(AttributeError, match=f"module '{package}' has no attribute 'betwen'"):
        _ = module.betwen


@pytest.mark.parametrize("package", PACKAGES)
def test_importing_the_package_loads_none_of_its_modules(package: str) -> None:
    code = f"import sys, {package}; print([m for m in sys.modules if m.startswith(('{package}.', 'numpy'))])"
    came = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert came.stdout == "[]\n"
