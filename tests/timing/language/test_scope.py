"""Scopes of cases and of recorded runs, which define the names that events can use, and messages about other names."""

from __future__ import annotations

import pytest
from msgspec.structs import replace

from periph_sim.core.records import Kind, Record
from periph_sim.scene.scope import scope_of_case
from periph_sim.timing.language.scope import BadEvent, Scope, scope_of_table
from periph_sim.timing.measures.factory import measure_named
from periph_sim.timing.measures.watched_register import Watched, clearing, losing, raced
from tests.scene.small import case, sentence_of
from tests.timing.events_by_hand import BARE, MODULES, NO_BUS, ONE, TWO, records, table


def sentence(call, *arguments: object) -> str:
    return sentence_of(BadEvent, lambda: call(*arguments))


def test_a_unit_by_its_name_or_as_the_only_one():
    assert (ONE.unit(""), ONE.unit("dsp"), TWO.unit("imu")) == ("dsp", "dsp", "imu")
    assert sentence(TWO.unit, "") == "head and imu have it; say whose is meant: head: before the name"
    assert sentence(TWO.unit, "imi") == "there is no unit 'imi'; did you mean imu?"
    assert sentence(Scope().unit, "") == "the scene has no unit"
    assert sentence(Scope().unit, "x").startswith("there is no unit 'x'")


def test_the_unit_that_has_a_module():
    assert (TWO.owner("", "SCI-A"), TWO.owner("", "TIMER0"), TWO.owner("imu", "PIE")) == ("imu", "head", "imu")
    assert ONE.owner("", "SYS") == "dsp"
    assert sentence(TWO.owner, "", "PIE").startswith("head and imu have PIE; say whose")
    assert sentence(TWO.owner, "imu", "TIMER0") == "imu has no module 'TIMER0'; it has I2C-A, SCI-A, SYS, PIE"
    assert sentence(NO_BUS.owner, "", "I2C-B") == "the scene has no module 'I2C-B'; it has SCI-A, SYS, PIE"


@pytest.mark.parametrize(
    ("scope", "unit", "vector", "of"),
    [
        (ONE, "", "I2CINT1A", "dsp"),
        (ONE, "", "WAKEINT", "dsp"),
        (TWO, "", "SCIRXINTA", "imu"),
        (TWO, "head", "I2CINT2A", "head"),
        (TWO, "", "TINT0", "head"),
    ],
)
def test_the_unit_that_has_an_interrupt(scope: Scope, unit: str, vector: str, of: str):
    assert scope.vector(unit, vector) == of


def test_an_interrupt_that_no_module_requests_is_rejected():
    assert sentence(TWO.vector, "", "I2CINT1A").startswith("head and imu have I2CINT1A; say whose is meant")
    assert sentence(NO_BUS.vector, "", "QQ") == (
        "nothing in the scene asks for the interrupt 'QQ'; it has SCIRXINTA, SCITXINTA, WAKEINT"
    )
    assert sentence(TWO.vector, "imx", "TINT0") == "there is no unit 'imx'; did you mean imu?"


def test_the_places_of_one_unit_and_of_all_units():
    imu = {"imu", "imu.I2C-A", "imu.SCI-A", "imu.PIE", "imu.SYS"}
    assert TWO.places("imu") == imu
    assert TWO.places("") == imu | {"head", "head.I2C-A", "head.TIMER0", "head.PIE", "head.SYS"}
    assert Scope().places("") == frozenset()


def test_a_scope_has_a_bus_if_it_has_a_controller_or_the_wires():
    assert [scope.bus for scope in (ONE, BARE, NO_BUS, Scope(controller=True), Scope())] == [
        *(True, True, False),
        *(True, False),
    ]


