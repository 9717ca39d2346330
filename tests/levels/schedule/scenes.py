"""Random small scenes, run at both levels: a seed goes in; a case, and what each level makes of it, come out.

python -m tests.levels.schedule.scenes --first 0 --count 100
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from dataclasses import dataclass, field
from fractions import Fraction
from random import Random
from unittest.mock import patch

from periph_sim.bus.i2c.transfer import Transfer
from periph_sim.core.records import Kind, Record
from periph_sim.devices.sensor_rounds import Request
from periph_sim.levels.schedule import BadSchedule, ScheduleResult, Structure, schedule, structure_of
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import Case
from periph_sim.scene.scene import Scene
from periph_sim.timing.budget_schema import Budget
from tests.scene.runs import TIMING

COUNTED = ("missed rounds", "nacked rounds", "nacked")
TIMED = ("response", "round", "slack", "age", "margin of I2CDXR", "span:model", "stretch")
FROM_RECORDS = ("asked", "SDIR rises")
CHOICES = {
    "host.period": ("3 ms", "7 ms", "10 ms", "10.003 ms", "17 ms", "20 ms"),
    "host.jitter": ("0 ms", "1 ms", "1.7 ms"),
    "host.paced_by": ("schedule", "pause"),
    "host.gap": ("0", "1", "2.5"),
    "host.error": ("-1", "0", "0.16", "1"),
    "host.ppm": ("-2000", "-3.7", "0", "78", "2000"),
    "controller.rate": ("60 kHz", "100 kHz", "250 kHz", "400 kHz"),
    "controller.period": ("10 ms", "15 ms", "20 ms"),
    "controller.jitter": ("0 ms", "0 ms", "2 ms"),
    "controller.ppm": ("-50", "-11.3", "0", "50"),
    "controller.order": (["magnetometer", "gyroscope", "accelerometer"], ["accelerometer", "gyroscope"]),
    "unit.dsp.ppm": ("-80", "0", "3.7", "80"),
    "unit.dsp.code.between_accesses": ("0", "1", "5", "15"),
    "unit.dsp.code.poll_pass": ("7", "10", "40", "400"),
    "unit.dsp.code.isr_prologue": ("0", "6", "17", "200"),
    "unit.dsp.code.isr_epilogue": ("0", "11", "40"),
    "unit.dsp.options.system.pf2_read_ws": ("0", "2", "15"),
    "unit.dsp.options.system.int_latency": ("13", "14", "16"),
    "unit.dsp.options.system.gpio_out_delay": ("0", "2"),
    "unit.dsp.options.i2c.noise_filter_cycles": ("1", "5"),
    "unit.dsp.options.i2c.sda_setup_before_scl_release": ("0", "1", "20"),
    "unit.dsp.options.i2c.aas_sdir_point": ("fall8", "rise8", "fall9"),
    "unit.dsp.options.i2c.rrdy_point": ("fall8", "rise9", "fall9"),
    "unit.dsp.options.sci.rx_int_extra": ("0", "3", "16"),
    "models": ("1 us", "250 us", "1900 us", "100 us to 400 us", "12 ms to 17 ms", "17100 us to 17500 us"),
    "unit.dsp.settings.frame_cost": ("0 us", "2 us", "20 us", "60 us", "150 us", "300 us"),
}
FORGOTTEN = 15_000_000  # ticks: of frames as quick as can be, one that is older may be forgotten on edges
ADDRESSES = {"gyroscope": 0x68, "accelerometer": 0x53, "magnetometer": 0x1E}
MODELS = {"imu_hil": "unit.dsp.settings.beyond_estimate", "imu_hil_published": "unit.dsp.settings.model_cost"}


@dataclass
class Compared:
    """Of one scene. refused: why there is nothing to compare; empty if there is. differ: what is not equal."""

    changes: list[str]
    refused: str = ""
    differ: list[str] = field(default_factory=list)
    hung: bool = False
    nacked: bool = False
    stretched: bool = False


def scene(seed: int) -> tuple[Case, list[str], int]:
    """A case, what it changes of the shipped one, and a number of rounds."""
    random = Random(seed)
    name = random.choice(["imu_hil", "imu_hil_published", "imu_hil_published"])
    chosen = {key: random.choice(some) for key, some in CHOICES.items() if random.random() < 0.3}
    order = chosen.pop("controller.order", None)
    if name == "imu_hil":
        chosen.pop("controller.period", None)  # the models' own
    changes = [f"{MODELS[name] if key == 'models' else key}={value}" for key, value in chosen.items()]
    if order is not None and name != "imu_hil":
        addresses = [ADDRESSES[chip] for chip in order]
        changes += [f"controller.order={json.dumps(order)}", f"unit.dsp.settings.order={addresses}"]
    changes.append(f"host.first={random.randrange(0, 12_000_000)} ns")
    changes.append(f"controller.first={random.randrange(3_000_000, 14_000_000)} ns")
    changes.append(f"seed={seed}")
    return load(TIMING / f"{name}.toml", changes), changes, random.randint(3, 7)


def compare(case: Case, rounds: int, changes: list[str]) -> Compared:
    found = Compared(changes)
    try:
        structure = structure_of(case)
        quick = schedule(structure, rounds=rounds)
    except BadSchedule as error:
        found.refused = str(error)
        return found
    if quick.refused[0]:
        found.refused = "the module answers for firmware that is still elsewhere"
        return found
    found.hung, found.nacked = bool(quick.hung[0]), bool(quick["nacked"].worst[0])
    found.stretched = bool(quick["stretch"].worst[0])
    for name, values in at_edges(case, structure, quick).items():
        one = quick[name]
        mine = int(one.worst[0]), int(one.least[0]), int(one.count[0])
        if name == "age" and not one.count[0] and values[0] > FORGOTTEN:
            continue
        if name in COUNTED:  # whose occasions the measures count otherwise
            values, mine = (values[0], 0, 0), (mine[0], 0, 0)
        if values != mine:
            found.differ.append(f"{name}: edge {values}, schedule {mine}")
    return found


def at_edges(case: Case, structure: Structure, quick: ScheduleResult) -> dict[str, tuple[int, int, int]]:
    """(worst, least, count) of each observable, in ticks."""
    limits = {name: 10**9 if name in COUNTED else "1000000 s" for name in (*TIMED, *COUNTED)}
    budgets = tuple(Budget(name=name, measure=name, max=most) for name, most in limits.items())
    records: list[Record] = []
    subjects = {Kind.ACCESS: {"dsp.I2C-A.I2CSTR"}}
    scene = Scene(
        case.model_copy(update={"budget": budgets, "breaks": ()}),
        lambda recorder, _: recorder.subscribe([Kind.ACCESS], records.append, subjects),
    )
    transfers: list[Transfer] = []
    made = Request.transfers

    def kept(request: Request, by_stop: bool) -> list[Transfer]:
        transfers.extend(of_it := made(request, by_stop))
        return of_it

    with patch.object(Request, "transfers", kept):  # of a round all at once; one that never began has no START
        scene.run(Fraction(int(quick.end[0]), scene.timebase.per_second))
    measures = {limit.budget.name: limit.measure for limit in scene.limits}
    found = {name: (one.worst, one.least, one.count) for name, one in measures.items()}
    asked, rises = margins(structure, transfers, records)
    for name, values in zip(FROM_RECORDS, (asked, rises), strict=True):
        if values:
            found[name] = max(values), min(values), len(values)
    return found


def margins(structure: Structure, transfers: list[Transfer], records: list[Record]) -> tuple[list[int], list[int]]:
    """Ticks by which the firmware waits for its chip before this is asked, and writes I2CSTR before SDIR rises.

    The first list is empty where the run ends before the firmware waits for a chip that was asked.
    """
    names = structure.terms.names
    waits = [
        record.tick
        for before, record in zip([None, *records], records, strict=False)
        if record.field == "AAS" and (before is None or before.field != "AAS")
    ]
    cleared = [record.tick for record in records if record.what.startswith("W") and record.field == "SCD"]
    asked, rises, served = [], [], 0
    for transfer in transfers:
        start, chip = transfer.phases[0].start_at, names.index(transfer.name)
        if start < 0 or chip != served % len(names):
            continue
        if served == len(waits):
            return [], rises
        asked.append(start - waits[served])
        if transfer.phases[0].acked:
            if served < len(cleared):
                rises.append(start + structure.terms.bus[chip].sdir - cleared[served])
            served += 1
    return asked, rises


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=100)
    given = parser.parse_args()
    tally: Counter[str] = Counter()
    for seed in range(given.first, given.first + given.count):
        case, changes, rounds = scene(seed)
        one = compare(case, rounds, changes)
        tally["refused" if one.refused else "differ" if one.differ else "equal"] += 1
        tally.update(word for word in ("hung", "nacked", "stretched") if getattr(one, word))
        if one.refused:
            tally[one.refused[:110]] += 1
        if one.differ:
            print(seed, rounds, case.name, changes, *one.differ, sep="\n    ", flush=True)
    print(dict(tally))


if __name__ == "__main__":
    main()
