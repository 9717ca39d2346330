"""docs/keys.md has every table, key, default and measure of a case, and docs/cases.md links to every table."""

from __future__ import annotations

import re
import tomllib

import pytest

from periph_sim.core.convert import Mistake, keys_of
from periph_sim.core.table import Spread, Table
from periph_sim.devices.targets import families
from periph_sim.devices.watchers import watchers
from periph_sim.f28335.parts.f28335 import PART
from periph_sim.imu.sensors import SENSORS
from periph_sim.scene.case.device_tables import BusParty, FaultTrigger
from periph_sim.scene.case.json_schema import descriptions
from periph_sim.scene.case.party_tables import Controller
from periph_sim.scene.case.serial import SerialEntry
from periph_sim.scene.case.unit_table import Unit
from periph_sim.timing.budget_schema import Condition, Limited
from tests.docs import commands
from tests.docs.keys import PAGE, TABLES, added, default, page
from tests.docs.pages import ROOT

SECTIONS = TABLES | {name: settings for more in added().values() for name, settings in more.items()}


def test_the_pages_agree_with_the_sources():
    assert PAGE.read_text(encoding="utf-8") == page()
    assert commands.PAGE.read_text(encoding="utf-8") == commands.page()


@pytest.mark.parametrize("heading", SECTIONS)
def test_every_key_is_described_and_its_default_is_valid(heading: str):
    keys = keys_of(SECTIONS[heading])
    assert sorted(descriptions(SECTIONS[heading])[1]) == sorted(keys)
    for name, key in keys.items():
        shown = default(key)
        assert (shown == "required") == key.is_required, name
        if shown not in ("", "required"):
            value = tomllib.loads(f"value = {shown.strip('`')}")["value"]
            wrong: list[Mistake] = []
            read = key.convert(value, (), wrong)
            expected = key.default
            assert read == expected or read == Spread(expected.least, expected.most), name
            assert not wrong, name


def test_descriptions_and_defaults_are_read_from_a_class():
    class Own(Table, frozen=True, kw_only=True):
        """A table.

        named: a key
            with two lines
        other: not a key
        """

        named: int = 3
        silent: int = 4

    assert descriptions(Own) == ("A table.", {"named": "a key with two lines"})
    assert default(keys_of(Own)["silent"]) == "`4`"


def test_every_table_of_the_model_has_a_section():
    modules = {kind.__module__ for kind in SECTIONS.values()}
    bases = (Table, BusParty, FaultTrigger, Limited, SerialEntry)
    kinds = {kind for base in bases for kind in base.__subclasses__() if kind.__module__ in modules}
    inner = {kind for kind in kinds if kind.__name__ == "Sets"}  # is described with the key `sets`
    assert kinds - {*bases, Condition} - inner <= {*SECTIONS.values()}


def test_every_family_of_devices_and_watchers_has_a_section():
    kinds = [*families().values(), *watchers().values()]
    assert {family.Settings for family in kinds} <= {*SECTIONS.values()}


def test_cases_md_links_to_every_table_of_a_case():
    text = (ROOT / "docs" / "cases.md").read_text(encoding="utf-8")
    linked = re.findall(r"\[(`\[+\w+(?:\.NAME)?\]+`)\]\(keys\.md", text)
    assert sorted(linked) == sorted(one for one in TABLES if re.fullmatch(r"`\[+\w+(\.NAME)?\]+`", one))


def test_every_module_and_chip_is_named():
    assert re.findall(r"[A-Z0-9]+(?:-[A-C])?", descriptions(Unit)[1]["modules"]) == list(PART.selectable)
    assert all(chip in descriptions(Controller)[1]["order"] for chip in SENSORS)
