"""Pictures of windows: lanes of flags that hardly change, or change elsewhere."""

from __future__ import annotations

from dataclasses import replace

import pytest

from periph_sim.core.records import Kind, Record
from periph_sim.explain.picture import svg_picture, text_picture
from periph_sim.explain.window import Window
from periph_sim.traces.capture.capture import Span

from .made import drawn

SCD, ADDRESS = "I2CSTR.SCD", "I2COAR.OAR"


def flagged(what: str, value: int, tick: int) -> Window:
    """The picture shows 0 to 100; a field that the chain names changes once, at `tick`."""
    window = drawn("span model 0 100")
    change = Record(9, tick, Kind.FLAG, "dsp.I2C-A", what, value, "", 0)
    return replace(
        window, drawn=Span(0, 100), records=(*window.records, change), told=(f"the firmware waits for {what}", "I2COAR")
    )


#        0 ______________ 100
#  SCD   ________________|‾‾‾  140: low in all of the picture
@pytest.mark.parametrize("tick", [-20, 50, 140])
@pytest.mark.parametrize(("what", "value", "lane"), [(SCD, 1, "SCD"), (SCD, 0, "SCD"), (ADDRESS, 0x68, "I2COAR")])
def test_a_flag_that_the_chain_names_has_its_lane_wherever_it_changes(what: str, value: int, lane: str, tick: int):
    window = flagged(what, value, tick)
    assert f">{lane}<" in svg_picture(window)
    text = next(line for line in text_picture(window, 100) if line.startswith(lane)).removeprefix(lane).strip()
    if what == ADDRESS:
        assert ("0x68" in text) == (tick < 100)
    elif tick != 50:  # one level all along, drawn in the lane's upper or in its lower row
        assert bool(text) == ((value == 1) == (tick < 0))
