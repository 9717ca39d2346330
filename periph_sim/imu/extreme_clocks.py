"""The flagship scene with crystals 200 000 ppm apart.

The host's bit rate follows the unit's crystal, because an SCI cannot receive at ten percent error. The bytes of each
round are compared with the frames, and the instant of each round with the exact one.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from ..core.examples import EXAMPLES
from ..scene.case.load import load
from ..scene.case.model import Controller
from ..scene.scene import Scene
from .extremes.finding import EVERY, Finding

PPM = 100_000  # either way, the largest value that a case accepts
LENGTH = Fraction(1, 10)  # s
LEAST_ROUNDS = 4


def imu_hil_clocks() -> Iterator[Finding]:
    """Yield findings with the crystals of unit and controller at opposite extremes, both ways."""
    for sign in (1, -1):
        unit, controller = sign * PPM, -sign * PPM
        changes = [f"unit.dsp.ppm={unit}", f"controller.ppm={controller}", f"host.error={Fraction(unit, 10_000)}"]
        scene = Scene(load(EXAMPLES / "timing" / "imu_hil.toml", changes))
        due: list[int] = []
        scene.bus.rounds.on_due.append(due.append)
        result = scene.run(LENGTH)
        counts, (wrong,) = result.counts, [one for one in result.budgets if one.name == "wrong bytes"]
        table, per_second = scene.case.controller or Controller(), scene.timebase.per_second
        exact = [(table.first + n * table.period) * per_second / (1 + table.ppm / 10**6) for n in range(len(due))]
        late = max(abs(tick - scene.start - one) for tick, one in zip(due, exact, strict=True))
        answered = wrong.passed and not counts["missed"] and not counts["nacked"] and counts["rounds"] >= LEAST_ROUNDS
        note = (
            f"{wrong.count} bytes as in the frames, {counts['rounds']} rounds, each within {float(late):.2g} of a tick "
            "of its exact instant"
        )
        extreme = f"imu_hil, unit {unit:+d} ppm, controller {controller:+d} ppm"
        yield Finding(extreme, EVERY, "exact" if answered and late < 1 else "off", None, "", note=note)


SCENES = {"crystals of a scene": imu_hil_clocks}
