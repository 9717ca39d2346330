"""Limits of the sensor models: a report of their behaviour at extreme inputs in each arithmetic.

An arithmetic is float64 (the reference), float32 or a Q format (see `numeric`). The working range is the range of
motions that the sensors can measure (see `working_range`). An extreme is an input, an event or a situation far from
ordinary use. A converter is at full scale if it returns its lowest or highest code.

working range -----search--> deviation of each arithmetic from float64
motions,
magnetic fields,
lever arms --------sweep---> first input at which an arithmetic deviates from the reference, and how
events --------------------> lost frames, runs of weeks, divisions by 0, rejected parameters
outside the models --------> length of a run, clocks with errors, baud rates, sums of noise, Allan variances, inputs
costs ---------------------> cycles for a sample
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from ...core.input_error import InputError
from ...core.phrases import did_you_mean
from ..models.counts import counts_of
from ..models.parameters import ImuParameters
from ..numeric import arithmetic_names as named
from ..numeric.estimate import RTS, Estimate, Tables, estimate
from . import events, outside_models
from .frames import REFERENCE
from .sweep import ExtremeFinding, InputSweep
from .sweeps import FIELDS, MOTIONS
from .working_range import Worst, worst

SWEEPS: tuple[InputSweep, ...] = (*MOTIONS, *FIELDS)
EVENTS = {
    "lost or doubled frame": events.lost_frames,
    "division by Ts = 0": events.zero_period,
    "time in seconds, 30 days": events.weeks,
    "smallest LSB": events.smallest_steps,
    "parameters": events.refused,
}
OUTSIDE: dict[str, Callable[[], Iterator[ExtremeFinding]]] = {
    "length of a run": outside_models.longest_run,
    "clocks": outside_models.clocks,
    "last tick": outside_models.lines_at_the_last_tick,
    "10^9 samples of noise": outside_models.noise_sums,
    "inputs": outside_models.inputs,
    "baud rate": outside_models.baud_rates,
    "Allan variance": outside_models.allan_variances,
    "crystals of a scene": outside_models.imu_hil_clocks,
}
USUAL = ("float64", "float32", "q16", "q16 saturating", "q12")


@dataclass(frozen=True)
class ExtremesReport:
    """The results of all examinations.

    imu, seed: the parameters and the seed of the search in the working range.
    names: the names of the examined kinds of arithmetic.
    errors: the largest errors of each arithmetic in the working range, by its name. float64 has no entry.
    costs: the cost of a sample in each arithmetic, by its name.
    without_fastrts: the cost of float32 with the compiler's library in place of TI's fastRTS library.
    findings: the behaviour of each arithmetic at each examined extreme.
    """

    imu: ImuParameters
    names: tuple[str, ...]
    seed: int
    errors: dict[str, Worst]
    costs: dict[str, Estimate]
    without_fastrts: Estimate
    findings: tuple[ExtremeFinding, ...]

    def findings_for(self, extreme: str) -> list[ExtremeFinding]:
        return [one for one in self.findings if one.extreme == extreme]


NAMES = (*(sweep.name for sweep in SWEEPS), *EVENTS, *OUTSIDE)


def report(
    names: tuple[str, ...] = USUAL,
    seed: int = 0,
    samples: int = 1000,
    only: tuple[str, ...] = (),
    imu: ImuParameters | None = None,
    tables: Tables = "RAM",
) -> ExtremesReport:
    """Examine several kinds of arithmetic at extreme inputs.

    names: the names of the kinds of arithmetic, such as "float32".
    seed, samples: the seed and the number of samples of the search in the working range.
    only: the names of the extremes to examine; empty for all extremes.
    imu: the parameters of the search and of the costs; None for those of the dissertation's Table 4.1. The extremes are
        examined with other parameters, which are fixed.
    tables: the memory that contains the sine and arctangent tables of the mathematics libraries.

    Raise NoSuchArithmetic, DoesNotFit or InputError for an invalid name, and DoesNotFit for a Q format that cannot hold
    the parameters.
    """
    for name in only:
        if name not in NAMES:
            raise InputError(f"there is no extreme {name!r}; {did_you_mean(name, NAMES)}")
    wanted = set(only or NAMES)
    names = tuple(dict.fromkeys(names))
    imu = imu or ImuParameters()
    counts = counts_of(imu)
    costs = {name: estimate(counts, named.library(name), tables) for name in names}
    errors = {name: worst(name, imu, samples, seed) for name in names if name != REFERENCE}
    found = [sweep.find(name, errors.get(name)) for sweep in SWEEPS if sweep.name in wanted for name in names]
    for event, findings in EVENTS.items():
        if event in wanted:
            found += findings(names, errors)
    for name, rows in OUTSIDE.items():
        if name in wanted:
            found += rows()
    return ExtremesReport(imu, names, seed, errors, costs, estimate(counts, RTS, tables), tuple(found))