def test_registers_and_fields_need_all_their_parts():
    unit, module, register, field = ONE.field("", "I2C-A.I2CSTR.XRDY")
    assert (unit, module, register.name, field.name) == ("dsp", "I2C-A", "I2CSTR", "XRDY")
    assert ONE.register("", "SCI-A.SCIFFRX")[2].name == "SCIFFRX"
    for text in ("I2CSTR", "I2C-A.I2CSTR.XRDY", ""):
        assert sentence(ONE.register, "", text) == (
            f"{text!r} is no register; write its module and its name, for instance I2C-A.I2CDXR"
        )
    for text in ("I2C-A.I2CSTR", "a.I2C-A.I2CSTR.XRDY", ""):
        assert sentence(ONE.field, "", text) == (
            f"{text!r} is no field; write its module, its register and its name, for instance I2C-A.I2CSTR.XRDY"
        )


UNIT = {"firmware": "responder", "modules": ["I2C-A"]}


@pytest.mark.parametrize(
    ("more", "wires", "controller", "host"),
    [
        ({"unit": {"dsp": UNIT}}, ("SDA", "SCL"), False, False),
        ({"unit": {"dsp": {**UNIT, "modules": ["SCI-A", "GPIO"]}}}, ("RX", "TX"), False, False),
        ({"unit": {"dsp": {**UNIT, "modules": ["SCI-A", "I2C-A"]}}}, ("SDA", "SCL", "RX", "TX"), False, False),
    ],
)
def test_the_scope_of_a_case(more, wires: tuple[str, ...], controller: bool, host: bool):
    scope = scope_of_case(case(**more))
    assert (scope.wires, scope.controller, scope.host) == (wires, controller, host)
    assert scope.units == {"dsp": tuple(more["unit"]["dsp"]["modules"])}


def test_the_scope_of_a_case_with_a_controller_and_a_host():
    asks = {"controller": {"first": "1 ms", "rounds": 1, "request": [{"address": 0x50, "count": 1}]}}
    scope = scope_of_case(case(unit={"dsp": UNIT}, **asks))
    assert scope.controller and not scope.host and scope.wires == ("SDA", "SCL")


def test_the_scope_of_a_recorded_run():
    nothing = scope_of_table(table([]))
    assert replace(nothing, pairs=(), images={}) == Scope({"dsp": MODULES}, ("SDA", "SCL", "RX", "TX", "MODEL"))
    edges = scope_of_table(table(records("5 edge LED level 1\n6 edge SCL level 0\n7 frame RX begin 0")))
    assert edges.wires == ("SDA", "SCL", "RX", "TX", "MODEL", "LED") and (edges.controller, edges.host) == (False, True)
    bus = scope_of_table(table(records("5 bus controller START 0")))
    assert (bus.controller, bus.host) == (True, False)


# Measures with unknown names ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "scope", "said"),
    [
        ("perod of frame", ONE, "there is no measure 'perod of frame'; did you mean period of EVENT?"),
        ("spqn:command", ONE, "there is no measure 'spqn:command'; did you mean span:command?"),
        ("stretchh", ONE, "there is no measure 'stretchh'; did you mean stretch?"),
        ("qqqqq", ONE, "there is no measure 'qqqqq'; it has response, stretch, round, "),
        (
            "from frame to frame TX, same round",
            NO_BUS,
            "'same round' needs [controller] or [rounds] in the scene, which has none; leave it out",
        ),
        (
            "from frame to frame TX, same transfer",
            NO_BUS,
            "'same transfer' needs SCL and SDA in the scene, which has none; leave it out",
        ),
        ("count of frame from frame to frame TX, same round", BARE, "'frame' needs RX in the scene"),
        ("interrupt latency INT13", Scope({"dsp": ("TIMER1",)}), "INT13 does not come through the PIE, so nothing "),
        ("reaction", NO_BUS, "the scene has no module 'I2C-A'"),
        ("margin of I2CDXR", NO_BUS, "the scene has no module 'I2C-A'"),
        ("SCL held per transfer by head", NO_BUS, "there is no unit 'head'"),
        ("cpu load", TWO, "head and imu have it; say whose"),
    ],
)
def test_an_invalid_measure_is_rejected_with_a_reason(text: str, scope: Scope, said: str):
    assert sentence(measure_named, text, scope).startswith(said)


def test_without_a_controller_lost_arbitration_does_not_end_the_busy_state():
    with_, without = (measure_named("time in bus busy", scope) for scope in (ONE, BARE))
    assert [len(measure.matchers) for measure in (with_, without)] == [3, 2]


