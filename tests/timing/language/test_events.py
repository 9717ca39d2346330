"""Events compiled to matchers of records: records that match, records that do not, and names unknown in the scene."""

from __future__ import annotations

import pytest

from periph_sim.timing.language.events import matcher
from periph_sim.timing.language.scope import BadEvent, Scope, scope_of_table
from periph_sim.timing.measures.over_table import rows_of
from tests.scene.small import sentence_of
from tests.timing.events_by_hand import BARE, MODULES, NO_BUS, ONE, TWO, records, table

CABLES = Scope({"a": ("SCI-A",), "b": ("SCI-A",)}, lines=("a.SCI-A.TX", "b.SCI-A.TX"))
RUN = """
     0 access dsp        W_I2C-A.I2CDXR  0x11
    10 edge   SCL        level           0
    20 edge   SCL        level           1
    20 edge   SDA        level           1
    30 flag   dsp.I2C-A  I2CSTR.XRDY     1
    40 access dsp        R_I2C-A.I2CDXR  0x11
    50 flag   dsp.I2C-A  I2CSTR.XRDY     0
    60 flag   dsp.SCI-A  SCIFFRX.RXFFST  3
    65 flag   dsp.SCI-A  SCIFFRX.RXFFST  1
    70 irq    dsp        SCIRXINTA       1
    80 irq    dsp        SCIRXINTA       0
    90 span   dsp        model           1
    95 span   dsp        model           0
   100 bus    controller START           0
   110 bus    controller address         0x1A0
   120 bus    controller repeated_START  0
   130 bus    controller address         0x1A3
   140 bus    controller byte            0x0FE
   142 bus    controller NACK            0
   144 bus    controller NACK            1
   150 bus    controller STOP            0
   155 frame  RX         begin           0
   160 frame  RX         end             0x55
   161 frame  TX         begin           0
   165 frame  TX         error           0x54
   170 note   dsp        duty            1
   180 note   dsp.I2C-A  duty            1
   190 note   dsp.I2C-A  lost            1
"""


@pytest.mark.parametrize(
    ("event", "ticks"),
    [
        ("edge SCL rise", [20]),
        ("edge SCL fall", [10]),
        ("edge SCL change", [10, 20]),
        ("edge MODEL rise", []),
        ("flag I2C-A.I2CSTR.XRDY rise", [30]),
        ("flag I2C-A.I2CSTR.XRDY fall", [50]),
        ("flag dsp:I2C-A.I2CSTR.XRDY change", [30, 50]),
        ("flag SCI-A.SCIFFRX.RXFFST change", [60, 65]),
        ("flag SCI-A.SCIFFRX.RXFFST = 3", [60]),
        ("access W I2C-A.I2CDXR", [0]),
        ("access R I2C-A.I2CDXR", [40]),
        ("access by dsp", [0, 40]),
        ("interrupt SCIRXINTA enter", [70]),
        ("interrupt SCIRXINTA leave", [80]),
        ("span model begin", [90]),
        ("span model end", [95]),
        ("span other end", []),
        ("span any:model begin", [90]),
        ("bus START", [100]),
        ("bus repeated START", [120]),
        ("bus STOP", [150]),
        ("bus address", [110, 130]),
        ("bus address 0x68", [110, 130]),
        ("bus address 0x68 write", [110]),
        ("bus address 0x68 read", [130]),
        ("bus address read", [130]),
        ("bus address 0x53", []),
        ("bus address ACK", [110]),
        ("bus address NACK", [130]),
        ("bus address 0x68 write ACK", [110]),
        ("bus address read ACK", []),
        ("bus byte 0x7f", [140]),
        ("bus NACK", [142, 144]),
        ("bus NACK address", [142]),
        ("bus NACK byte", [144]),
        ("bus byte 0x7e", []),
        ("bus START or bus STOP", [100, 150]),
        ("edge SCL rise or note lost or frame", [20, 155, 190]),
        ("frame", [155]),
        ("frame RX", [155]),
        ("frame TX begin", [161]),
        ("frame RX end", [160]),
        ("frame TX end", []),
        ("frame TX error", [165]),
        ("frame 0x55", [160]),
        ("frame RX 0x56 end", []),
        ("frame TX 0x54 error", [165]),
        ("note duty", [170, 180]),
        ("note dsp:lost", [190]),
    ],
)
def test_a_matcher_finds_the_same_records_one_by_one_and_all_at_once(event: str, ticks: list[int]):
    of = records(RUN)
    test = matcher(event, ONE)
    assert [record.tick for record in of if test.fits(record)] == ticks
    whole = table(of)
    assert whole.tick[rows_of(matcher(event, scope_of_table(whole)), whole)].tolist() == ticks


