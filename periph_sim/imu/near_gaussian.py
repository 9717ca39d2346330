"""The first standard normal values of a block of `noise`, without numpy, whose import takes longer than many runs.

    key, block --Philox 4x64--> words of 64 bits --ziggurat--> values within NEAR of numpy's, or None

The ziggurat method covers the normal curve with 256 layers of equal area (Marsaglia and Tsang, "The ziggurat method",
J. Stat. Software 5, 2000). A value is a place in one of the layers. The lowest byte of a word selects the layer, a bit
selects the sign, and 52 bits select the place. Of 1000 words, 985 select a place that is certainly under the curve.
Only these words give a value; the others give None. The edges of the layers differ from numpy's in their last bits. So
the values are for callers that round them and check that the maximum error cannot change the rounded value.
"""

from __future__ import annotations

from functools import cache, lru_cache
from itertools import pairwise
from math import exp, log, sqrt

FEW = 8  # number of values of a block that are calculated
NEAR = 1e-12  # maximum error of a value; the error of an edge is a thousandth of NEAR

LAYERS = 256
OUTERMOST = 3.6541528853610088  # edge of the outermost layer of the curve, beyond which the tail begins
AREA = 0.00492867323397465  # area of each layer
STEPS = 1 << 52  # number of places in a layer
UNSURE = 1 << 14  # number of places next to an edge that give no value, about 1000 times the error of the edge

WORD = (1 << 64) - 1
# Constants of the random generator Philox 4x64 (Salmon et al., SC11). It has ROUNDS rounds. Each round multiplies two
# words by MULTIPLIERS, and then adds WEYL to the key.
MULTIPLIERS = 0xD2E7470EE14C6C93, 0xCA5A826395121157
WEYL = 0x9E3779B97F4A7C15, 0xBB67AE8584CAA73B
ROUNDS = 10


@lru_cache(maxsize=64)  # Nine axes use one block each, and several scenes may use the same blocks.
def first_of(key: int, block: int) -> tuple[float | None, ...]:
    """Return the first FEW values of a block of 1024 values (see `noise`).

    A value for which numpy might need more than one word is None. All values after it are None, too.

    key: the key of a stream.
    block: the number of the block.
    """
    words = [word for counter in range(1, FEW // 4 + 1) for word in philox(key, (counter, block, 0, 0))]
    found: list[float | None] = []
    for word in words:
        found.append(_value(word) if None not in found else None)
    return tuple(found)


def philox(key: int, counter: tuple[int, int, int, int]) -> tuple[int, int, int, int]:
    """Return the four random words of 64 bits that Philox 4x64 generates for a key of 128 bits and a counter."""
    a, b, c, d = counter
    low, high = key & WORD, key >> 64
    for _ in range(ROUNDS):
        first, second = MULTIPLIERS[0] * a, MULTIPLIERS[1] * c
        a, b, c, d = second >> 64 ^ b ^ low, second & WORD, first >> 64 ^ d ^ high, first & WORD
        low, high = low + WEYL[0] & WORD, high + WEYL[1] & WORD
    return a, b, c, d


def _value(word: int) -> float | None:
    layer, negative, along = word & 0xFF, word >> 8 & 1, word >> 9 & STEPS - 1
    edge, inner = _layers()[layer]
    if along > inner - UNSURE:
        return None
    value = along * edge / STEPS
    return -value if negative else value


@cache
def _layers() -> list[tuple[float, float]]:
    """Return, for each layer of the ziggurat (see the head of this module), its outer edge and a number of places.

    The places are those from 0 to the edge of the next narrower layer, so they are certainly under the curve. Layer 0
    is wider than the curve at OUTERMOST, because it includes the tail.
    """
    height = exp(-0.5 * OUTERMOST * OUTERMOST)
    edges = [OUTERMOST]
    for _ in range(LAYERS - 2):
        edges.append(sqrt(-2 * log(AREA / edges[-1] + height)))
        height = exp(-0.5 * edges[-1] * edges[-1])
    edges += [0.0]  # the inner edge of the innermost layer
    base = AREA / exp(-0.5 * OUTERMOST * OUTERMOST)
    inside = [(outer, inner / outer * STEPS) for outer, inner in pairwise(edges)]
    return [(base, OUTERMOST / base * STEPS), *reversed(inside)]
