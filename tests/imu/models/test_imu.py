"""The models compute equations 4.1 to 4.8 as exact arithmetic does, and have the expected values at rest.

A NaN or an infinity in the input is refused with its axis in every arithmetic.
"""

from __future__ import annotations

from fractions import Fraction as F
from math import atan2, degrees, inf, nan
from random import Random
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from periph_sim.imu.models.chips import Magnetometer
from periph_sim.imu.models.imu import INPUTS, Imu, Inputs, Noise, NotFinite, State
from periph_sim.imu.models.parameters import (
    AccelerometerParameters,
    GyroscopeParameters,
    ImuParameters,
    MagnetometerParameters,
)
from periph_sim.imu.numeric import arithmetic_names as named
from periph_sim.imu.numeric.float64 import Float64
from tests.imu.extremes.test_working_range import STATED
from tests.imu.models import exact
from tests.imu.models.exact import Turn, Vector
from tests.imu.models.recording import codes_of

FLOATS = ("float64", "float32")
WRONG = (nan, inf, -inf)


@pytest.mark.parametrize("name", FLOATS)
@pytest.mark.parametrize("value", WRONG)
@pytest.mark.parametrize("axis", range(15))
def test_a_refused_sample_is_reported_with_its_first_wrong_axis(name: str, value: float, axis: int) -> None:
    a = named.scalar(name)
    model = Imu(a, ImuParameters())
    values = [a.constant(0.0)] * 15
    values[axis:] = [a.constant(value)] * (15 - axis)
    attitude, acceleration, *chips = (tuple(values[first : first + 3]) for first in range(0, 15, 3))
    with pytest.raises(NotFinite) as caught:
        model.step(attitude, acceleration, Noise(*chips), model.at_rest)
    assert str(caught.value) == f"{INPUTS[axis]}: {value}; expected a finite number"


ZERO = (0.0, 0.0, 0.0)
SENSORS = ("gyroscope", "accelerometer", "magnetometer")
FIRST = {
    "rates": "as built",
    "wrap": "as built",
    "spherical": "four-quadrant",
    "norm": "squares",
    "rounding": "nearest",
}
MOUNTINGS = ((1, 2, 3), (2, -1, 3), (-3, 1, 2), (3, -2, -1))


def floats(value: Any) -> Any:
    """Convert fractions, alone or in tuples and dicts, to the nearest floats."""
    if isinstance(value, dict):
        return {name: floats(one) for name, one in value.items()}
    if isinstance(value, tuple):
        return tuple(floats(one) for one in value)
    return float(value) if isinstance(value, F) else value


def angle(of: Turn) -> float:
    return atan2(of.s, of.c)


