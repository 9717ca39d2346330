"""Firmware with extra cycles before one of its statements: the changed program, and the results of its run."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

from periph_sim import Firmware, Result, Scene, load
from tests.firmware_mutants.trials import compiled
from tests.scene.runs import TIMING

SOURCES = Path(__file__).parents[2] / "firmware" / "python"
WRITE = "i2c.I2CDXR.all = next(buffer)"


def always() -> bool:
    return True


def delayed(statement: str, cycles: int, when: Callable[[], bool] = always) -> Firmware:
    """Return the published firmware with extra cycles before a statement, whenever `when` returns True."""
    inserted = f"is_late() and dsp.compute({cycles}); " if cycles else ""
    return replaced("imu_hil", statement, inserted + statement, is_late=when)


def replaced(firmware: str, old: str, new: str, **names: object) -> Firmware:
    """Return a shipped program in which one text is replaced. names: further global names of the program."""
    source = (SOURCES / f"{firmware}.py").read_text(encoding="utf-8")
    assert source.count(old) == 1 or not old
    module = compiled(source.replace(old, new), "changed")
    vars(module).update(names)
    return Firmware("changed", module.main, module.Settings)


def broken(case: str, old: str = "", new: str = "", *changes: str) -> dict[str, str]:
    """Return the budgets that do not pass, with a text of the firmware replaced or with changes of the case."""
    loaded = load(TIMING / f"{case}.toml", list(changes))
    result = Scene(loaded, programs={"dsp": replaced(loaded.unit["dsp"].firmware, old, new)}).run()
    return {verdict.name: verdict.verdict for verdict in result.budgets if not verdict.passed}


def late(
    statement: str,
    cycles: int,
    case: str = "imu_hil",
    seconds: str = "0.3",
    when: Callable[[], bool] = always,
    changes: tuple[str, ...] = (),
) -> tuple[Result, Scene]:
    """Run a case with the delayed firmware."""
    programs = {"dsp": delayed(statement, cycles, when)}
    scene = Scene(load(TIMING / f"{case}.toml", list(changes)), programs=programs, keep_values=True)
    return scene.run(Fraction(seconds)), scene


def kept(scene: Scene, budget: str) -> list[int]:
    """Return all values of a budget's measure, in ticks."""
    (measure,) = (limit.measure for limit in scene.limits if limit.budget.name == budget)
    return [int(value) for value in measure.all_kept()[0]]


def cycle(scene: Scene) -> Fraction:
    """Return the ticks of a cycle of SYSCLKOUT."""
    return scene.timebase.per_second / scene.units["dsp"].clock.hz
