"""The models for whole recordings: from arrays of attitude, acceleration and noise to arrays of codes.

The equations are those for one sample, and are applied to pieces of the arrays that fit into the cache. A code depends
only on its sample and the sample before, so the length of the pieces does not affect the codes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..numeric.arithmetic import Triple
from ..numeric.float64_arrays import Float64Arrays, Floats
from . import parameters
from .imu import INPUTS, Codes, Imu, Inputs, Noise, NotFinite, inputs_of

PIECE = 8192  # number of samples of a piece; the working set fits into the second-level cache

Int16s = NDArray[np.int16]


def codes_of(
    imu: parameters.ImuParameters,
    attitude: Triple[Floats],
    acceleration: Triple[Floats],
    noise: Noise[Floats] | None = None,
    *,
    piece: int = PIECE,
) -> Codes[Int16s]:
    """Return nine arrays int16[n] of LSB, computed in float64.

    attitude: roll, pitch and yaw, float64[n] in rad. The rates of the first sample are zero, because there is no
        attitude before it.
    acceleration: linear acceleration along x, y and z, float64[n] in g.
    noise: nine arrays float64[n] in deg/s, g and gauss, or none.

    Raise ValueError if the arrays differ in length. Raise NotFinite, with axis and sample, for a NaN or an infinity.
    """
    length = len(attitude[0])
    model = Imu(Float64Arrays(), imu)
    given = inputs_of(attitude, acceleration, noise)
    if any(len(array) != length for array in given):
        raise ValueError(f"arrays of {', '.join(str(len(array)) for array in given)} samples; expected the same of all")
    for axis, array in zip(INPUTS, given, strict=False):
        finite = np.isfinite(array)
        if not finite.all():
            index = int(np.argmin(finite))
            raise NotFinite(axis, float(array[index]), index)
    out = np.empty((9, length), dtype=np.int16)
    last = tuple(angle[:1] for angle in attitude)
    x, y, z = model.at_rest.body
    body_last = np.atleast_1d(x), np.atleast_1d(y), np.atleast_1d(z)
    with np.errstate(all="ignore"):  # the arithmetic defines the results of x/0 and overflow
        for begin in range(0, length, piece):
            here = slice(begin, begin + piece)
            now = cut(attitude, here)
            turned, body = model.motion(now, _behind(last, now))
            added = model.silence if noise is None else Noise(*(cut(chip, here) for chip in noise))
            codes = model.codes(Inputs(turned, cut(acceleration, here), body, _behind(body_last, body), added))
            for row, values in zip(out, (values for chip in codes for values in chip), strict=True):
                row[here] = values
            last, body_last = _last(now), _last(body)
    return Codes((out[0], out[1], out[2]), (out[3], out[4], out[5]), (out[6], out[7], out[8]))


def cut(arrays: Triple[Floats], here: slice) -> Triple[Floats]:
    """Return a part of each of three arrays."""
    return arrays[0][here], arrays[1][here], arrays[2][here]


def _behind(last: tuple[Floats, ...], now: Triple[Floats]) -> Triple[Floats]:
    """Delay each array by one sample: prepend the last value before it and remove its own last value."""
    x, y, z = (np.concatenate((first, array[:-1])) for first, array in zip(last, now, strict=True))
    return x, y, z


def _last(arrays: Triple[Floats]) -> Triple[Floats]:
    return arrays[0][-1:], arrays[1][-1:], arrays[2][-1:]