class Sample:
    """One sample and its parameters, drawn as fractions; no term of an equation is 0, and no two are equal.

    wide: exceed the ranges of the converters too.
    choices: choices of the models other than FIRST.
    """

    def __init__(self, seed: int, *, wide: bool = True, **choices: str) -> None:
        self.random = random = Random(seed)
        self.choices = FIRST | choices
        self.turns = exact.turn(self.number(2)), exact.turn(self.number("0.8")), exact.turn(self.number(2))
        self.steps = self.vector("0.75" if wide else "0.16")  # rad in a period
        if self.choices["wrap"] == "unwrapped":
            about = exact.vector(random.choice((-6, 6)), 0, random.choice((-6, 6)))
            self.steps = exact.total(self.steps, about)
        self.pushed, self.body_before = self.vector(3 if wide else "1.5"), self.vector(5)
        self.noise = self.vector(2), self.vector("0.1"), self.vector("0.05")
        self.gyroscope = {"mounting": random.choice(MOUNTINGS), "bias": self.vector(5), "g_sens": self.number(2)}
        self.gyroscope |= {"scale": F("14.375"), "cross_axis": self.number("0.05")}
        self.accelerometer = {"lever_arm": self.vector("0.1"), "bias": self.vector("0.2")}
        self.accelerometer |= {"scale": F(256), "cross_axis": self.number("0.05")}
        self.magnetometer = {"scale": F(660), "cross_axis": self.number("0.01"), "hard_iron": self.vector("0.2")}
        seen = exact.spherical_to_cartesian(
            abs(self.number(4 if wide else "0.6")) + F("0.1"), self.turn(4), self.turn("0.6")
        )
        self.magnetometer["earth_field"] = exact.earth_field_of(seen, self.magnetometer["hard_iron"], *self.turns)
        self.board = {"azimuth_pcb": self.turn("0.5"), "elevation_pcb": self.turn("0.25")}

    def number(self, most: int | str) -> F:
        return F(most) * F(self.random.randint(1, 999), 1000) * self.random.choice((-1, 1))

    def turn(self, most: int | str) -> Turn:
        return exact.turn(self.number(most))

    def vector(self, most: int | str) -> Vector:
        return self.number(most), self.number(most), self.number(most)

    @property
    def imu(self) -> ImuParameters:
        """Return the parameters and choices for the models."""
        converter = {"rounding": self.choices["rounding"]}
        field = {name: self.choices[name] for name in ("spherical", "norm", "rounding")}
        azimuth, elevation = (degrees(angle(one)) for one in self.board.values())
        return ImuParameters(
            AccelerometerParameters(**floats(self.accelerometer), **converter),
            GyroscopeParameters(**floats(self.gyroscope), rates=self.choices["rates"], **converter),
            MagnetometerParameters(
                **floats(self.magnetometer), board_azimuth=azimuth, board_elevation=elevation, **field
            ),
            period=float(exact.PERIOD),
            wrap=self.choices["wrap"],
        )

    def by_models(self, a: Any, exact_lsb: bool = False) -> tuple[list[Any], tuple[Vector, Vector]]:
        """Return nine codes or exact LSB in this arithmetic, and the attitudes, now and before, given to the models."""
        now = tuple(a.constant(angle(one)) for one in self.turns)
        before = tuple(a.constant(angle(one) - float(step)) for one, step in zip(self.turns, self.steps, strict=True))
        given = [
            tuple(a.constant(axis) for axis in floats(three)) for three in (*self.noise, self.pushed, self.body_before)
        ]
        model, noise = Imu(a, self.imu), Noise(*given[:3])
        if exact_lsb:
            turned, body = model.motion(now, before)
            inputs = Inputs(turned, given[3], body, given[4], noise)
            codes = [model.lsb_of(chip, inputs) for chip in SENSORS]
        else:
            codes, _ = model.step(now, given[3], noise, State(before, given[4]))
        held = [exact.vector(*(float(a.value(axis)) for axis in attitude)) for attitude in (now, before)]
        return [axis for chip in codes for axis in chip], (held[0], held[1])

    def by_equations(self, attitudes: tuple[Vector, Vector]) -> list[F]:
        """Return the same nine values in LSB before the converter, computed without the models."""
        phi, theta, _ = self.turns
        rates = exact.derivative(*attitudes, wrap=self.choices["wrap"])
        body = exact.body_rates(rates, phi, theta) if self.choices["rates"] == "corrected" else rates
        change = exact.times(1 / exact.PERIOD, exact.minus(body, self.body_before))
        rate, force, field = self.noise
        spherical = self.choices["spherical"]
        return [
            *exact.gyroscope(body, self.pushed, rate, **self.gyroscope),
            *exact.accelerometer(phi, theta, self.pushed, body, change, force, **self.accelerometer),
            *exact.magnetometer(*self.turns, field, spherical=spherical, **self.magnetometer, **self.board),
        ]


ALL_CHOICES = [
    {"rates": "as built"},
    {"rates": "corrected", "norm": "mag", "rounding": "floor"},
    {"rates": "corrected", "spherical": "rotation", "rounding": "toward zero"},
    {"rates": "corrected", "spherical": "rotation", "norm": "mag", "wrap": "unwrapped"},
    {"spherical": "plain", "wrap": "unwrapped"},
    {"spherical": "plain", "norm": "mag"},
]


@pytest.mark.parametrize("choices", ALL_CHOICES, ids=lambda choices: ", ".join(choices.values()))
def test_float64_agrees_with_exact_arithmetic_to_a_billionth_of_an_lsb(choices: dict[str, str]) -> None:
    full_scale = 0
    for seed in range(25):
        sample = Sample(seed, **choices)
        values, attitudes = sample.by_models(Float64(), exact_lsb=True)
        wanted = sample.by_equations(attitudes)
        assert values == pytest.approx([float(one) for one in wanted], rel=0, abs=1e-9), seed
        bits = [getattr(sample.imu, name).bits for name in SENSORS for _ in range(3)]
        codes = [exact.code(*one, sample.choices["rounding"]) for one in zip(wanted, bits, strict=True)]
        assert sample.by_models(Float64())[0] == codes, seed
        full_scale += sum(abs(one) >= 2 ** (of - 1) for one, of in zip(wanted, bits, strict=True))
    assert full_scale > 10  # so that the limits of the converters are tested too


