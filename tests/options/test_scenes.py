"""Every option has a named scene whose records depend on it, and which lists it as assumed."""

from __future__ import annotations

import dataclasses
from functools import cache

import pytest

from periph_sim.core.options import Value
from tests.options import i2c_scenes, sci_scenes, spi_scenes, system_scenes
from tests.options.test_unrecorded import UNRECORDED
from tests.options.unit import KINDS, Outcome, Scene, run

SCENES: dict[str, dict[str, Scene]] = {
    "i2c": i2c_scenes.SCENES,
    "sci": sci_scenes.SCENES,
    "spi": spi_scenes.SCENES,
    "system": system_scenes.SCENES,
}
ROWS = [
    (group, *row)
    for group, scenes in (("i2c", i2c_scenes), ("sci", sci_scenes), ("spi", spi_scenes), ("system", system_scenes))
    for row in scenes.ROWS
]
ALL = [(group, name) for group, scenes in SCENES.items() for name in scenes]


@cache
def by_default(group: str, scene: str) -> Outcome:
    return run(SCENES[group][scene])


def others(group: str, option: str, scene: Scene) -> list[Value]:
    """Return the answers to an option that a scene does not use, or the ends of the range of a number."""
    about = {of.name: of for of in dataclasses.fields(KINDS[group])}[option]
    taken = scene.answers.get(group, {}).get(option, about.default)
    known = about.metadata
    return [value for value in known.get("values", (known.get("least"), known.get("most"))) if value != taken]


def test_every_option_has_a_row_and_every_scene_is_used():
    declared = {(group, of.name) for group, kind in KINDS.items() for of in dataclasses.fields(kind)}
    assert declared == {(group, option) for group, option, _, _ in ROWS}
    assert set(ALL) == {(group, scene) for group, _, scene, _ in ROWS}


@pytest.mark.parametrize(("group", "option", "scene", "answer"), ROWS)
def test_an_option_decides_the_records_of_its_scene_which_lists_it(group: str, option: str, scene: str, answer: Value):
    default, other = by_default(group, scene), run(SCENES[group][scene], group, **{option: answer})
    assert default.records != other.records
    assert f"{group}.{option}" in default.assumed & other.assumed


@pytest.mark.parametrize("group", SCENES)
def test_an_option_is_listed_with_each_answer(group: str):
    for of in dataclasses.fields(KINDS[group]):
        scene = SCENES[group][next(name for one, option, name, _ in ROWS if (one, option) == (group, of.name))]
        for value in others(group, of.name, scene):
            assert f"{group}.{of.name}" in run(scene, group, **{of.name: value}).assumed, (of.name, value)


NEAR = [  # scenes that are close to the effect of an option, but do not depend on it
    ("i2c", "al_clears_stt", "foreign START"),
    ("i2c", "bb_on_irs_reset", "registers"),
    ("i2c", "oar_zero", "START byte"),
    ("i2c", "tx_underflow_policy", "IRS = 1 in a stretch"),
    ("sci", "rxerr_int_mode", "long break"),
    ("sci", "rxffovf_interrupt", "words in the FIFO"),
    ("spi", "int_flag_point", "not read"),
    ("spi", "rxffovf_interrupt", "status in FIFO mode"),
    ("spi", "ste_high_mid_character", "answered"),
    ("system", "pf2_read_ws", "frame 2 written"),
    ("system", "saram_conflict", "asleep"),
    ("system", "stalls", "push"),
]


@pytest.mark.parametrize(("group", "option", "scene"), NEAR)
def test_a_scene_does_not_list_an_option_without_an_effect_on_it(group: str, option: str, scene: str):
    default = by_default(group, scene)
    assert f"{group}.{option}" not in default.assumed
    for value in others(group, option, SCENES[group][scene]):
        assert run(SCENES[group][scene], group, **{option: value}).records == default.records


@pytest.mark.parametrize("group", SCENES)
def test_no_option_is_listed_by_all_scenes(group: str):
    listed = [by_default(group, scene).assumed for scene in SCENES[group]]
    assert not {name for name in set.intersection(*listed) if name.startswith(f"{group}.")}


@pytest.mark.parametrize("group", SCENES)
def test_answers_that_a_model_reads_unrecorded_have_no_effect_unless_listed(group: str):
    """If a scene does not list one of these options, its other answers do not change the records."""
    names = {of.name for of in dataclasses.fields(KINDS[group])} & set().union(*UNRECORDED.values())
    for name, scene in SCENES[group].items():
        default = by_default(group, name)
        for option in sorted(names):
            if f"{group}.{option}" not in default.assumed:
                for value in others(group, option, scene):
                    assert run(scene, group, **{option: value}).records == default.records, (name, option, value)
