"""Frames with other data: uses of data by firmware, and whether a table holds for any data.

SCIRXBUF --> SCITXBUF                  any data
SCIRXBUF --> branch, index, RPT        the data of the case only
"""

from __future__ import annotations

from pathlib import Path

import pytest

from periph_sim.proof.closed_table import StartTable, TableMaker
from periph_sim.proof.other_data import TimesDigest, acts_on_data, data_use, follow_data
from periph_sim.proof.pair_groups import EXTERNAL
from periph_sim.proof.stretch import CoveredCase
from tests.proof.test_closed_table import covered, write_echo

READ = "          MOV   AL,@SCIRXBUF\n"
COMPARE = f"{READ}          CMPB  AL,#0x7F\n          SB    more,HI\n          NOP\n          NOP\nmore:     NOP\n"


def tabled(folder: Path, *after_read: str) -> tuple[CoveredCase, StartTable]:
    """Return the fast echo, with other code in place of READ, and its closed table."""
    case = covered(write_echo(folder, 2.0, *((READ, code) for code in after_read)))
    return case, TableMaker(case).make()


def test_an_echo_holds_for_any_data(tmp_path: Path) -> None:
    assert data_use(*tabled(tmp_path)) == ""


@pytest.mark.parametrize(
    ("code", "use"),
    [
        (COMPARE, "data decide a branch at _echo (echo.asm:54, "),
        (
            f"{READ}          MOVZ  AR0,AL\n          MOVL  XAR4,#0x9000\n          MOV   AL,*+XAR4[AR0]\n",
            "data decide the address of an access at _echo (echo.asm:55, ",
        ),
        (
            f"{READ}          MOV   @AR4,AL\n          RPT   @AR4 || NOP\n",
            "data decide the effect of an instruction at _echo (echo.asm:54, ",
        ),
        (f"{READ}          MOV   @SCIRXST,AL\n", "data are written to SCIRXST at _echo (echo.asm:53, "),
        (
            f"{READ}          MOV   @SCICTL1,#0x23\n",
            "SCICTL1 is written while frames come, and data can decide what is received at _echo (echo.asm:53, ",
        ),
    ],
)
def test_a_use_of_data_is_named(tmp_path: Path, code: str, use: str) -> None:
    assert data_use(*tabled(tmp_path, code)).startswith(use)


def test_frames_of_a_ramp_show_an_effect_that_no_mark_explains(tmp_path: Path) -> None:
    case, table = tabled(tmp_path, COMPARE)
    table.data_use = ""
    assert data_use(case, table) == "frames with other data have other effects"


def test_an_external_interrupt_is_refused(tmp_path: Path) -> None:
    setting = "MOV   @SCICCR,#0x07"
    path = write_echo(tmp_path, 2.0, (setting, f"{setting}\n          MOV   @0x7070,#1        ; XINT1CR"))
    case = covered(path)
    start, per_second = case.phases.first_start, case.phases.ticks_per_second
    table = StartTable([1], 1, 0, per_second // 100, start + per_second // 500, False, [], [[start]], set(), set())
    assert data_use(case, table) == ""  # the module is missing
    assert data_use(covered(path, 'unit.dsp.modules=["SCI-A", "GPIO", "XINT"]'), table) == EXTERNAL


def test_a_host_far_from_the_rate_of_the_sci_is_refused(tmp_path: Path) -> None:
    case, table = tabled(tmp_path)
    assert data_use(case.with_host("error", case.case.host.error + 3), table) == (  # type: ignore[union-attr]
        "the rates of the host and of the SCI differ by more than 2 %"
    )


@pytest.mark.parametrize(
    ("setting", "acts"),
    [
        ("MOV   @SCICCR,#0x07", False),
        ("MOV   @SCICCR,#0x87", False),  # two stop bits
        ("MOV   @SCICCR,#0x06", True),  # the eighth data bit is received as a stop bit
        ("MOV   @SCICCR,#0x27", True),  # a parity bit is expected
        ("MOV   @SCICCR,#0x0F", True),  # an address bit is expected
        ("MOV   @0x705C,#0x2000\n          MOV   @SCICCR,#0x07", True),  # SCIFFCT.CDC
    ],
)
def test_settings_with_which_data_decide_what_an_sci_does(tmp_path: Path, setting: str, acts: bool) -> None:
    case = covered(write_echo(tmp_path, 1.0, ("MOV   @SCICCR,#0x07", setting)))
    scene = case.free_scene(TimesDigest(), keep_values=False)
    assert not acts_on_data(scene)  # the SCI does not receive yet
    scene.advance(scene.start + case.phases.first_start)
    assert acts_on_data(scene) == acts


@pytest.mark.parametrize(
    ("event", "follows"),
    [
        ("frame TX begin", False),
        ("frame TX 0x41", True),
        ("edge TX fall", True),
        ("edge OUT rise", False),
        ("edge MOSI rise", True),
        ("access W SCI-A.SCITXBUF", False),
        ("access R SCI-A.SCIRXST", False),
        ("flag SCI-A.SCIRXST.RXRDY = 1", False),
        ("flag SCI-A.SCIRXBUF.RXDT = 0x41", True),
        ("flag SCI-A.SCITXBUF.TXDT change", True),
        ("flag GPIO.GPADAT.GPIO28 = 1", True),
        ("interrupt SCIRXINTA enter", False),
    ],
)
def test_budgets_whose_events_follow_data(tmp_path: Path, event: str, follows: bool) -> None:
    path = write_echo(tmp_path)
    text = path.read_text(encoding="utf-8").replace("[host]", "[unit.dsp.pins]\nOUT = 34\nMOSI = 16\n[host]", 1)
    text = text.replace("from frame RX end to frame TX begin, in order", f"from frame RX begin to {event}")
    path.write_text(text, encoding="utf-8")
    assert follow_data(covered(path), ["echo"]) == ["echo"] * follows


def test_a_budget_of_waits_follows_data_because_a_loop_is_a_wait_only_if_it_changes_no_value(tmp_path: Path) -> None:
    path = write_echo(tmp_path)
    text = path.read_text(encoding="utf-8").replace(
        "from frame RX end to frame TX begin, in order", "each time in cpu idle"
    )
    path.write_text(text, encoding="utf-8")
    assert follow_data(covered(path), ["echo"]) == ["echo"]


def test_edges_of_a_wire_with_an_sci_of_any_unit_follow_data(tmp_path: Path) -> None:
    """The wire is also a pin of another unit, GPIO34, which has no SCI."""
    path = write_echo(tmp_path)
    text = path.read_text(encoding="utf-8")
    other = '[unit.b]\noscclk = "20 MHz"\nimage = "echo.asm"\nmodules = ["SCI-A", "GPIO"]\n'
    text = text.replace("[host]", f"[unit.dsp.pins]\nLINK = 35\n{other}[unit.b.pins]\nLINK = 34\n[host]", 1)
    text = text.replace("from frame RX end to frame TX begin, in order", "from frame RX begin to edge LINK rise")
    path.write_text(text, encoding="utf-8")
    assert follow_data(covered(path), ["echo"]) == ["echo"]