AS_BUILT = {"rates": "as built"}
MOVING = {"rates": "corrected", "spherical": "rotation", "norm": "mag"}
BOUNDS = [
    *(pytest.param(name, AS_BUILT, bounds, id=f"{name}, as built") for name, bounds in STATED.items()),
    pytest.param("float32", MOVING, (0.02, 0.02, 0.02), id="float32, moving"),
    pytest.param("q16", MOVING, (1.4, 1.0, 0.12), id="q16, moving"),
]


@pytest.mark.parametrize(("name", "choices", "bounds"), BOUNDS)
def test_errors_of_other_arithmetics_are_within_the_stated_bounds(name: str, choices: dict, bounds: tuple) -> None:
    """The bounds are those of test_working_range, as in the dissertation, and with corrected rates and a lever arm."""
    for seed in range(25):
        sample = Sample(seed, wide=False, **choices)
        if choices is AS_BUILT:
            sample.accelerometer["lever_arm"] = exact.vector(0, 0, 0)
            sample.board = dict.fromkeys(sample.board, exact.turn(F(0)))
        a = named.scalar(name)
        values, attitudes = sample.by_models(a, exact_lsb=True)
        off = [abs(float(a.value(x)) - y) for x, y in zip(values, sample.by_equations(attitudes), strict=True)]
        assert all(max(off[3 * i : 3 * i + 3]) <= most for i, most in enumerate(bounds)), (seed, off)


@pytest.mark.parametrize("spherical", ["four-quadrant", "rotation"])
def test_a_field_along_z_keeps_its_direction(spherical: str) -> None:
    """Its azimuth is atan2(0, 0), which is 0."""
    sensor = MagnetometerParameters(spherical=spherical)
    for z in (-0.3, 0.0):
        assert Magnetometer(Float64(), sensor).on_board((0.0, 0.0, z)) == pytest.approx((0, 0, z))


def test_codes_at_rest_and_level() -> None:
    """Biases of Table 4.1 transformed by S are the emulated means of Table 5.1, within half a code."""
    model = Imu(Float64(), ImuParameters())
    codes, left = model.step(ZERO, ZERO, model.silence, model.at_rest)
    assert codes.gyroscope == (round(14.375 * (-3.10 + 0.02 * 3.64)), round(14.375 * (3.60 - 0.02 * 3.06)), 1)
    assert codes.accelerometer == (round(256 * (-0.02 + 0.01 * -0.98)), round(256 * (0.02 + 0.01 * -1.02)), -256)
    field = 0.3239 - 0.16, -0.0447 + 0.17, 0.0060 - 0.02
    crossed = [0.998 * axis + 0.002 * sum(field) for axis in field]
    assert codes.magnetometer == tuple(round(660 * axis) for axis in crossed)
    assert left == State(ZERO, ZERO)


def test_corrected_rates_agree_with_the_rotation_and_rates_as_built_do_not() -> None:
    """The rotation between samples gives the true rate; a backward difference over 20 ms is slightly off."""
    t = np.arange(2000) * 0.02
    phi, theta, psi = 1.2 * np.sin(1.1 * t + 0.3), 0.9 * np.sin(0.7 * t + 1), 2.5 * np.sin(0.31 * t)
    to_earth = Rotation.from_euler("ZYX", np.column_stack([psi, theta, phi]))  # yaw, pitch, roll; z down
    true = np.degrees((to_earth[:-1].inv() * to_earth[1:]).as_rotvec()) / 0.02
    off = {}
    for rates in ("corrected", "as built"):
        imu = ImuParameters(gyroscope=GyroscopeParameters(rates=rates, bias=ZERO, cross_axis=0.0))
        codes = codes_of(imu, np.column_stack([phi, theta, psi]).tolist(), [ZERO] * len(t))
        came = np.array([one.gyroscope for one in codes])[1:] / 14.375
        off[rates] = np.abs(came - true).max()
    assert off["corrected"] < 0.8 and off["as built"] > 30
