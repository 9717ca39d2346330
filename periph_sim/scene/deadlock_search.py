"""Search of a scene for firmware that waits for what cannot come."""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING

from ..core.chip import NEVER
from .deadlock import deadlock_reason
from .stuck_lines import doing, waits

if TYPE_CHECKING:
    from ..core.wire import Wire
    from ..processor.dsp import Dsp
    from .scene import Scene

SETTLED = Fraction(1, 1_000_000)  # seconds in which outputs and holds that were begun are over


def deadlocks_of(scene: Scene) -> list[str]:
    """Return a sentence for each unit whose firmware waits for what cannot come: for what, since when, why it cannot.

    If firmware let no simulated time pass and so ended the run, only that is reported.
    """
    if scene.stalled:
        return [scene.stalled]
    instant = partial(_instant, scene)
    stuck = dict.fromkeys(scene.units, "")
    before = -1
    while len(stuck) != before:  # a unit that is not stuck may end the wait of another one
        before, may_move = len(stuck), partial(_may_move, scene, set(stuck))
        found = {name: deadlock_reason(scene.units[name], may_move, instant) for name in stuck}
        stuck = {name: why for name, why in found.items() if why}
    return [f"{name} {_wait(scene, scene.units[name])} and would for ever: {why}" for name, why in stuck.items()]


def _wait(scene: Scene, dsp: Dsp) -> str:
    """Return the wait that a unit is in or that a service routine interrupts, as a phrase."""
    found = dsp.program.unanswered_wait()
    if found is None:
        return doing(dsp, scene.timebase, scene.start)
    return waits(found.what, found.place, _instant(scene, dsp.clock.tick(found.since)))


def _instant(scene: Scene, tick: int) -> str:
    return scene.timebase.show(tick - scene.start)


def _may_move(scene: Scene, stuck: set[str], wire: Wire, parties: list[str]) -> bool:
    """Return True if a party may move the wire: not stuck, and not only answering or waiting in a round."""
    coming = scene.kernel.next_time()
    if coming <= scene.kernel.now + scene.timebase.ticks(SETTLED):
        return True
    held = wire.held_by()
    for who in parties:
        name = who.partition(".")[0]
        if name in scene.units:
            may = name not in stuck
        elif wire.name in ("SCL", "SDA") and (name in scene.chips or name in scene.devices):
            may = who in held and coming < NEVER
        elif name == "controller" and scene.head is not None:
            may = scene.head.at_rest or coming < NEVER
        else:
            may = True
        if may:
            return True
    return False
