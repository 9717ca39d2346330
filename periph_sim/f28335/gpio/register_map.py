"""Table of the GPIO registers as in the manual, 0x6F80 to 0x6FFF.

The ports are A (GPIO0-31), B (32-63) and C (64-87). Control registers are 32 bits wide and EALLOW-protected, data
registers 32 bits wide and unprotected; the interrupt selects are 16 bits wide, GPIOLPMSEL 32, and both protected. The
bus accesses a 32-bit register as two words, the low word at the even offset.

Names are those of C2000Ware's DSP2833x_Gpio.h. Source: SPRUFB0D sections 6.2, 6.3 and 6.6 (Tables 39 to 41, Figures 47
to 72).
"""

from __future__ import annotations

from ...core.registers import Field, Register, RegisterMap, field

BASE = 0x6F80
PINS = 88  # GPIO0 to GPIO87
# The mask of each pin. Compiled modules use it instead of `1 << pin`, which they compute with 64 bits only.
BIT = tuple(1 << pin for pin in range(PINS))
PORT_OF = {"A": range(32), "B": range(32, 64), "C": range(64, 88)}

# Word offsets in a port's control block (16 words) and data block (8 words).
CTRL, QSEL1, QSEL2, MUX1, MUX2, DIR, PUD = 0x0, 0x2, 0x4, 0x6, 0x8, 0xA, 0xC
DAT, SET, CLEAR, TOGGLE = 0x0, 0x2, 0x4, 0x6
CONTROL_WORDS, DATA_WORDS = 0x10, 0x08
DATA = 0x40  # offset of port A's data block
SELECT = 0x60  # offset of GPIOXINT1SEL, the first register after the data blocks
XINT_SELECTS = (0x60, 0x61, 0x63, 0x64, 0x65, 0x66, 0x67)  # offsets of GPIOXINT1SEL to GPIOXINT7SEL
XINT_FIRST_PIN = (0, 0, 32, 32, 32, 32, 32)  # for each of these registers, the GPIO number that its value 0 selects


def _bits(pins: range, access: str = "R/W", reset: int = 0) -> tuple[Field, ...]:
    """Return the fields of a register with one bit per pin. reset: the reset value of the whole register."""
    return tuple(field(f"GPIO{pin}", f"{i}", access, reset >> i & 1) for i, pin in enumerate(pins))


def _pairs(pins: range) -> tuple[Field, ...]:
    """Return the fields of a register with two bits per pin."""
    return tuple(field(f"GPIO{pin}", f"{2 * i + 1}:{2 * i}") for i, pin in enumerate(pins))


def _control(port: str) -> tuple[Register, ...]:
    pins = PORT_OF[port]
    base = CONTROL_WORDS * "ABC".index(port)
    low, high = pins[:16], pins[16:]

    def register(name: str, at: int, source: str, fields: tuple[Field, ...]) -> Register:
        return Register(f"GP{port}{name}", base + at, f"SPRUFB0D {source}", fields, protected=True, width=32)

    qualification: tuple[Register, ...] = ()
    if port != "C":  # port C has no qualification
        periods = tuple(
            field(f"QUALPRD{i}", f"{8 * i + 7}:{8 * i}", doc="Sampling period: 0 is 1 SYSCLKOUT, else twice the value.")
            for i in range(4)
        )
        qualification = (
            register("CTRL", CTRL, "Figures 53, 54", periods),
            register("QSEL1", QSEL1, "Figures 55, 57", _pairs(low)),
            register("QSEL2", QSEL2, "Figures 56, 58", _pairs(high)),
        )
    return (
        *qualification,
        register("MUX1", MUX1, "Figures 47, 49, 51", _pairs(low)),
        register("MUX2", MUX2, "Figures 48, 50, 52", _pairs(high)),
        register("DIR", DIR, "Figures 59 to 61", _bits(pins)),
        register("PUD", PUD, "Figures 62 to 64", _bits(pins, reset=0xFFF if port == "A" else 0)),
    )


def _data(port: str) -> tuple[Register, ...]:
    pins = PORT_OF[port]
    base = DATA + DATA_WORDS * "ABC".index(port)
    return (
        Register(f"GP{port}DAT", base + DAT, "SPRUFB0D Figures 65 to 67", _bits(pins), width=32),
        Register(f"GP{port}SET", base + SET, "SPRUFB0D Figures 68 to 70", _bits(pins, "W1"), width=32),
        Register(f"GP{port}CLEAR", base + CLEAR, "SPRUFB0D Figures 68 to 70", _bits(pins, "W1"), width=32),
        Register(f"GP{port}TOGGLE", base + TOGGLE, "SPRUFB0D Figures 68 to 70", _bits(pins, "W1"), width=32),
    )


def _select(name: str, offset: int, port: str) -> Register:
    which = field("GPIOSEL", "4:0", doc=f"Number of the pin within port {port}.")
    return Register(name, offset, "SPRUFB0D Figure 71, Tables 80 to 84", (which,), protected=True)


GPIO = RegisterMap(
    "GPIO",
    "SPRUFB0D section 6",
    (
        *_control("A"),
        *_control("B"),
        *_control("C"),
        *_data("A"),
        *_data("B"),
        *_data("C"),
        _select("GPIOXINT1SEL", 0x60, "A"),
        _select("GPIOXINT2SEL", 0x61, "A"),
        _select("GPIOXNMISEL", 0x62, "A"),
        *(_select(f"GPIOXINT{n}SEL", 0x60 + n, "B") for n in range(3, 8)),
        Register("GPIOLPMSEL", 0x68, "SPRUFB0D Figure 72", _bits(PORT_OF["A"]), protected=True, width=32),
    ),
)


def control_register(what: str, pin: int) -> str:
    """Return the name of the control register that has the field of `pin`. what: the kind of register.

    For example, the result is "GPBMUX1" for the kind "MUX" and pin 32.
    """
    return next(one.name for one in GPIO if one.name[3:].rstrip("12") == what and f"GPIO{pin}" in one)
