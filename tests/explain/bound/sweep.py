"""Random scenes, each beside its bounds: seeds go in; what is beyond a bound, and how near runs come, come out.

python -m tests.explain.bound.sweep --first 1 --count 100
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from random import Random

from periph_sim.explain.bound import BadBound, report
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import Case
from periph_sim.timing.budget_schema import Budget
from tests.scene.runs import TIMING

MODELS = {  # what the models cost is another setting where it is estimated
    "imu_hil": "unit.dsp.settings.beyond_estimate",
    "imu_hil_400k": "unit.dsp.settings.beyond_estimate",
    "imu_hil_published": "unit.dsp.settings.model_cost",
}
CASES = tuple(MODELS)
CHOICES = {
    "host.period": ("7 ms", "10 ms", "10.003 ms", "17 ms", "20 ms"),
    "host.jitter": ("0 ms", "1 ms", "3 ms"),
    "host.paced_by": ("schedule", "pause"),
    "host.gap": ("0", "1", "2.5"),
    "host.error": ("-1", "0", "0.16", "1"),
    "host.ppm": ("-2000", "-3.7", "0", "78", "2000"),
    "controller.rate": ("60 kHz", "100 kHz", "250 kHz", "400 kHz"),
    "controller.period": ("10 ms", "15 ms", "20 ms"),
    "controller.jitter": ("0 ms", "0 ms", "2 ms"),
    "controller.ppm": ("-50", "-11.3", "0", "50"),
    "unit.dsp.ppm": ("-80", "0", "3.7", "80"),
    "unit.dsp.code.between_accesses": ("0", "1", "5", "15"),
    "unit.dsp.code.poll_pass": ("7", "10", "40", "400"),
    "unit.dsp.code.isr_prologue": ("0", "6", "17", "200"),
    "unit.dsp.code.isr_epilogue": ("0", "11", "40"),
    "unit.dsp.options.system.pf2_read_ws": ("0", "2", "15"),
    "unit.dsp.options.system.int_latency": ("13", "14", "16"),
    "unit.dsp.options.system.vector_fetch_waits": ("0", "1", "2"),
    "unit.dsp.options.system.idle_wake": ("0", "16"),
    "unit.dsp.options.system.gpio_out_delay": ("0", "2"),
    "unit.dsp.options.i2c.noise_filter_cycles": ("0", "1", "5"),
    "unit.dsp.options.i2c.sda_setup_before_scl_release": ("0", "1", "20"),
    "unit.dsp.options.i2c.aas_sdir_point": ("fall8", "rise8", "fall9"),
    "unit.dsp.options.i2c.rrdy_point": ("fall8", "rise9", "fall9"),
    "unit.dsp.options.i2c.bcm_reset": ("1", "0"),
    "unit.dsp.options.sci.rx_int_extra": ("0", "3", "16"),
    "models": ("1 us", "250 us", "1900 us", "100 us to 400 us"),
    "unit.dsp.settings.frame_cost": ("0 us", "2 us", "10 us", "20 us"),
    "unit.dsp.settings.fifo_level": ("12", "12", "12", "6", "4", "1"),
}
COUNTED = ("fifo high-water", "overruns", "nacked", "nacked rounds", "missed rounds")
TIMED = (
    *("from bus STOP to access W I2C-A.I2COAR", "each time in interrupt SCIRXINTA", "model age"),
    *("age of gyroscope", "age of accelerometer", "age of magnetometer"),
    "from flag I2C-A.I2CSTR.SDIR rise to access W I2C-A.I2CDXR, same transfer",
    "from flag I2C-A.I2CSTR.XRDY rise to access W I2C-A.I2CDXR, same transfer",
)  # which `report` compares where the case limits them
SECONDS = Fraction(9, 200)


@dataclass
class Swept:
    """beyond: what went further than its bound. nearest: by bound, the least ratio of the two. none: cases without."""

    beyond: list[str] = field(default_factory=list)
    nearest: dict[str, Fraction] = field(default_factory=dict)
    compared: int = 0
    none: int = 0

    def add(self, seed: int) -> None:
        case, changes = scene(seed)
        try:
            found = report(case, SECONDS)
        except BadBound:
            self.none += 1
            return
        self.none += not found.beside
        if found.hung:
            self.beyond.append(f"seed {seed}: {found.hung[0]}; {changes}")
        for each in found.beside:
            if each.seen is None or each.bound.unproven:
                continue
            self.compared += 1
            if not each.holds:
                what = f"{each.bound.name}: bound {each.bound.ticks}, seen {each.seen}"
                self.beyond.append(f"seed {seed}, {case.name}, {what}; {changes}")
            if each.ratio is not None:
                self.nearest[each.bound.name] = min(each.ratio, self.nearest.get(each.bound.name, each.ratio))


def scene(seed: int) -> tuple[Case, list[str]]:
    """A case without faults, and what it changes of the shipped one."""
    random = Random(seed)
    name = random.choice(CASES)
    chosen = {key: random.choice(some) for key, some in CHOICES.items() if random.random() < 0.4}
    if name != "imu_hil_published":
        chosen.pop("controller.period", None)  # the models' own
    changes = [f"{MODELS[name] if key == 'models' else key}={value}" for key, value in chosen.items()]
    changes.append(f"host.first={random.randrange(0, 12_000_000)} ns")
    changes.append(f"controller.first={random.randrange(3_000_000, 14_000_000)} ns")
    changes.append(f"seed={seed}")
    case = load(TIMING / f"{name}.toml", changes)
    limits = [(measure, "1000000 s") for measure in TIMED] + [(measure, 10**9) for measure in COUNTED]
    budgets = [Budget(name=f"{i}", measure=measure, max=most) for i, (measure, most) in enumerate(limits)]
    return case.model_copy(update={"budget": tuple(budgets), "breaks": ()}), changes


def sweep(seeds: Iterator[int] | range) -> Swept:
    swept = Swept()
    for seed in seeds:
        swept.add(seed)
    return swept


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--count", type=int, default=100)
    given = parser.parse_args()
    swept = sweep(range(given.first, given.first + given.count))
    print(f"{given.count} scenes, {swept.none} without bounds, {swept.compared} values beside their bounds")
    for name, ratio in sorted(swept.nearest.items()):
        print(f"  {name:25} {float(ratio):.5f}")
    print("\n".join(swept.beyond) or "none is beyond its bound")


if __name__ == "__main__":
    main()
