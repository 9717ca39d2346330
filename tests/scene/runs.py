"""Run the case files of timing/ for some time, and collect the controller's transfers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

import numpy as np

from periph_sim import Case, Firmware, Result, Scene, load
from periph_sim.bus.i2c.transfer import Transfer
from periph_sim.core.records import RECORDED, Kind, Record, Recorder, Subjects
from periph_sim.core.time import Timebase
from periph_sim.records.recording import Subscribe
from periph_sim.traces.capture.capture import Capture, Channel

TIMING = Path(__file__).parents[2] / "timing"


class Ran(NamedTuple):
    result: Result
    rounds: list[list[Transfer]]  # the controller's, in the order of its requests
    scene: Scene
    transfers: list[Transfer]  # all of the controller's, including its start-up

    def broken(self) -> list[str]:
        """Return the names of the budgets that did not pass."""
        return [verdict.name for verdict in self.result.budgets if not verdict.passed]

    def answered(self) -> list[str]:
        """Return by round which chips acknowledged: "G-M" if only the accelerometer, addressed second, did not."""
        return ["".join(t.name[0].upper() if t.acked else "-" for t in transfers) for transfers in self.rounds]

    def read(self) -> list[list[str]]:
        """Return by round the bytes read in each request, in hex."""
        return [[t.phases[-1].got.hex(" ") for t in transfers] for transfers in self.rounds]


def run_file(name: str, seconds: str, *changes: str) -> Ran:
    """Run the case timing/NAME.toml with `key=value` changes."""
    return run_case(load(TIMING / f"{name}.toml", list(changes)), seconds)


def run_case(case: Case, seconds: str, subscribe: Subscribe | None = None) -> Ran:
    scene = Scene(case, subscribe)
    rounds: list[list[Transfer]] = []
    transfers: list[Transfer] = []
    if scene.head is not None:
        scene.head.on_transfer.append(transfers.append)
        scene.head.on_round.append(lambda over: rounds.append(transfers[-over.transfers :]))
    result = scene.run(Fraction(seconds))
    return Ran(result, rounds, scene, transfers)


def recorded(
    case: Case,
    kinds: Iterable[Kind] = RECORDED,
    programs: Mapping[str, Firmware] | None = None,
    subjects: Subjects | None = None,
    *,
    keep_values: bool = False,
) -> tuple[Scene, list[Record]]:
    """Return a scene that has not run yet, and the list that receives its records."""
    records: list[Record] = []
    scene = Scene(
        case,
        lambda recorder, _: recorder.subscribe(kinds, records.append, subjects),
        programs,
        keep_values=keep_values,
    )
    return scene, records


class Edges:
    """Subscriber to the edges of a scene; `capture` returns them as a logic analyser would record them."""

    def __init__(self) -> None:
        self._edges: dict[str, list[tuple[int, int]]] = {}
        self._rate = 0

    def subscribe(self, recorder: Recorder, timebase: Timebase) -> None:
        self._rate = timebase.per_second
        recorder.subscribe([Kind.EDGE], self._keep)

    def _keep(self, record: Record) -> None:
        self._edges.setdefault(record.where, []).append((record.tick, record.value))

    def capture(self, length: int) -> Capture:
        channels = []
        for index, (name, edges) in enumerate(self._edges.items()):
            ticks = np.array([tick for tick, _ in edges], np.int64)
            channels.append(Channel(name, index, 1, ticks))
        return Capture(Path("scene"), Fraction(self._rate), length, tuple(channels), sampled=False, exact=True)
