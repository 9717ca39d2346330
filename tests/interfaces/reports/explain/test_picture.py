"""Pictures of windows, with lanes of flags that change once or only outside of the picture."""

from __future__ import annotations

from dataclasses import replace

import pytest

from periph_sim.core.records import Kind, Record
from periph_sim.interfaces.reports.explain.picture import svg_picture, text_picture
from periph_sim.interfaces.reports.explain.window import Window
from periph_sim.traces.capture.capture import Span

from .made import drawn

SCD, ADDRESS = "I2CSTR.SCD", "I2COAR.OAR"


def flagged(what: str, value: int, tick: int) -> Window:
    """Return a window drawn from 0 to 100, in whose chain a field is named that changes once, at `tick`."""
    window = drawn("span model 0 100")
    change = Record(9, tick, Kind.FLAG, "dsp.I2C-A", what, value, "", 0)
    return replace(
        window,
        drawn=Span(0, 100),
        records=(*window.records, change),
        chain_texts=(f"the firmware waits for {what}", "I2COAR"),
    )


#        0 ______________ 100
#  SCD   ________________|‾‾‾  140: low in the whole picture
@pytest.mark.parametrize("tick", [-20, 50, 140])
@pytest.mark.parametrize(("what", "value", "lane"), [(SCD, 1, "SCD"), (SCD, 0, "SCD"), (ADDRESS, 0x68, "I2COAR")])
def test_a_flag_named_in_the_chain_has_a_lane_wherever_it_changes(what: str, value: int, lane: str, tick: int):
    window = flagged(what, value, tick)
    assert f">{lane}<" in svg_picture(window)
    text = next(line for line in text_picture(window, 100) if line.startswith(lane)).removeprefix(lane).strip()
    if what == ADDRESS:
        assert ("0x68" in text) == (tick < 100)
    elif tick != 50:  # the same level throughout, drawn in the lane's upper or lower row
        assert bool(text) == ((value == 1) == (tick < 0))


def test_the_worst_occurrence_is_marked_at_its_begin_and_at_its_end():
    shown = text_picture(drawn("span model 20 60", begin=20, end=60), 100)
    begins, ends, span = shown[:3]
    assert begins.index("v made: worst begins") == span.index("[") and ends.index(
        "v ends, 1.000 us later"
    ) == span.index("]")


def test_without_records_there_is_no_picture():
    assert text_picture(drawn(), 100) == []


def test_the_last_change_before_the_picture_sets_the_level():
    window = flagged(SCD, 1, -30)
    low = Record(10, -20, Kind.FLAG, "dsp.I2C-A", SCD, 0, "", 0)
    lane = next(
        line for line in text_picture(replace(window, records=(*window.records, low)), 100) if line.startswith("SCD")
    )
    assert lane.removeprefix("SCD").strip() == ""
