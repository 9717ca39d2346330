"""Sensor noise as a function of the sample number: float64 values that follow from a seed, a stream name and a number.

    (seed, "gyroscope/x/white") --> Gaussian --> value n, independent of earlier calls
    NoiseTerms of an axis       --> AxisNoise --> white + bias instability + random walk

Value n of a stream is a function of (seed, name, n) alone, so a run that is split, resumed or read sample by sample has
the same bits. Each block of `BLOCK` values begins with its own counter of numpy's Philox, a counter-based generator
(Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC11). The key is a hash of seed and name. Only the
random walk is a sum, so its steps must be added up from sample 0 to n.

Terms as in IEEE Std 952 annex C: N (white), B (bias instability), K (random walk); dissertation section 4.3.4.
"""

# core: compiled

from __future__ import annotations

from hashlib import blake2b
from itertools import chain
from math import log, pi, sqrt
from typing import TYPE_CHECKING, Any, TypeAlias

from msgspec import Struct

from ..form.c_types import BigInt
from .models.imu import Noise
from .models.parameters import ImuParameters
from .near_gaussian import FEW, NEAR, first_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats: TypeAlias = NDArray[np.float64]

BLOCK = 1024  # number of values in a block; with this number, a single value of any block takes about 30 us
# Number of octaves of the bias instability. Its Allan deviation is flat up to 2**23 samples, which are 46 h at 50 Hz.
OCTAVES = 24
WALKED_AT_ONCE = 1 << 20  # maximum number of steps of a random walk that are in memory together
AXES = ("x", "y", "z")


