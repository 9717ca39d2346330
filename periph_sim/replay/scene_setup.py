"""Preparation of a case for a replay, and checks of the capture's time base.

The agent that the capture replaces is removed, and settings of the firmware that the case leaves open are filled in
from the capture. Only settings that the firmware's module names in `REPLAY` are filled in, because another firmware may
use `address` or `busy` for something else.

Budgets are not judged in a replay: its verdict is the agreement of the wires with the capture.
"""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Mapping
from dataclasses import is_dataclass
from fractions import Fraction

from ..scene.case.model import Case
from ..scene.firmware_loader import BadFirmware, load_firmware
from ..scene.scene import Scene
from ..traces.capture.capture import Capture
from ..traces.capture.sampling import rate_text
from . import BadReplay

LEAD = Fraction(1, 1000)  # the firmware starts this long before the capture begins
LONGEST = 24 * 3600  # longest replay, in simulated seconds


def unit_with(case: Case, module: str) -> str:
    """Return the name of the first unit that has a module. Raise BadCase if no unit has it."""
    for name, unit in case.unit.items():
        if module in unit.modules:
            return name
    raise case.mistake(f"no unit has {module}, which this capture is for; add it to a unit's modules", "unit")


def settings_of(case: Case, unit: str) -> frozenset[str]:
    """Return the settings of a unit's firmware that a replay may fill in.

    Raise BadCase if there is no such firmware.
    """
    if not case.unit[unit].firmware:
        return frozenset()
    try:
        return frozenset(load_firmware(case.unit[unit].firmware).replay)
    except BadFirmware as error:
        raise case.mistake(str(error), "unit", unit, "firmware") from None


def undeclared(case: Case, unit: str, names: Iterable[str]) -> list[str]:
    """Return a note on those of the named settings that the firmware has but does not name in `REPLAY`.

    A replay does not fill these settings in.
    """
    if not case.unit[unit].firmware:
        return []
    firmware = load_firmware(case.unit[unit].firmware)
    kind = firmware.settings
    known = inspect.signature(kind).parameters if inspect.isclass(kind) and is_dataclass(kind) else {}
    left = [name for name in names if name in known and name not in firmware.replay]
    if not left:
        return []
    return [
        f"settings of {firmware.name} that are not filled in from the capture, since its module does not name them in "
        f"REPLAY: {', '.join(left)}"
    ]


def taken(case: Case, unit: str, offered: Mapping[str, object]) -> list[str]:
    """Return the offered settings that `alone` will fill in."""
    known = settings_of(case, unit)
    return [name for name, value in offered.items() if name in known - case.unit[unit].settings.keys() and value]


def alone(case: Case, unit: str, agent: str, forced: Mapping[str, object], offered: Mapping[str, object]) -> Case:
    """Return the case without its agent ("controller" or "host") and budgets, with settings for one unit's firmware.

    forced: always set. offered: set if the firmware has them and the case does not set them.
    """
    known = settings_of(case, unit)
    old = case.unit[unit]
    settings = {name: value for name, value in offered.items() if name in known} | old.settings | dict(forced)
    units = {**case.unit, unit: old.model_copy(update={"settings": settings})}
    return case.model_copy(update={"unit": units, agent: None, "budget": ()})


def rate_of(capture: Capture) -> Fraction:
    """Return the number of positions in a second. Raise BadReplay if the file states none."""
    if capture.rate is None:
        raise BadReplay(f"{capture.path}: a replay needs a time base and the file states no rate; state the rate")
    return capture.rate


def check_length(capture: Capture, end: int) -> None:
    """Raise BadReplay if playing up to position `end` takes longer than a day."""
    rate = rate_of(capture)
    if end > LONGEST * rate:
        raise BadReplay(
            f"{capture.path}: at {rate_text(rate)} there are {float(end / rate / 3600):.0f} hours to play; expected at "
            f"most {LONGEST // 3600}; state the right rate with --rate, or cut it with periph-sim convert --window"
        )


def tolerance_of(given: Fraction | None, rate: Fraction, scene: Scene) -> Fraction:
    """Return the largest time, in seconds, by which an event may be early or late.

    given: the user's tolerance. By default it is a sample period of the capture, which is the uncertainty of its edges,
    and one SYSCLKOUT cycle of the slowest unit, to which the chip rounds its inputs. rate: samples per second.
    """
    if given is not None:
        return given
    return 1 / rate + max(1 / dsp.clock.hz for dsp in scene.units.values())