# Races --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("make", "text", "watched"),
    [
        (raced, "I2C-A.I2CSTR", Watched("I2C-A.I2CSTR", "dsp", "I2C-A", "I2CSTR")),
        (raced, "I2C-A.I2CSTR.BB", Watched("I2C-A.I2CSTR.BB", "dsp", "I2C-A", "I2CSTR", "BB")),
        (losing, "I2C-A.I2CSTR", Watched("I2C-A.I2CSTR", "dsp", "I2C-A", "I2CSTR")),
        (losing, "", Watched("", units=("dsp",))),
        (clearing, "I2C-A.I2CSTR.SDIR", Watched("I2C-A.I2CSTR.SDIR", "dsp", "I2C-A", "I2CSTR", "SDIR")),
    ],
)
def test_the_fields_that_a_race_measure_watches(make, text: str, watched: Watched):
    assert make("", text, ONE) == watched


def test_the_name_of_a_watched_register():
    assert Watched("").name is None
    assert raced("", "I2C-A.I2CSTR.BB", ONE).name == "dsp.I2C-A.I2CSTR.BB"
    assert raced("dsp", "I2C-A.I2CSTR", ONE).name == "dsp.I2C-A.I2CSTR"


@pytest.mark.parametrize(
    ("make", "text", "said"),
    [
        (raced, "I2C-A.I2CPSC", "I2CPSC is no status register: hardware sets no flag in it; did you mean I2CSTR?"),
        (losing, "I2C-A.I2CPSC", "writing 1 clears no flag of I2CPSC, so none can be lost; did you mean I2CSTR?"),
        (clearing, "I2C-A.I2CSTR.BB", "writing 1 does not clear I2C-A.I2CSTR.BB; it has SDIR, NACKSNT, SCD, RRDY, "),
    ],
)
def test_registers_that_cannot_be_watched_are_rejected(make, text: str, said: str):
    assert sentence(make, "", text, ONE).startswith(said)
    assert sentence(losing, "", "", Scope()) == "the scene has no unit"


RECORDS = {
    "access": Record(1, 0, Kind.ACCESS, "dsp", "R I2C-A.I2CSTR", 0, "f:1", 0),
    "access of another register": Record(1, 0, Kind.ACCESS, "dsp", "R I2C-A.I2CMDR", 0, "f:1", 0),
    "access of another unit": Record(1, 0, Kind.ACCESS, "imu", "R I2C-A.I2CSTR", 0, "f:1", 0),
    "flag": Record(1, 0, Kind.FLAG, "dsp.I2C-A", "I2CSTR.BB", 1, "", 0),
    "another flag": Record(1, 0, Kind.FLAG, "dsp.I2C-A", "I2CSTR.SCD", 1, "", 0),
    "flag of another register": Record(1, 0, Kind.FLAG, "dsp.I2C-A", "I2CSTRX.BB", 1, "", 0),
    "flag of another unit": Record(1, 0, Kind.FLAG, "imu.I2C-A", "I2CSTR.BB", 1, "", 0),
    "edge": Record(1, 0, Kind.EDGE, "dsp.I2C-A", "I2CSTR.BB", 1, "", 0),
}


@pytest.mark.parametrize(
    ("watched", "shows", "kept"),
    [
        (
            raced("", "I2C-A.I2CSTR", ONE),
            ["access", "flag", "another flag"],
            ["access", "access of another register", "flag", "another flag"],
        ),
        (
            raced("", "I2C-A.I2CSTR.BB", ONE),
            ["access", "flag"],
            ["access", "access of another register", "flag", "another flag"],
        ),
        (Watched(""), [name for name in RECORDS if name != "edge"], [name for name in RECORDS if name != "edge"]),
    ],
)
def test_records_that_show_a_watched_register_or_must_be_kept(watched: Watched, shows: list[str], kept: list[str]):
    """All accesses of the unit are kept, because an access between two reads shows that they are not a wait."""
    assert [name for name, record in RECORDS.items() if watched.is_about(*record[2:5])] == shows
    assert [name for name, record in RECORDS.items() if name != "edge" and watched.concerns(*record[2:5])] == kept
