"""The closed form of a case: a case goes in, and with what two short runs show of its firmware a ClosedForm comes out.

case --no host--> waits and code --.
     --host alone--> routines -----+--> ClosedForm      BadBound, a sentence, for a case that has none
"""

from __future__ import annotations

from ...core.options import options_from
from ...core.time import Timebase
from ...f28335.i2c.options import I2cOptions
from ...scene.case.model import Case
from .closed_form import ClosedForm
from .service_routine import observe_handlers
from .terms import BadBound
from .undisturbed_run import observe, serving_unit


def closed_form(case: Case) -> ClosedForm:
    """The closed form of a case. BadBound if it has none."""
    unit = serving_unit(case)
    for name, one in case.unit.items():
        if not one.firmware:
            runs = "an image" if one.image else "C sources"
            what = f"unit {name} runs {runs}, and terms are found in Python firmware; judge it by what a run shows"
            raise BadBound(f"case {case.name}: {what}")
    if case.fault:
        raise BadBound(f"case {case.name}: the case has faults, which no bound counts; judge them by what a run shows")
    disturbed = [name for name, chip in case.chip.items() if chip.stretch is not None or chip.fault]
    tables = (
        ("[[cable]]", case.cable),
        ("[[transceiver]]", case.transceiver),
        ("[serial]", case.serial),
        ("[outside]", case.outside),
        ("[device.NAME]", case.device),
        ("stretch or fault in [chip.NAME]", disturbed),
    )
    for table, given in tables:
        if given:
            what = f"the case has {table}, which no bound counts; judge it by what a run shows"
            raise BadBound(f"case {case.name}: {what}")
    if case.host is not None and case.host.twice:
        raise BadBound(
            f"case {case.name}: some frames are sent twice (host.twice), which no bound counts; leave host.twice out"
        )
    calm = observe(case)
    timebase = Timebase(*(int(each.oscclk * each.pll / 2) for each in case.unit.values()))
    options = options_from(I2cOptions, case.unit[unit].options.get("i2c", {}))
    return ClosedForm(case, calm, observe_handlers(case, unit), timebase, options)
