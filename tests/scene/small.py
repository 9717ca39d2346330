"""Small scenes for tests: a firmware given as a function, a case as a few lines."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from periph_sim import Case, Dsp, Firmware, Scene
from periph_sim.scene import unit as unit_module


def case(duration: str = "10 ms", **more: Any) -> Case:
    """A case by its tables; `unit` may be left out for a scene without a DSP."""
    return Case.model_validate({"name": "small", "duration": duration, "unit": {}, **more})


def scene_with(
    monkeypatch: pytest.MonkeyPatch, firmware: Callable[[Dsp], None], modules: list[str], **more: Any
) -> Scene:
    """A scene whose unit "dsp" runs `firmware`, built from a case as every other scene is."""
    program = Firmware("under test", lambda dsp, settings: firmware(dsp), None)
    monkeypatch.setattr(unit_module, "load_firmware", lambda name: program)
    return Scene(case(unit={"dsp": {"firmware": "under test", "modules": modules}}, **more))


def sentence_of(error: type[Exception], refused: Callable[[], object]) -> str:
    """What an error of this kind says, in one line; the call raises it."""
    with pytest.raises(error) as caught:
        refused()
    assert "\n" not in str(caught.value)
    return str(caught.value)
