"""The table, `--json`, `check`, pictures, the HTML page and a recording show the same instant for a verdict."""

from __future__ import annotations

import json
import re
from html import unescape
from pathlib import Path

import pytest

from periph_sim.interfaces.commands.new import TEMPLATES
from periph_sim.interfaces.pytest_plugin.runs import Plan, run_plan
from periph_sim.scene.case.load import load
from periph_sim.traces.formats.psr import read_table
from tests.interfaces.commands.conftest import Run
from tests.unwrapped import unwrapped

IMU = """name = "imu"
duration = "60 ms"

[unit.dsp]
firmware = "imu_hil"
modules = ["I2C-A", "SCI-A", "GPIO"]
pins = { MODEL = 34 }

[controller]
order = ["gyroscope"]

[host]
baud = 115200
"""
JUDGED = {  # a budget, a limit that breaks, and the template of its case; IMU without a template
    "stretch": ('max = "1 us"', "i2c_slave"),  # during a low phase of SCL
    "busy time of 0x50": ('max = "1 us"', "eeprom_slave"),
    "unsolicited replies": ("max = 0", "sci_protocol"),
    "age": ('max = "1 ms"', ""),  # before the value is read
    "gap between rounds": ('min = "30 ms"', ""),
}


def write_case(measure: str) -> None:
    """Write case.toml, whose budget `judged` breaks."""
    limit, kind = JUDGED[measure]
    text = IMU
    if kind:
        firmware = (TEMPLATES / f"{kind}.py").read_text(encoding="utf-8").replace("# dsp.compute", "dsp.compute")
        Path(f"{kind}.py").write_text(firmware, encoding="utf-8")
        text = (TEMPLATES / f"{kind}.toml").read_text(encoding="utf-8").partition("[[budget]]")[0]
        text = text.replace('"OK\\n"', '"O"')  # the rest of this reply is unsolicited
    budget = f'\n[[budget]]\nname = "judged"\nmeasure = "{measure}"\n{limit}\n'
    Path("case.toml").write_text(text + budget, encoding="utf-8")


@pytest.mark.parametrize("measure", JUDGED)
def test_all_outputs_show_the_same_instant(periph_sim: Run, here: Path, measure: str):
    write_case(measure)
    table = periph_sim("run", "case.toml", "--record", "run.psr", "--html", "run.html").out
    (at,) = re.findall(r"^judged: .*, at (\d+\.\d{6} s)", table, re.MULTILINE)
    result = periph_sim("run", "case.toml", "--json").json_object
    (verdict,) = (one for one in result["budgets"] if one["name"] == "judged")
    assert f"{verdict['at_s']:.6f} s" == at
    assert f", at {at}" in periph_sim("check", "case.toml").out
    report = periph_sim("worst", "case.toml", "judged", "--svg", ".").out
    picture = Path("judged.svg").read_text(encoding="utf-8")
    assert re.findall(r"judged: worst [^<]* at (\d\.\d{6} s)<", picture) == [at]
    assert [*re.findall(r"from (\d\.\d{6} s) on", picture), *re.findall(r"from (\d\.\d{6} s) on", report)] == [at, at]
    page = Path("run.html").read_text(encoding="utf-8")
    assert at in re.findall(r"Worst occurrence[^<]* at (\d\.\d{6} s)<", page)
    scripts = map(json.loads, re.findall(r'<script type="application/json"[^>]*>(.*?)</script>', page, re.DOTALL))
    origins = {int(one["origin"]) for one in scripts if isinstance(one, dict) and "origin" in one}
    records = read_table(Path("run.psr"))
    assert records.per_second is not None
    tick = round(verdict["at_s"] * float(records.per_second))
    assert tick in origins and any(abs(record.tick - tick) <= 1 for record in records.records())


def test_all_outputs_quote_an_unexpected_answer(periph_sim: Run, here: Path):
    """The firmware answers a command that it must ignore: run, check, the page and pytest report it."""
    write_case("unsolicited replies")
    text = Path("case.toml").read_text(encoding="utf-8").partition("[[budget]]")[0]
    forbidden = 'name = "ghost"\nto = "dsp.SCI-A"\ntext = "X\\n"\nat = "15 ms"\nexpect = "nothing"\nwithin = "2 ms"\n'
    Path("case.toml").write_text(f"{text}\n[[serial.send]]\n{forbidden}", encoding="utf-8")
    message = re.compile(
        r"nothing was expected from dsp\.SCI-A after send 'ghost', but 'ERROR\\n' came, which ended at 0\.0157\d\d s"
    )
    ran = periph_sim("run", "case.toml", "--html", "run.html")
    assert ran.status == 1 and message.search(unwrapped(ran.out))
    checked = periph_sim("check", "case.toml", "--annotations", "github")
    assert checked.status == 1 and message.search(unwrapped(checked.out))
    assert message.search(unescape(Path("run.html").read_text(encoding="utf-8")))
    with pytest.raises(AssertionError) as caught:
        run_plan(Plan(load("case.toml")), lambda run, verdicts: None).assert_budgets("ghost")
    assert message.search(str(caught.value))
    assert re.search(r"SCITXBUF written, 0x45: unsolicited \[sci_protocol\.py:\d+", unwrapped(str(caught.value)))