@pytest.mark.parametrize(
    ("event", "scope", "sentence"),
    [
        ("edge SLC rise", ONE, "there is no wire 'SLC'; did you mean SCL?"),
        ("edge RX fall", BARE, "there is no wire 'RX'; it has SDA, SCL"),
        ("flag I2C-A.I2CSTR.XRDI rise", ONE, "I2CSTR has no field 'XRDI'; did you mean XRDY"),
        ("flag I2C-A.I2CST.XRDY rise", ONE, "I2C-A has no register 'I2CST'; did you mean I2CSTR"),
        ("flag I2C.I2CSTR.XRDY rise", ONE, "the scene has no module 'I2C'; did you mean I2C-A?"),
        ("flag I2CSTR.XRDY rise", ONE, "'I2CSTR.XRDY' is no field; write its module, its register and its name, for"),
        ("flag SCI-A.SCIFFRX.RXFFST rise", ONE, "SCI-A.SCIFFRX.RXFFST has 5 bits and so does not rise; write change"),
        ("flag I2C-A.I2CSTR.XRDY = 2", ONE, "I2C-A.I2CSTR.XRDY has 1 bits and so is never 0x2"),
        ("access W I2CDXR", ONE, "'I2CDXR' is no register; write its module and its name, for instance I2C-A.I2CDXR"),
        ("access W SCI-B.SCITXBUF", ONE, "the scene has no module 'SCI-B'; did you mean SCI-A?"),
        ("access W dps:I2C-A.I2CDXR", ONE, "there is no unit 'dps'; did you mean dsp?"),
        ("access W head:SCI-A.SCITXBUF", TWO, "head has no module 'SCI-A'; did you mean I2C-A?"),
        ("access W I2C-A.I2CDXR", TWO, "head and imu have I2C-A; say whose is meant: head: before the name"),
        ("interrupt SCIRXINTB enter", ONE, "nothing in the scene asks for the interrupt 'SCIRXINTB'; did you mean SCI"),
        ("interrupt head:SCIRXINTA enter", TWO, "nothing in the scene asks for the interrupt 'SCIRXINTA'; it has "),
        ("span model begin", TWO, "head and imu have it; say whose is meant: head: before the name"),
        ("bus STOP", NO_BUS, "'bus STOP' needs SCL and SDA in the scene, which has none; give it [controller]"),
        ("bus stuck", NO_BUS, "'bus stuck' needs SCL and SDA in the scene, which has none; give it [controller]"),
        ("bus clear", BARE, "'bus clear' needs [controller] in the scene, which has none; give it [controller]"),
        ("frame", BARE, "'frame' needs RX in the scene, which has no such wire; give a unit SCI-A"),
        ("frame TX", CABLES, "'frame TX' needs TX in the scene, which has no such wire; write frame a.SCI-A.TX or b."),
        (
            "frame",
            CABLES,
            "'frame' needs RX in the scene, which has no such wire; write frame a.SCI-A.TX or b.SCI-A.TX",
        ),
        ("frame bgin", ONE, "'frame bgin': there is no serial line 'bgin'; did you mean begin?"),
        ("frame TX 7 begin", ONE, "'frame TX 7 begin': what a frame carries is known at its end; write frame TX 7 end"),
        ("last edge RX rise of transfer", NO_BUS, "'last edge RX rise of transfer': a transfer needs SCL and SDA in"),
        (
            "last edge SCL rise of round",
            BARE,
            "'last edge SCL rise of round': a round needs [controller] or [rounds] in",
        ),
        ("3rd bus byte of burst", ONE, "'3rd bus byte of burst': a burst is one of frames; write of transfer or of r"),
        ("note dps:duty", ONE, "there is no unit 'dps'; did you mean dsp?"),
    ],
)
def test_an_event_that_is_impossible_in_the_scene_is_rejected_with_similar_names(event, scope, sentence: str):
    assert sentence_of(BadEvent, lambda: matcher(event, scope)).startswith(sentence)


def test_with_two_units_the_unit_must_be_named_unless_only_one_has_the_module():
    assert matcher("flag imu:I2C-A.I2CSTR.XRDY rise", TWO).where == {"imu.I2C-A"}
    assert matcher("access W SCI-A.SCITXBUF", TWO).where == {"imu"}
    assert matcher("interrupt TINT0 enter", TWO).where == {"head"}
    assert matcher("flag imu:PIE.PIEIFR9.INTx1 rise", TWO).where == {"imu.PIE"}


def test_the_scope_of_a_recorded_run_has_its_units_wires_and_parties():
    scope = scope_of_table(table(records(RUN)))
    assert scope.units == {"dsp": MODULES}
    assert {"SDA", "SCL", "RX", "TX", "MODEL"} == set(scope.wires)
    assert scope.controller and scope.host
    assert not scope_of_table(table(records("10 edge SCL level 0"))).controller
