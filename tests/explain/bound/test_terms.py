"""What was measured counts as a bound only where the same code took the same cycles, and no data or phase decides it.

Each firmware is the IMU emulator with one statement more.
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from periph_sim.explain.bound import Report, report
from periph_sim.scene.case.load import load
from tests.scene.runs import TIMING

SOURCE = Path(__file__).parents[3] / "firmware" / "python" / "imu_hil.py"
PLACES = {
    "service": "        while True:\n            i2c.I2CDXR.all = next(buffer)",
    "routine": "        sci.SCIFFRX.RXFFOVRCLR = 1",
    "models": '        dsp.compute(self.cost, "model")',
}


def with_statement(folder: Path, place: str, statement: str, *changes: str) -> Report:
    """Bounds of the emulator that runs this statement before each I2CDXR write, in its routine, or its models."""
    text = SOURCE.read_text(encoding="utf-8")
    before = PLACES[place]
    assert text.count(before) == 1
    head, _, rest = before.partition("\n")
    lead = "            " if place == "service" else "        "
    added = statement.replace("\n", f"\n{lead}")
    new = f"{head}\n{lead}{added}\n{rest}" if rest else f"{lead}{added}\n{head}"
    text = text.replace(before, new).replace("Duration, HexBytes", "Duration, DurationRange, HexBytes, spread")
    text = text.replace("    count: int = 6", "    count: int = 6\n    cost: DurationRange = spread('0 s')")
    (folder / "changed.py").write_text(text, encoding="utf-8")
    return report(
        load(TIMING / "imu_hil_published.toml", [f"unit.dsp.firmware={folder / 'changed.py'}", *changes]), TIME
    )


TIME = Fraction(1, 20)
BOUNDED = {"model execution", "response", "stretch", "round complete", "schedule slack", "missed rounds"}
BOUNDED |= {"nacked rounds", "data age", "SCI FIFO high-water", "SCI overruns"}


def unproven(found: Report) -> dict[str, str]:
    return {limit.budget: limit.reason.partition(": ")[2] or limit.reason for limit in found.unproven}


def test_as_it_is_every_term_is_a_bound():
    assert not report(load(TIMING / "imu_hil_published.toml"), TIME).unproven


def test_constant_code_enters_with_what_it_takes(tmp_path):
    plain, longer = (with_statement(tmp_path, "service", f"dsp.compute({n})") for n in (0, 20))
    assert not longer.unproven
    sums = [next(b.bound.sum for b in found.beside if b.bound.name == "response") for found in (plain, longer)]
    assert sums[1] - sums[0] == 20 * 20  # ticks


@pytest.mark.parametrize(
    ("place", "statement", "reason"),
    [
        ("service", "if self.frame[0] & 1:\n    dsp.compute(10)", "'if self.frame[0] & 1' decides what runs"),
        ("service", "dsp.compute(self.frame[0])", "'self.frame[0]' decides what a computation costs"),
        ("service", "if i2c.I2CSTR.BB == 1:\n    dsp.compute(1)", "'if i2c.I2CSTR.BB == 1' decides what runs"),
        ("routine", "if sci.SCIFFRX.RXFFOVF:\n    return", "'if sci.SCIFFRX.RXFFOVF' decides what runs"),
        ("routine", "[self.dsp.compute(1) for _ in self.frame]", "'for ... in self.frame' decides how often code runs"),
    ],
)
def test_what_data_or_flags_decide_is_no_bound_though_no_run_shows_it(
    tmp_path, place: str, statement: str, reason: str
):
    found = with_statement(tmp_path, place, statement)
    assert unproven(found) == dict.fromkeys(BOUNDED, reason)
    assert found.holds and not found.passed and not found.beyond


def test_code_that_another_round_takes_longer_is_no_bound(tmp_path):
    """Every second round has 5 cycles more, of which the source says nothing that could be followed."""
    text = "self.n = getattr(self, 'n', 0) + 1\ndsp.compute(5 * (self.n // 21 % 2))"
    reasons = unproven(with_statement(tmp_path, "service", text)).values()
    assert all("decides what a computation costs" in reason for reason in reasons)
    assert any("cycles once and" in limit.reason for limit in with_statement(tmp_path, "service", text).unproven)


def test_what_only_the_models_path_depends_on_leaves_the_response_a_bound(tmp_path):
    """The deadline that the next request waits for rests on the models, so all else does."""
    found = with_statement(tmp_path, "models", "if self.frame[0] & 1:\n    dsp.compute(10)")
    (response,) = (each.bound for each in found.beside if each.bound.name == "response")
    assert [term.what for term in response.terms if term.unproven] == ["deadlines are kept"]
    assert set(unproven(found)) == BOUNDED


def test_a_declared_spread_enters_with_its_end(tmp_path):
    """As a setting it is known; made anew each time, of whatever, it is not."""
    at_400k = "controller.rate=400 kHz"
    fixed = with_statement(tmp_path, "service", "dsp.compute(450)", at_400k)
    made = with_statement(tmp_path, "service", "dsp.compute(spread('1 us to 3 us'))", at_400k)
    setting = with_statement(
        tmp_path, "service", "dsp.compute(self.settings.cost)", at_400k, "unit.dsp.settings.cost=1 us to 3 us"
    )
    assert unproven(made) == dict.fromkeys(BOUNDED, "'spread('1 us to 3 us')' decides what a computation costs")
    assert not setting.unproven
    assert [each.bound.sum for each in setting.beside] == [each.bound.sum for each in fixed.beside]
    assert all(each.holds for each in setting.beside)
