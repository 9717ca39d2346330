"""The levels of a case: its fidelities, and the arithmetics and poll models that its firmware has settings for."""

from __future__ import annotations

from pathlib import Path
from typing import get_args

import pytest

from periph_sim.reports.trade.levels import FIDELITIES, REFERENCE, chosen, levels_of
from periph_sim.scene.case.fidelity import Level
from periph_sim.scene.case.load import load
from periph_sim.scene.case.model import BadCase

TIMING = Path(__file__).resolve().parents[3] / "timing"


def names(case: str, *changes: str) -> list[str]:
    return [level.name for level in levels_of(load(TIMING / f"{case}.toml", list(changes)))]


def test_every_fidelity_that_a_case_takes_is_a_level_and_edge_is_the_reference():
    assert names("responder")[: len(FIDELITIES)] == list(FIDELITIES)
    assert FIDELITIES[0] == REFERENCE and set(FIDELITIES) == set(get_args(Level))


def test_a_table_of_levels_for_each_bus_is_a_level_of_its_own():
    change = 'fidelity={I2C-A = "byte", SCI-A = "edge"}'
    own = "I2C-A=byte SCI-A=edge"
    assert names("imu_hil", change)[: len(FIDELITIES) + 1] == [*FIDELITIES, own]
    assert own not in names("imu_hil")
    found = {level.name: level for level in levels_of(load(TIMING / "imu_hil.toml", [change]))}[own]
    assert found.changes == () and not found.same_records


def test_levels_with_the_records_of_edge_are_known():
    change = 'fidelity={I2C-A = "adaptive", SCI-A = "edge"}'
    same = [level.name for level in levels_of(load(TIMING / "imu_hil.toml", [change])) if level.same_records]
    assert same == ["edge", "adaptive", "I2C-A=adaptive SCI-A=edge"]


def test_arithmetics_are_levels_of_firmware_that_computes_only():
    assert "arithmetic=float32" in names("imu_hil") and "arithmetic=q16" not in names("imu_hil")
    assert "arithmetic=q16" in names("imu_hil_published")  # by default bytes
    assert not any(name.startswith("arithmetic") for name in names("responder"))


def test_poll_models_are_left_out_where_the_case_has_them_already():
    assert "skip_polls=false" not in names("responder", "unit.dsp.skip_polls=false")
    assert "poll_pass=7" not in names("responder", "unit.dsp.code.poll_pass=7")


def test_what_a_pass_costs_is_no_question_to_an_image():
    assert names("imu_hil_image") == [*FIDELITIES, "skip_polls=false"]
    image, python = (load(TIMING / f"{name}.toml").unit["dsp"] for name in ("imu_hil_image", "responder"))
    mixed = load(TIMING / "responder.toml").model_copy(update={"unit": {"a": image, "b": python}})
    slow = next(level for level in levels_of(mixed) if level.name == "poll_pass=21")
    assert slow.changes == ("fidelity=edge", "unit.b.code.poll_pass=21")


@pytest.mark.parametrize("case", ["imu_hil", "imu_hil_published", "two_dsps", "uart_logger", "imu_hil_image"])
def test_all_but_refused_levels_are_changes_that_the_case_takes(case: str):
    path = TIMING / f"{case}.toml"
    for level in levels_of(load(path)):
        assert load(path, list(level.changes)).fidelity == (level.name if level.name in FIDELITIES else REFERENCE)


def test_the_reference_is_always_among_the_chosen():
    levels = levels_of(load(TIMING / "responder.toml"))
    assert [level.name for level in chosen(levels, ("poll_pass=7",))] == ["edge", "poll_pass=7"]
    assert chosen(levels, ()) == levels
    with pytest.raises(BadCase, match="there is no level 'bytes' of this case"):
        chosen(levels, ("bytes",))