class Gaussian:
    """A stream of independent standard normal values, which are numbered 0, 1, 2 ..."""

    key: BigInt

    def __init__(self, seed: int, name: str) -> None:
        self.key = int.from_bytes(blake2b(f"{seed}/{name}".encode(), digest_size=16).digest(), "little")

    def values(self, first: int, count: int) -> Floats:
        """Return values `first` up to `first + count - 1`."""
        import numpy as np

        blocks = range(first // BLOCK, -(-(first + count) // BLOCK))
        joined = np.concatenate([np.empty(0), *map(self._values_of, blocks)])
        begin = first % BLOCK
        return joined[begin : begin + count]

    def near(self, number: int) -> float | None:
        """Return value `number` with an error of at most NEAR, without numpy; None if this is not possible."""
        block, place = number // BLOCK, number % BLOCK
        return first_of(self.key, block)[place] if place < FEW and number >= 0 else None

    def _values_of(self, block: int) -> Floats:
        import numpy as np

        # The number of the block is the second word of the counter, so blocks with up to 2**64 draws do not overlap.
        generator = np.random.Generator(np.random.Philox(key=self.key, counter=[0, block, 0, 0]))
        return generator.standard_normal(BLOCK)


class NoiseTerms(Struct, frozen=True):
    """The coefficients of the noise of one axis, finite numbers of 0 or more. `unit` is the unit of the sensor.

    density: N squared, the density of white noise, in unit**2 s.
    bias_instability: B, in unit.
    random_walk: K, in unit/sqrt(s).
    """

    density: float
    bias_instability: float = 0.0
    random_walk: float = 0.0


class AxisNoise:
    """The noise of one axis of a sensor.

    terms: the coefficients of the noise.
    period: the time between two samples in seconds.
    seed: the seed of all streams.
    stream: the name of the axis, such as "gyroscope/x".
    """

    _step: float
    _white_sigma: float
    _octave_sigma: float

    def __init__(self, terms: NoiseTerms, period: float, seed: int, stream: str) -> None:
        self._white_sigma = sqrt(terms.density / period)
        self._white = Gaussian(seed, f"{stream}/white")
        # Octaves of equal variance v have the one-sided spectral density v / (f ln 2).
        # The bias instability B has the one-sided spectral density B**2 / (pi f) by definition.
        self._octave_sigma = terms.bias_instability * sqrt(log(2) / pi)
        self._octaves = [
            Gaussian(seed, f"{stream}/bias instability/{octave}")
            for octave in range(OCTAVES if terms.bias_instability else 0)
        ]
        self._step = terms.random_walk * sqrt(period)
        self._walk = Gaussian(seed, f"{stream}/random walk")
        # The number of the sample after the last calculated sample, and the value of the random walk at this sample.
        self._walked = (0, 0.0)
        self._block: int | None = None  # number of the block whose samples `_kept` contains
        self._kept: list[float] = []

    def values(self, first: int, count: int) -> Floats:
        """Return samples `first` up to `first + count - 1`, in the sensor's unit."""
        noise = self._white.values(first, count) * self._white_sigma
        if self._octaves:
            noise += self._flicker(first, count)
        if self._step and count:
            noise += self._walk_values(first, count)
        return noise

    def at(self, number: int) -> float:
        """Return sample `number`. The samples of the last block that was used are cached."""
        block, place = number // BLOCK, number % BLOCK
        if block != self._block:
            self._block, self._kept = block, self.values(block * BLOCK, BLOCK).tolist()
        return self._kept[place]

    def near(self, number: int) -> tuple[float, float] | None:
        """Return an approximation of sample `number` and its maximum error, calculated without numpy.

        Return None if this is not possible: if the noise has other terms than white noise, or if `Gaussian.near`
        returns None.
        """
        white = None if self._octaves or self._step else self._white.near(number)
        return None if white is None else (white * self._white_sigma, NEAR * self._white_sigma)

    def _flicker(self, first: int, count: int) -> Floats:
        """Return 1/f noise, which is the sum of all octaves.

        Octave k is a noise that has a new value every 2**k samples. The key of its stream determines at which samples
        the value changes.
        """
        import numpy as np

        total = np.zeros(count)
        numbers = np.arange(first, first + count)
        for k, octave in enumerate(self._octaves):
            begin = _hold(octave, k, first)
            held = octave.values(begin, _hold(octave, k, first + count) - begin + 1)
            total += held[((numbers + _phase(octave, k)) >> k) - begin]
        return total * self._octave_sigma

    def _walk_values(self, first: int, count: int) -> Floats:
        begin, total = self._walked if self._walked[0] <= first else (0, 0.0)
        while begin < first:
            stretch = min(first - begin, WALKED_AT_ONCE)
            total = float(self._sums(begin, stretch, total)[-1])
            begin += stretch
        sums = self._sums(first, count, total)
        self._walked = (first + count, float(sums[-1]))
        return sums[:-1]

    def _sums(self, begin: int, count: int, total: float) -> Floats:
        """Return the random walk at sample `begin` and after each of `count` steps, which are added one by one.

        total: the value of the random walk at sample `begin`.
        """
        import numpy as np

        return np.cumsum(np.concatenate([[total], self._walk.values(begin, count) * self._step]))


def _phase(octave: Gaussian, k: int) -> int:
    return octave.key & ((1 << k) - 1)


def _hold(octave: Gaussian, k: int, number: int) -> int:
    """Return the index, in the stream `octave`, of the value that is used at sample `number`.

    octave: the stream of octave k. Each value of this stream is used for 2**k samples.
    """
    return (number + _phase(octave, k)) >> k


class ImuNoise:
    """Noise of the three sensors of an IMU on x, y, z, in deg/s, g and gauss.

    The models add the noise before they multiply by the matrix S, which has scale and cross-axis sensitivity.
    """

    def __init__(self, imu: ImuParameters, seed: int) -> None:
        self._sensors = [_axes_of(name, getattr(imu, name), imu.period, seed) for name in Noise._fields]

    def values(self, first: int, count: int) -> Noise[Floats]:
        """Return samples `first` up to `first + count - 1` as nine arrays float64[count]."""
        sensors = [[axis.values(first, count) for axis in axes] for axes in self._sensors]
        return Noise(*[(x, y, z) for x, y, z in sensors])

    def at(self, number: int) -> Noise[float]:
        """Return the noise of sample `number`, which has the same bits as in `values`."""
        sensors = [[axis.at(number) for axis in axes] for axes in self._sensors]
        return Noise(*[(x, y, z) for x, y, z in sensors])

    def near(self, number: int) -> list[tuple[float, float]] | None:
        """Return approximations of the nine values of sample `number`, each with its maximum error.

        The approximations are calculated without numpy. Return None if this is not possible for all values.
        """
        found = []
        for axis in chain(*self._sensors):
            value = axis.near(number)
            if value is None:
                return None
            found.append(value)
        return found


def _axes_of(name: str, sensor: Any, period: float, seed: int) -> list[AxisNoise]:
    columns = zip(AXES, sensor.noise_density, sensor.bias_instability, sensor.random_walk, strict=True)
    return [AxisNoise(NoiseTerms(*terms), period, seed, f"{name}/{axis}") for axis, *terms in columns]
