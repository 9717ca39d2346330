"""The math tables of the boot ROM agree with calculations by other means than those that generated them."""

from __future__ import annotations

import math
from decimal import Decimal, localcontext
from struct import pack, unpack

from periph_sim.processor.image.elsewhere import MATH_TABLES
from periph_sim.processor.image.rom_tables import words
from tests.processor.image.rig import HEAD, Rig


def fixed(address: int, count: int) -> list[int]:
    """Return signed 32-bit numbers from an address on."""
    begin = address - MATH_TABLES.start
    return list(unpack(f"<{count}i", pack(f"<{2 * count}H", *words()[begin : begin + 2 * count])))


def floating(address: int, count: int) -> list[float]:
    return list(unpack(f"<{count}f", pack(f"<{count}i", *fixed(address, count))))


def circle() -> list[Decimal]:
    """Return sin(2 pi k / 512) for k = 0 to 640, by rotations; halving the angle of a square gives the first one."""
    with localcontext() as context:
        context.prec = 50
        cosine = Decimal(0)
        for _ in range(7):
            cosine = ((1 + cosine) / 2).sqrt()
        sine, x, y, found = (1 - cosine * cosine).sqrt(), Decimal(1), Decimal(0), []
        for _ in range(641):
            found.append(y)
            x, y = x * cosine - y * sine, x * sine + y * cosine
        return found


def test_the_tables_have_the_size_of_their_address_range():
    assert len(words()) == len(MATH_TABLES) == 0x0B50 + 0x8C + 0x06A0


def test_sines_are_those_of_a_rotation():
    exact = circle()
    assert fixed(0x3FE000, 641) == [round(one * 2**30) for one in exact]
    assert floating(0x3FEBDC, 641) == [unpack("<f", pack("<f", round(one, 12)))[0] for one in exact]
    assert fixed(0x3FEDDC, 1) == [-(2**31)]  # TI's sample at pi is -0.0
    assert floating(0x3FECDC, 1) == [1.0]  # where TI's images look for the cosine of 0


def test_quotients_and_square_roots_are_correctly_rounded():
    limits, *quotients = fixed(0x3FE510, 257)
    assert limits == 0
    for n, word in enumerate(quotients[:128]):
        assert 2 * abs(word * (257 + 2 * n) - 512 * 2**29) <= 257 + 2 * n
    assert quotients[128:] == [-word for word in reversed(quotients[:128])]
    for n, word in enumerate(fixed(0x3FE724, 128)):
        assert (2 * word - 1) ** 2 < 2**62 * 512 / (257 + 2 * n) < (2 * word + 1) ** 2


def test_three_points_of_each_interval_lie_on_the_arctangent():
    coefficients = [word / 2**30 for word in fixed(0x3FE862, 195)]
    for n in range(65):
        a0, a1, a2 = coefficients[3 * n : 3 * n + 3]
        for x in ((2 * n + half) / 128 for half in range(3)):
            assert abs(math.tan(a0 + a1 * x + a2 * x * x) - x) < 5e-9
    assert all(abs(one - other) < 1e-7 for one, other in zip(floating(0x3FF0E2, 195), coefficients, strict=True))


def test_arguments_of_the_exponential_lie_between_its_limits():
    limits = fixed(0x3FEB50, 60)
    for q in range(1, 31):
        most, least = (limits[2 * q - 2 + n] / 2**q for n in range(2))
        step = math.exp(0.5 / 2**q) * 1.0001
        assert 1 / step < math.exp(most) * 2**q / 2**31 < step
        assert 1 / step < math.exp(least) * 2**q < step or least == -(2.0 ** (31 - q))
    assert [1 / one for one in floating(0x3FF268, 10)] == [
        1 / unpack("<f", pack("<f", 1 / n))[0] for n in range(11, 1, -1)
    ]
    assert [round(2**31 / word) for word in fixed(0x3FEBC8, 10)] == list(range(11, 1, -1))


def test_limits_and_rounding_constants_of_products():
    limits = fixed(0x3FE9E8, 180)
    assert limits[::6] == [2 ** (q - 1) for q in range(30, 0, -1)]
    assert limits[3::6] == [2 ** (q - 1) - 1 for q in range(30, 0, -1)]
    assert limits[5::6] == [-(2 ** (q - 1)) for q in range(30, 0, -1)]


def test_a_program_reads_the_tables():
    rig = Rig(HEAD + " MOVL XAR4,#0x3FECDC\n MOVL ACC,*XAR4\n ESTOP0").run()
    assert rig.program.finished and rig.cpu.acc == 0x3F80_0000 and rig.notes() == []


def test_constants_at_the_start_of_the_tables():
    assert fixed(0x3FE502, 7) == [2 * 2**29, 1, 0, -2, 0, 0, -1]
    assert fixed(0x3FE712, 9) == [3 * 2**29, 0x8000, 0, -0x1_0000, 0x7FFF, 2**30, 2**29, math.isqrt(2**59) + 1, 0]
    two, *halves = fixed(0x3FE824, 31)
    assert two == 2 * 2**29 and [round(2**31 * math.atan(1) / 2 ** (30 - q)) for q in range(1, 31)] == halves
