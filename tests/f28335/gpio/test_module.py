"""GPIO: latches and directions, the multiplexer, input qualification, and changes reported to the owner.

Diagrams have one column per SYSCLKOUT cycle. Rows: `GPIOn` is an edge at the pad exactly at the
start of the cycle, `GPIOn~` one shortly before it; `REG.FIELD` is a bus write or the result of a
read; `padn` is the level that the chip drives on the pad (f: not driven); the name of a signal is
the level that its module receives.
"""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from periph_sim.core.chip import NEVER
from periph_sim.f28335.gpio.module import CONFIGURATION_DELAY, Gpio
from periph_sim.f28335.gpio.register_map import GPIO, PORT_OF
from periph_sim.f28335.gpio.settings import ALL, INPUTS, OUTPUTS
from periph_sim.f28335.system_options import SystemOptions
from tests.waves import play, tidy

FLOATING = 0xF
LONG = 10_000  # cycles after which no change is pending


class Rig:
    """A bare `Gpio`; the rig splits 32-bit accesses into halves and wakes the chip when due, as its owner does."""

    def __init__(self, gpio_out_delay: int = 1) -> None:
        self.gpio = Gpio(SystemOptions(gpio_out_delay=gpio_out_delay))
        self.now = 0
        self.seen = dict.fromkeys(INPUTS, 1)
        self.coming: list[tuple[int, str, int]] = []  # pending levels: (time, signal of a module, level)

    def write(self, name: str, value: int) -> None:
        register = GPIO[name]
        for half in range(register.width // 16):
            self.gpio.write(self.now, register.offset + half, value >> 16 * half)

    def read(self, name: str) -> int:
        register = GPIO[name]
        return sum(self.gpio.read(self.now, register.offset + h) << 16 * h for h in range(register.width // 16))

    def set(self, name: str, **fields: int) -> None:
        """Change fields of a register by a read-modify-write access."""
        value = self.read(name)
        for field, number in fields.items():
            value = GPIO[name][field].put(value, number)
        self.write(name, value)

    def mux(self, pin: int, value: int) -> None:
        self.set(pair_register("MUX", pin), **{f"GPIO{pin}": value})

    def select(self, pin: int, value: int) -> None:
        self.set(pair_register("QSEL", pin), **{f"GPIO{pin}": value})

    def pad(self, pin: int) -> int:
        return self.gpio.driven_high >> pin & 1 if self.gpio.driven >> pin & 1 else FLOATING

    def pin(self, now: int, pin: int, level: int, exact: bool = True) -> None:
        """Connect a pad to a wire with this level."""
        self.gpio.wire(1 << pin)
        self.gpio.edges(now, self.gpio.pads & ~(1 << pin) | level << pin, exact)

    def edge(self, now: int, pin: int, level: int, exact: bool) -> None:
        """Report an edge of a pad to the chip and schedule it for the module, as the router does."""
        gpio = self.gpio
        self.pin(now, pin, level, exact)
        for signal in INPUTS:
            if gpio.source(signal) == pin and gpio.seen_at(now, pin, exact) != NEVER:
                self.coming.append((gpio.seen_at(now, pin, exact), signal, level))

    def drive(self, now: int, signal: str, level: int) -> None:
        self.now = now
        name, _, field = signal.partition(".")
        if field and GPIO[name][field].access == "W1":
            self.write(name, GPIO[name][field].put(0, level))
        elif field:
            self.set(name, **{field: level})
        elif name == "GPIOIN":
            self.gpio.gate(now, bool(level))
        else:
            self.edge(now, int(name.strip("GPIO~")), level, exact=not name.endswith("~"))

    def run_until(self, time: int) -> None:
        gpio = self.gpio
        while gpio.next_wake <= time:
            self.now = gpio.next_wake
            gpio.wake(self.now)
        self.now = time
        for when, signal, level in self.coming:
            if when <= time:
                self.seen[signal] = level
        self.coming = [c for c in self.coming if c[0] > time]
        self.seen.update(gpio.changed)
        gpio.changed.clear()

    def show(self, signal: str) -> int:
        if signal.startswith("pad"):
            return self.pad(int(signal[3:]))
        if signal in INPUTS:
            return self.seen[signal]
        name, _, field = signal.partition(".")
        return GPIO[name][field].extract(self.read(name))


def pair_register(name: str, pin: int) -> str:
    return f"GP{'ABC'[pin // 32]}{name}{pin % 32 // 16 + 1}"


def bit_register(name: str, pin: int) -> str:
    return f"GP{'ABC'[pin // 32]}{name}"


def settled(rig: Rig) -> Rig:
    rig.run_until(rig.now + LONG)
    return rig


def given_to(*routes: tuple[int, int], select: dict[int, int] | None = None, high: int | None = None) -> Rig:
    """Return a rig with these multiplexer and qualifier settings, and optionally with one pin that drives 1."""
    rig = Rig()
    for pin, value in routes:
        rig.mux(pin, value)
    for pin, value in (select or {}).items():
        rig.select(pin, value)
    if high is not None:
        rig.set("GPADIR", **{f"GPIO{high}": 1})
        rig.set("GPASET", **{f"GPIO{high}": 1})
    return settled(rig)


def check(diagram: str, rig: Rig | None = None) -> None:
    rig = rig or Rig()
    start = rig.now + 1 if rig.now else 0
    assert play(diagram, rig, 1, start) == tidy(diagram)


# Register map ----------------------------------------------------------------


def test_a_control_register_reads_as_all_bits_that_it_stores():
    for register in GPIO:
        if not register.name.endswith(("DAT", "SET", "CLEAR", "TOGGLE")):
            stored, _ = register.write(0, 0xFFFF_FFFF)
            assert register.read(stored) == (stored, stored) and register.read(register.reset)[0] == register.reset


# Reset -----------------------------------------------------------------------


@pytest.mark.rule("SYS-047")
def test_after_reset_all_pins_are_synchronised_inputs_with_latch_0():
    rig = Rig()
    for name in ("MUX1", "MUX2", "DIR", "QSEL1", "QSEL2", "CTRL"):
        for port in "ABC":
            assert f"GP{port}{name}" not in GPIO or rig.read(f"GP{port}{name}") == 0
    assert rig.gpio.driven == 0
    check("""
        > GPIO12         1 0 . 1 . .
        < GPADAT.GPIO12  1 . 0 . 1 .
    """)
    rig.write("GPADIR", 0xFFFF_FFFF)
    settled(rig)
    assert (rig.gpio.driven, rig.gpio.driven_high) == (0xFFFF_FFFF, 0)


@pytest.mark.rule("SYS-048", "I2C-031")
def test_pull_ups_are_on_except_on_gpio0_to_11():
    rig = Rig()
    assert rig.gpio.pads == ALL & ~0xFFF
    assert [rig.read(f"GP{port}PUD") for port in "ABC"] == [0xFFF, 0, 0]
    assert [rig.read(f"GP{port}DAT") for port in "ABC"] == [0xFFFF_F000, 0xFFFF_FFFF, 0x00FF_FFFF]
    rig.set("GPBPUD", GPIO32=1)
    rig.set("GPAPUD", GPIO3=0)
    settled(rig)
    assert (rig.read("GPADAT"), rig.read("GPBDAT")) == (0xFFFF_F008, 0xFFFF_FFFE)


def test_reset_releases_all_pins_and_routes_at_once():
    rig = given_to((32, 1), (33, 1))
    rig.write("GPASET", 0x10)
    rig.set("GPADIR", GPIO4=1)
    settled(rig)
    rig.edge(rig.now, 32, 0, exact=True)
    settled(rig)
    version, routes = rig.gpio.out_version, rig.gpio.routes_version
    rig.gpio.reset(rig.now)
    assert (rig.gpio.driven, rig.gpio.driven_high, rig.gpio.source("SDAA")) == (0, 0, None)
    assert (rig.gpio.out_version, rig.gpio.routes_version) == (version + 1, routes + 1)
    assert rig.gpio.changed == [("SDAA", 1)]
    settled(rig)
    assert [rig.read(f"GP{port}DAT") for port in "ABC"] == [0xFFFF_F000, 0xFFFF_FFFE, 0x00FF_FFFF]


def test_a_reset_cancels_a_level_that_has_not_reached_the_pad():
    rig = Rig()
    rig.set("GPADIR", GPIO4=1)
    rig.gpio.reset(0)
    settled(rig)
    assert rig.pad(4) == FLOATING


def test_a_reset_cancels_a_multiplexer_write_that_has_not_taken_effect():
    rig = Rig()
    rig.mux(28, 1)
    rig.run_until(1)
    rig.gpio.reset(1)
    routes = rig.gpio.routes_version
    settled(rig)
    assert (rig.gpio.source("SCIRXDA"), rig.gpio.routes_version) == (None, routes)


# Latches, directions, pads ---------------------------------------------------


@pytest.mark.rule("SYS-060", "SYS-061", "SYS-062", "SYS-066")
def test_set_clear_and_toggle_change_the_latches():
    check("""
        > GPADIR.GPIO4     1 . . . . . . . . . .
        > GPASET.GPIO4     . . 1 0 . . . . . . .
        > GPACLEAR.GPIO4   . . 0 . 1 . . 0 . . .
        > GPATOGGLE.GPIO4  . . . . . . 1 0 1 . .
        < pad4             f 0 . 1 . 0 . 1 . 0 .
        < GPADAT.GPIO4     0 . . . 1 . 0 . 1 . 0
        < GPASET.GPIO4     0 . . . . . . . . . .
        < GPACLEAR.GPIO4   0 . . . . . . . . . .
        < GPATOGGLE.GPIO4  0 . . . . . . . . . .
    """)


@pytest.mark.rule("SYS-060", "SYS-061", "SYS-062")
def test_zeros_leave_the_other_latches_alone():
    rig = Rig()
    rig.write("GPADIR", 0xFF)
    rig.write("GPASET", 0x0F)
    rig.write("GPACLEAR", 0x01)
    rig.write("GPATOGGLE", 0x12)
    settled(rig)
    assert rig.gpio.driven_high == 0x1C


@pytest.mark.rule("SYS-057")
@pytest.mark.parametrize("port", "ABC")
def test_a_dat_write_loads_the_latch_of_the_whole_port(port):
    rig, pins = Rig(), PORT_OF[port]
    every = (1 << len(pins)) - 1
    rig.write(f"GP{port}DIR", every)
    rig.write(f"GP{port}DAT", 0xA5A5_5A5A)
    settled(rig)
    assert rig.gpio.driven_high == (0xA5A5_5A5A & every) << pins[0]
    rig.write(f"GP{port}DAT", 0)
    settled(rig)
    assert rig.gpio.driven_high == 0


def test_a_16_bit_dat_write_loads_its_half_only():
    rig = Rig()
    rig.write("GPADIR", 0xFFFF_FFFF)
    rig.write("GPASET", 0xFFFF_FFFF)
    rig.gpio.write(rig.now, GPIO["GPADAT"].offset, 0x1234)
    settled(rig)
    assert rig.gpio.driven_high == 0xFFFF_1234


@pytest.mark.rule("SYS-058", "SYS-063", "SYS-065")
@pytest.mark.parametrize("name", ["GPASET", "GPATOGGLE", "GPADAT"])
def test_the_latch_of_an_input_is_kept_and_drives_when_the_pin_becomes_an_output(name):
    check(f"""
        > {name}.GPIO4  1 . . . . . . .
        > GPADIR.GPIO4  . . . 1 . . 0 .
        < pad4          f . . . 1 . . f
    """)


@pytest.mark.rule("SYS-058", "SYS-064")
def test_a_pin_assigned_to_a_module_ignores_direction_and_latch():
    check("""
        > GPASET.GPIO29   1 . . . . . . . . . .
        > GPADIR.GPIO29   1 . . . . . 0 . . 1 .
        > GPAMUX2.GPIO29  . . 1 . . . . . . . .
        < pad29           f 1 . . . f . . . . .
    """)


@pytest.mark.rule("SYS-059")
def test_a_read_modify_write_of_dat_copies_pad_levels_into_latches():
    """GPIO5 drives 1, but its pad is held low from outside: setting GPIO4 through DAT clears the latch of GPIO5."""
    rig = Rig()
    rig.set("GPADIR", GPIO4=1, GPIO5=1)
    rig.write("GPASET", 1 << 5)
    settled(rig)
    rig.edge(rig.now, 5, 0, exact=False)
    settled(rig)
    assert rig.pad(5) == 1
    rig.set("GPADAT", GPIO4=1)
    settled(rig)
    assert (rig.pad(4), rig.pad(5)) == (1, 0)


@pytest.mark.rule("SYS-059", "SYS-066")
def test_two_quick_dat_read_modify_writes_undo_the_first():
    """The second access reads DAT before the first pin has its new level, a common mistake of firmware."""
    rig = Rig()
    rig.write("GPADIR", 0b11)
    settled(rig)
    rig.set("GPADAT", GPIO0=1)
    rig.run_until(rig.now + 1)
    rig.set("GPADAT", GPIO1=1)
    settled(rig)
    assert (rig.pad(0), rig.pad(1)) == (0, 1)


@pytest.mark.rule("SYS-066")
@pytest.mark.parametrize(
    ("delay", "pad", "dat"),
    [
        (1, "0 . . 1 . . . .", "0 . . . 1 . . ."),
        (0, "0 . 1 . . . . .", "0 . . 1 . . . ."),
        (2, "0 . . . 1 . . .", "0 . . . . 1 . ."),
    ],
)
def test_open_gpio_out_delay(delay, pad, dat):
    rig = Rig(gpio_out_delay=delay)
    assert not rig.gpio.touched
    rig.set("GPADIR", GPIO4=1)
    settled(rig)
    check(
        f"""
        > GPASET.GPIO4  . . 1 . . . . .
        < pad4          {pad}
        < GPADAT.GPIO4  {dat}
        """,
        rig,
    )
    assert rig.gpio.gpio_out_delay.unrecorded() == delay
    assert rig.gpio.touched == {"gpio_out_delay"}


def test_writes_in_successive_cycles_all_reach_the_pad():
    rig = Rig(gpio_out_delay=2)
    rig.set("GPADIR", GPIO4=1)
    settled(rig)
    check(
        """
        > GPASET.GPIO4    1 . . . . . .
        > GPACLEAR.GPIO4  . 1 . . . . .
        > GPATOGGLE.GPIO4 . . 1 . . . .
        < pad4            0 . 1 0 1 . .
        """,
        rig,
    )


def test_a_32_bit_write_changes_all_pads_at_once():
    rig = Rig()
    rig.write("GPADIR", 0xFFFF_FFFF)
    settled(rig)
    version = rig.gpio.out_version
    rig.write("GPASET", 0xFFFF_FFFF)
    settled(rig)
    assert (rig.gpio.driven_high, rig.gpio.out_version) == (0xFFFF_FFFF, version + 1)


# Multiplexer -----------------------------------------------------------------

ROUTES = [  # Tables 47, 48: signal, pin, MUX value
    pytest.param("SDAA", 32, 1, marks=pytest.mark.rule("SYS-051", "I2C-029")),
    pytest.param("SCLA", 33, 1, marks=pytest.mark.rule("SYS-051", "I2C-029")),
    *(pytest.param("SCITXDA", pin, 1, marks=pytest.mark.rule("SYS-052")) for pin in (29, 35)),
    *(pytest.param("SCIRXDA", pin, 1, marks=pytest.mark.rule("SYS-052")) for pin in (28, 36)),
    *(pytest.param("SCITXDB", pin, mux, marks=pytest.mark.rule("SYS-053")) for pin, mux in ((9, 2), (14, 2), (18, 2))),
    *(pytest.param("SCIRXDB", pin, mux, marks=pytest.mark.rule("SYS-053")) for pin, mux in ((11, 2), (15, 2), (19, 2))),
    pytest.param("SCITXDB", 22, 3, marks=pytest.mark.rule("SYS-053")),
    pytest.param("SCIRXDB", 23, 3, marks=pytest.mark.rule("SYS-053")),
    pytest.param("SCITXDC", 63, 1, marks=pytest.mark.rule("SYS-054")),
    pytest.param("SCIRXDC", 62, 1, marks=pytest.mark.rule("SYS-054")),
    *(("SPISIMOA", pin, 1) for pin in (16, 54)),
    *(("SPISOMIA", pin, 1) for pin in (17, 55)),
    *(("SPICLKA", pin, 1) for pin in (18, 56)),
    *(("SPISTEA", pin, 1) for pin in (19, 57)),
]


@pytest.mark.parametrize(("signal", "pin", "mux"), ROUTES)
def test_the_route_of_each_modelled_signal(signal, pin, mux):
    rig = given_to((pin, mux))
    gpio = rig.gpio
    for other in INPUTS:
        assert gpio.source(other) == (pin if other == signal else None)
    for other in OUTPUTS:
        assert gpio.sink(other) == ((pin,) if other == signal else ())
    assert not gpio.notes


@pytest.mark.rule("SYS-051", "SYS-052", "SYS-053", "SYS-054", "SYS-049")
def test_no_other_multiplexer_value_reaches_a_modelled_module():
    found = set()
    for pin in range(88):
        for mux in (1, 2, 3):
            rig = given_to((pin, mux))
            found |= {(signal, pin, mux) for signal in INPUTS if rig.gpio.source(signal) == pin}
            found |= {(signal, pin, mux) for signal in OUTPUTS if pin in rig.gpio.sink(signal)}
    assert found == {getattr(route, "values", route) for route in ROUTES}


OTHER_MODULES = [  # samples of Tables 47 to 49, copied from the manual
    *((0, 1, "EPWM1A"), (6, 2, "EPWMSYNCI"), (13, 3, "MDRB"), (14, 1, "TZ3"), (15, 3, "MFSXB")),
    *((24, 3, "MDXB"), (27, 2, "EQEP2S"), (28, 2, "XZCS6"), (31, 1, "CANTXA"), (32, 3, "ADCSOCAO"), (34, 1, "ECAP1")),
    *((37, 3, "XZCS7"), (47, 2, "XA7"), (48, 1, "ECAP5"), (63, 2, "XD16"), (64, 3, "XD15")),
    *((79, 2, "XD0"), (80, 2, "XA8"), (87, 3, "XA15")),
]


@pytest.mark.rule("SYS-049")
@pytest.mark.parametrize(("pin", "mux", "name"), OTHER_MODULES)
def test_a_pin_assigned_to_a_module_that_is_not_modelled_floats(pin, mux, name):
    rig = Rig()
    rig.set(bit_register("DIR", pin), **{f"GPIO{pin}": 1})
    settled(rig)
    assert rig.pad(pin) == 0
    rig.mux(pin, mux)
    settled(rig)
    assert rig.pad(pin) == FLOATING
    assert [note.code for note in rig.gpio.notes] == ["unknown"]
    assert f"GPIO{pin} is assigned to {name}," in rig.gpio.notes[0].text


@pytest.mark.rule("SYS-049")
@pytest.mark.parametrize(("pin", "mux"), [(0, 2), (0, 3), (4, 2), (38, 1), (47, 1)])
def test_a_reserved_multiplexer_value_is_noted(pin, mux):
    rig = given_to((pin, mux))
    assert [note.code for note in rig.gpio.notes] == ["duty"]
    assert f"GPIO{pin} is multiplexed to the reserved value {mux}" in rig.gpio.notes[0].text


def test_on_port_c_values_0_and_1_are_both_the_port():
    rig = given_to((64, 1))
    rig.set("GPCDIR", GPIO64=1)
    settled(rig)
    assert rig.pad(64) == 0
    assert not rig.gpio.notes


@pytest.mark.rule("SYS-050")
def test_a_multiplexer_write_takes_effect_after_two_cycles():
    rig = Rig()
    rig.edge(0, 28, 0, exact=False)
    check(
        """
        > GPAMUX2.GPIO28  . 1 . . . 0 . . .
        < GPAMUX2.GPIO28  0 1 . . . 0 . . .
        < SCIRXDA         1 . . 0 . . . 1 .
        """,
        rig,
    )


@pytest.mark.rule("SYS-050")
def test_routes_version_is_incremented_when_the_write_takes_effect():
    rig = Rig()
    before = rig.gpio.routes_version
    rig.mux(28, 1)
    assert rig.gpio.next_wake == CONFIGURATION_DELAY
    rig.run_until(1)
    assert (rig.gpio.routes_version, rig.gpio.source("SCIRXDA")) == (before, None)
    rig.run_until(2)
    assert (rig.gpio.routes_version, rig.gpio.source("SCIRXDA")) == (before + 1, 28)


@pytest.mark.rule("SYS-055", "I2C-030")
@pytest.mark.parametrize("signal", INPUTS)
def test_an_input_without_a_pin_is_1_and_spiste_0(signal):
    rig = Rig()
    for pin in range(88):
        rig.pin(0, pin, 0)
    settled(rig)
    assert rig.gpio.source(signal) is None
    assert rig.gpio.peripheral_level(rig.now, signal) == (signal != "SPISTEA")


@pytest.mark.rule("SYS-055")
@pytest.mark.parametrize(("signal", "first", "second"), [("SCIRXDA", (28, 1), (36, 1)), ("SCIRXDB", (11, 2), (23, 3))])
def test_an_input_with_two_pins_is_1_and_noted(signal, first, second):
    rig = Rig()
    for pin, _ in (first, second):
        rig.pin(0, pin, 0)
    rig.mux(*first)
    settled(rig)
    assert (rig.seen[signal], rig.gpio.source(signal)) == (0, first[0])
    rig.mux(*second)
    settled(rig)
    assert (rig.seen[signal], rig.gpio.source(signal)) == (1, None)
    assert [note.code for note in rig.gpio.notes] == ["duty"]
    rig.mux(first[0], 0)
    settled(rig)
    assert (rig.seen[signal], rig.gpio.source(signal)) == (0, second[0])


def test_an_output_may_have_several_pins():
    assert given_to((29, 1), (35, 1)).gpio.sink("SCITXDA") == (29, 35)


# Input -----------------------------------------------------------------------


@pytest.mark.rule("SYS-067", "I2C-031")
def test_synchronised_shows_an_edge_at_the_first_cycle_strictly_after_it():
    check("""
        > GPIO13~        1 . 0 . 1 . . .
        > GPIO12         1 . 0 . 1 . . .
        < GPADAT.GPIO12  1 . . 0 . 1 . .
        < GPADAT.GPIO13  1 . 0 . 1 . . .
    """)


@pytest.mark.rule("SYS-067", "I2C-031")
def test_synchronised_delays_a_module_s_input_by_at_most_one_cycle():
    check(
        """
        > GPIO33~  1 . 0 . 1 . . .
        > GPIO32   1 . 0 . 1 . . .
        < SDAA     1 . . 0 . 1 . .
        < SCLA     1 . 0 . 1 . . .
        """,
        given_to((32, 1), (33, 1)),
    )


@pytest.mark.rule("SYS-068", "I2C-031")
def test_asynchronous_delays_a_module_s_input_not_at_all():
    rig = given_to((32, 1), (33, 1), select={32: 3, 33: 3})
    check(
        """
        > GPIO33~  1 . 0 . 1 . . .
        > GPIO32   1 . 0 . 1 . . .
        < SDAA     1 . 0 . 1 . . .
        < SCLA     1 . 0 . 1 . . .
        """,
        rig,
    )


@pytest.mark.rule("SYS-069")
def test_asynchronous_on_a_port_input_is_synchronised():
    rig = given_to(select={12: 3})
    check(
        """
        > GPIO12         1 . 0 . 1 . . .
        < GPADAT.GPIO12  1 . . 0 . 1 . .
        """,
        rig,
    )


def test_dat_shows_each_of_several_edges_of_one_cycle_at_an_asynchronous_pin():
    rig = given_to((32, 1), select={32: 3})
    for level in (0, 1, 0):
        rig.pin(rig.now, 32, level)
        assert rig.show("GPBDAT.GPIO32") == level


@pytest.mark.rule("SYS-056")
@pytest.mark.parametrize("mux", [0, 1, 2, 3])
def test_dat_shows_the_pad_in_every_multiplexer_setting(mux):
    check(
        """
        > GPIO29~        1 . 0 . 1 . 0 .
        < GPADAT.GPIO29  1 . 0 . 1 . 0 .
        """,
        given_to((29, mux)),
    )


@pytest.mark.rule("SYS-056", "SYS-070")
@pytest.mark.parametrize("mux", [0, 1])
def test_dat_and_module_have_the_output_of_the_sampler(mux):
    rig = given_to((28, mux), select={28: 1})
    check(
        f"""
        > GPIO28~        1 . 0 . 1 . . 0 . . . 1 . . .
        < GPADAT.GPIO28  1 . . . . . . . . 0 . . . 1 .
        < SCIRXDA        {"1 . . . . . . . . 0 . . . 1 ." if mux else "1 . . . . . . . . . . . . . ."}
        """,
        rig,
    )


@pytest.mark.rule("SYS-070", "SYS-067")
def test_the_input_of_the_sampler_is_the_synchronised_level():
    rig = given_to(select={28: 2})
    check(
        """
        > GPIO28         1 . 0 . . . . . . . .
        < GPADAT.GPIO28  1 . . . . . . . 0 . .
        """,
        rig,
    )


@pytest.mark.rule("SYS-050")
def test_a_qualifier_select_takes_effect_after_two_cycles():
    check("""
        > GPAQSEL2.GPIO28  . . 1 . . . . . . .
        > GPIO28~          1 0 . 1 . 0 1 0 . .
        < GPADAT.GPIO28    1 0 . 1 . . . . . 0
    """)


def falls_after(rig: Rig, pin: int) -> set[int]:
    """Return the delays from a fall of a pad to that of DAT, in cycles, for every phase of the prescaler."""
    came = set()
    rig.pin(rig.now, pin, 1)
    settled(rig)
    for _ in range(520):
        begin = rig.now + 1
        rig.pin(begin, pin, 0, exact=False)
        came.add(rig.gpio.next_wake - begin)
        rig.run_until(begin + 5000)
        rig.pin(rig.now, pin, 1, exact=False)
        rig.run_until(rig.now + 5000)
    return came


@pytest.mark.rule("SYS-071")
@pytest.mark.parametrize(("prescale", "period"), [(0, 1), (1, 2), (3, 6), (7, 14), (255, 510)])
def test_the_sampling_period(prescale, period):
    """DAT falls with the third sample, two periods after the first, which is taken within one period."""
    rig = Rig()
    rig.set("GPACTRL", QUALPRD1=prescale)
    rig.select(12, 1)
    settled(rig)
    came = falls_after(rig, 12)
    assert came == set(range(2 * period, 3 * period))


@pytest.mark.rule("SYS-071")
@pytest.mark.parametrize("pin", range(64))
def test_the_sampling_period_is_set_for_eight_pins(pin):
    port = "AB"[pin // 32]
    for group in range(4):
        rig = Rig()
        rig.set(f"GP{port}CTRL", **{f"QUALPRD{group}": 50})
        rig.select(pin, 1)
        settled(rig)
        rig.pin(rig.now, pin, 1, exact=False)
        settled(rig)
        rig.pin(rig.now, pin, 0, exact=False)
        slow = rig.gpio.next_wake - rig.now > 100
        assert slow == (group == pin % 32 // 8)


@pytest.mark.rule("SYS-072", "SYS-073", "SYS-074")
def test_pulses_at_a_pin_pass_by_their_length_and_phase():
    """QUALPRD = 2, three samples: a pulse of 8 cycles never passes, one of 9 in one phase of four, 12 and 13 always."""
    passed = {8: 0, 9: 0, 12: 0, 13: 0}
    for width in passed:
        rig = Rig()
        rig.set("GPACTRL", QUALPRD1=2)
        rig.select(12, 1)
        settled(rig)
        for _ in range(4):
            rig.pin(rig.now, 12, 0, exact=False)
            rig.run_until(rig.now + width - 1)
            shown = [rig.read("GPADAT") >> 12 & 1]
            rig.pin(rig.now + 1, 12, 1, exact=False)
            passed[width] += shown == [0]
            rig.run_until(rig.now + 1001 - width + 1)
    assert passed == {8: 0, 9: 1, 12: 4, 13: 4}


@pytest.mark.rule("SYS-075")
def test_port_c_has_no_sampler():
    assert not {"GPCCTRL", "GPCQSEL1", "GPCQSEL2"} & {r.name for r in GPIO}
    rig = Rig()
    for offset in (0x20, 0x21, 0x22, 0x23, 0x24, 0x25):  # the offsets of these registers in ports A and B
        rig.gpio.write(0, offset, 0xFFFF)
    settled(rig)
    check(
        """
        > GPIO87         1 . 0 1 . .
        < GPCDAT.GPIO87  1 . . 0 1 .
        """,
        rig,
    )


@pytest.mark.rule("SYS-076")
@pytest.mark.parametrize("write", ["GPAMUX2.GPIO28", "GPADIR.GPIO28"])
def test_multiplexer_and_direction_do_not_reset_the_sampler(write):
    """Six samples are needed; the pad is driven from outside, and the setting takes effect between two samples."""
    rig = Rig()
    rig.select(28, 2)
    rig.edge(0, 28, 1, exact=True)
    settled(rig)
    check(
        f"""
        > GPIO28~        1 . 0 . . . . . . .
        > {write}        . . 1 . . . . . . .
        < GPADAT.GPIO28  1 . . . . . . 0 . .
        """,
        rig,
    )


@pytest.mark.rule("SYS-077")
def test_gpioinenclk_switches_off_and_resets_the_input_of_outputs():
    rig = given_to(high=4)
    check(
        """
        > GPIOIN           1 0 . . . . . 1 . .
        > GPATOGGLE.GPIO4  . . . 1 . 1 . . . .
        < pad4             1 . . . 0 . 1 . . .
        < GPADAT.GPIO4     1 0 . . . . . 1 . .
        """,
        rig,
    )


@pytest.mark.rule("SYS-077")
def test_gpioinenclk_leaves_no_residue_in_the_sampler():
    """With six samples, the qualifier starts again at 0 and needs six samples of 1."""
    rig = given_to(select={4: 2}, high=4)
    check(
        """
        > GPIOIN        1 0 . 1 . . . . . . .
        < GPADAT.GPIO4  1 0 . . . . . . . 1 .
        """,
        rig,
    )


@pytest.mark.rule("SYS-077")
def test_gpioinenclk_requests_a_wake_up_for_the_output_of_the_sampler():
    rig = given_to(select={4: 2}, high=4)
    begin = rig.now
    rig.gpio.gate(begin, False)
    rig.gpio.gate(begin + 1, True)
    due = rig.gpio.next_wake
    rig.gpio.wake(due - 1)
    assert not rig.gpio.peek(due - 1, GPIO["GPADAT"].offset) >> 4 & 1
    rig.gpio.wake(due)
    assert rig.gpio.peek(due, GPIO["GPADAT"].offset) >> 4 & 1


@pytest.mark.rule("SYS-077")
def test_gpioinenclk_does_not_touch_inputs():
    check("""
        > GPIOIN         0 . . . . .
        > GPIO12~        1 . 0 . 1 .
        < GPADAT.GPIO12  1 . 0 . 1 .
    """)


@pytest.mark.rule("SYS-077", "I2C-032")
@pytest.mark.parametrize("mux", [0, 1])
def test_gpioinenclk_does_not_touch_the_i2c_pins(mux):
    rig = given_to((32, mux), (33, mux))
    rig.set("GPBDIR", GPIO32=1, GPIO33=1)
    settled(rig)
    rig.gpio.gate(rig.now, False)
    check(
        f"""
        > GPIO32~        1 . 0 . 1 .
        > GPIO33~        1 . . 0 1 .
        < GPBDAT.GPIO32  1 . 0 . 1 .
        < GPBDAT.GPIO33  1 . . 0 1 .
        < SDAA           {"1 . 0 . 1 ." if mux else "1 . . . . ."}
        < SCLA           {"1 . . 0 1 ." if mux else "1 . . . . ."}
        """,
        rig,
    )


@pytest.mark.rule("SYS-077")
@pytest.mark.parametrize("qsel", [0, 1, 3])
def test_gpioinenclk_does_not_touch_a_peripheral_s_pin_that_is_an_input_too(qsel):
    """SPICLKA is an output of the SPI as master and an input of the SPI as slave."""
    rig = given_to((18, 1))
    rig.select(18, qsel)
    rig.pin(rig.now, 18, 1)
    settled(rig)
    rig.gpio.gate(rig.now, False)
    assert (rig.gpio.peripheral_level(rig.now, "SPICLKA"), rig.read("GPADAT") >> 18 & 1) == (1, 1)
    later = {0: "0 . .", 1: ". . 0", 3: "0 . ."}[qsel]
    check(
        f"""
        > GPIO18~        1 . . 0 . .
        < GPADAT.GPIO18  1 . . {later}
        < SPICLKA        1 . . {later}
        """,
        rig,
    )


# Pending changes --------------------------------------------------------------


@pytest.mark.parametrize(
    "call",
    [
        lambda gpio, now: gpio.peripheral_level(now, "SDAA"),
        lambda gpio, now: gpio.gate(now, False),
        lambda gpio, now: gpio.xint_levels(now),
        lambda gpio, now: gpio.watch_xints(now, 0),
        lambda gpio, now: gpio.wake(now),
        lambda gpio, now: gpio.peek(now, GPIO["GPBDAT"].offset),
        lambda gpio, now: gpio.write(now, GPIO["GPBSET"].offset, 0),
    ],
    ids=["peripheral_level", "gate", "xint_levels", "watch_xints", "wake", "peek", "write"],
)
def test_a_change_that_is_due_is_reported_by_the_next_call(call):
    """The owner did not wake the module at the third sample."""
    rig = given_to((32, 1), select={32: 1})
    rig.gpio.changed.clear()
    rig.pin(rig.now, 32, 0, exact=False)
    assert rig.gpio.changed == [] and rig.gpio.next_wake < rig.now + 10
    call(rig.gpio, rig.now + 10)
    assert rig.gpio.changed == [("SDAA", 0)]
    assert rig.gpio.peripheral_level(rig.now + 10, "SDAA") == 0


def test_a_sample_due_in_the_cycle_before_an_edge_is_taken_before_it():
    """The sampler starts in cycle 2 with the level of that cycle, even without a wake-up; the edge is in cycle 3."""
    rig = Rig()
    rig.select(12, 1)
    rig.pin(3, 12, 0)
    shown = [rig.gpio.peek(now, GPIO["GPADAT"].offset) >> 12 & 1 for now in range(3, 8)]
    assert shown == [1, 1, 1, 0, 0]


# External interrupt selects --------------------------------------------------


@pytest.mark.rule("SYS-079")
@pytest.mark.parametrize("line", range(1, 8))
@pytest.mark.parametrize("select", [0, 1, 17, 31])
def test_each_xint_line_selects_a_pin_of_its_port(line, select):
    pin = select + (0 if line <= 2 else 32)
    rig = Rig()
    rig.set(f"GPIOXINT{line}SEL", GPIOSEL=select)
    for other in range(88):
        rig.pin(0, other, 0)
    settled(rig)
    rig.gpio.watch_xints(rig.now, 0x7F)
    for other in range(88):
        rig.pin(rig.now, other, int(other == pin), exact=False)
    assert (f"XINT{line}", 1) in rig.gpio.changed
    assert rig.gpio.xint_levels(rig.now) >> (line - 1) & 1
    rig.gpio.changed.clear()
    for other in set(range(88)) - {pin}:
        rig.pin(rig.now, other, 1, exact=False)
    assert f"XINT{line}" not in dict(rig.gpio.changed)


def test_a_watched_line_is_reported_with_its_qualified_level():
    rig = Rig()
    rig.select(7, 1)
    rig.set("GPIOXINT1SEL", GPIOSEL=7)
    rig.set("GPIOXINT2SEL", GPIOSEL=8)
    settled(rig)
    rig.gpio.watch_xints(rig.now, 0b11)
    begin = rig.now + 10
    rig.pin(begin, 7, 1)
    rig.pin(begin, 8, 1)
    assert (rig.gpio.next_wake, rig.gpio.changed) == (begin + 1, [])
    rig.gpio.wake(begin + 1)
    assert (rig.gpio.next_wake, rig.gpio.changed) == (begin + 3, [("XINT2", 1)])
    rig.gpio.wake(begin + 3)
    assert (rig.gpio.next_wake, rig.gpio.changed) == (NEVER, [("XINT2", 1), ("XINT1", 1)])


@pytest.mark.parametrize("exact", [True, False])
def test_a_later_edge_of_another_pin_does_not_hide_a_watched_one(exact):
    rig = Rig()
    rig.gpio.watch_xints(0, 0b1)
    rig.pin(10, 0, 1)
    rig.pin(11, 20, 0, exact)  # in each cycle, the owner reports pads before it wakes the chip
    rig.gpio.wake(11)
    assert rig.gpio.changed == [("XINT1", 1)]


def test_a_pulse_within_one_cycle_is_not_reported():
    """The pad rises exactly at cycle 10 and falls before cycle 11, where the synchroniser samples it low."""
    rig = Rig()
    rig.gpio.watch_xints(0, 0b1)
    rig.pin(10, 0, 1)
    rig.pin(11, 0, 0, exact=False)
    rig.gpio.wake(11)
    assert rig.gpio.changed == []


def test_an_edge_in_the_cycle_in_which_its_line_becomes_watched_is_reported():
    """GPIO28 is the pin of SCIRXDA, whose edges are not reported; XINT1 is enabled on it in the cycle of an edge."""
    rig = given_to((28, 1))
    rig.set("GPIOXINT1SEL", GPIOSEL=28)
    settled(rig)
    rig.gpio.changed.clear()
    now = rig.now
    rig.pin(now, 28, 0)
    assert rig.gpio.next_wake == NEVER
    rig.gpio.watch_xints(now, 0b1)
    assert rig.gpio.next_wake == now + 1
    rig.gpio.wake(now + 1)
    assert rig.gpio.changed == [("XINT1", 0)]


def test_selecting_a_pin_of_another_level_is_an_edge():
    rig = Rig()
    rig.gpio.watch_xints(0, 0b1)
    rig.set("GPIOXINT1SEL", GPIOSEL=12)  # GPIO12 is pulled up, and GPIO0 is low
    assert rig.gpio.changed == [("XINT1", 1)]


# Wake-ups, and edges out of order ---------------------------------------------


@pytest.mark.parametrize("select", [0, 3])
@pytest.mark.parametrize("exact", [True, False])
def test_a_pin_of_a_module_without_sampling_requests_no_wake_up(select, exact):
    rig = given_to((32, 1), (33, 1), (28, 1))
    for pin in (28, 32, 33):
        rig.select(pin, select)
    settled(rig)
    for cycle in range(rig.now, rig.now + 100):
        for pin in (28, 32, 33):
            rig.pin(cycle, pin, cycle & 1, exact)
            assert rig.gpio.next_wake == NEVER
        rig.gpio.watch_xints(cycle, 0)  # all settings are evaluated again between the edges
        assert rig.gpio.next_wake == NEVER
    assert not rig.gpio.changed


def test_an_edge_in_the_cycle_in_which_its_pin_becomes_a_port_input_requests_a_wake_up():
    """The edge is in the cycle in which the multiplexer setting makes the pin a port input again."""
    rig = given_to((28, 1))
    rig.mux(28, 0)
    acts = rig.now + CONFIGURATION_DELAY
    rig.pin(acts, 28, 0)
    rig.gpio.wake(acts)
    assert (rig.gpio.peek(acts, 0x41) >> 12 & 1, rig.gpio.next_wake) == (1, acts + 1)
    rig.gpio.wake(acts + 1)
    assert (rig.gpio.peek(acts + 1, 0x41) >> 12 & 1, rig.gpio.next_wake) == (0, NEVER)


PINS_AT_PLAY = (4, 12, 28, 32, 70)
WRITES = st.tuples(
    st.sampled_from(["SET", "CLEAR", "TOGGLE", "DAT", "DIR", "MUX1", "MUX2", "QSEL1", "QSEL2", "CTRL", "PUD"]),
    st.sampled_from("AB"),
    st.integers(0, 0xFFFF_FFFF),
)
EDGES = st.tuples(st.sampled_from(PINS_AT_PLAY), st.integers(0, 1), st.booleans())
GATE = st.booleans()


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.integers(1, 40), st.one_of(WRITES, EDGES, EDGES, GATE)), max_size=25))
def test_nothing_readable_changes_without_an_input_or_a_due_wake_up(steps):
    """Two rigs are compared: one is woken only when due, the other one in every cycle."""
    lazy, eager = Rig(), Rig()
    for rig in (lazy, eager):
        rig.gpio.watch_xints(0, 0x7F)  # so that edges of pins of modules are reported, too
    ignored = 0
    shown = visible(eager)
    for gap, action in [*steps, (60, True)]:
        end = lazy.now + gap
        for cycle in range(lazy.now + 1, end + 1):
            due = eager.gpio.next_wake <= cycle
            if cycle == end:
                act(lazy, cycle, action)
                act(eager, cycle, action)
            eager.gpio.wake(cycle)
            eager.now = cycle
            now_shown = visible(eager)
            changed = (now_shown ^ shown) & ~ignored
            assert due or cycle == end or not changed, f"cycle {cycle}: {changed:#x}"
            shown, ignored = now_shown, unreported(eager.gpio)
        lazy.run_until(end)
        assert visible(lazy) == shown
        assert (lazy.gpio.driven_high, lazy.gpio.driven) == (eager.gpio.driven_high, eager.gpio.driven)


def unreported(gpio: Gpio) -> int:
    """Return the pins whose edges the owner passes to a module; DAT may follow a cycle later unreported."""
    selected = {0, 32}  # the pins that XINT1 to XINT7 select after reset
    sources = [gpio.source(signal) for signal in INPUTS]
    return sum(1 << pin for pin in sources if pin is not None and pin not in selected)


def visible(rig: Rig) -> int:
    return sum(rig.gpio.peek(rig.now, 0x40 + 8 * p + h) << 32 * p + 16 * h for p in range(3) for h in (0, 1))


def act(rig: Rig, now: int, action: object) -> None:
    if isinstance(action, bool):
        rig.gpio.gate(now, action)
    elif isinstance(action, tuple) and isinstance(action[0], int):
        rig.pin(now, *action)
    elif isinstance(action, tuple):
        rig.gpio.wake(now)
        rig.now = now
        rig.write(f"GP{action[1]}{action[0]}", action[2])


def test_edges_reported_out_of_order_are_refused():
    rig = Rig()
    rig.pin(5, 12, 0)
    with pytest.raises(ValueError, match="report edges in order"):
        rig.pin(5, 13, 0, exact=False)
