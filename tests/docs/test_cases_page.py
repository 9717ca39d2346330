"""docs/cases.md names every table, key, default and measure of a case, and no other."""

from __future__ import annotations

import re
import tomllib
from dataclasses import fields

import pytest

from periph_sim.bus.faults import When, kinds
from periph_sim.core.convert import Mistake, keys_of
from periph_sim.core.table import Table
from periph_sim.devices.targets import eeprom, families, registers, rtc
from periph_sim.devices.targets.register_settings import Interrupt, RegisterTable, Sets
from periph_sim.devices.watchers import blink, edges, watchers
from periph_sim.f28335.parts.f28335 import PART
from periph_sim.imu.sensors import SENSORS as CHIPS
from periph_sim.scene.case.device_tables import BusParty, DeviceFault, DeviceTable, StretchTable, Strikes, WatchTable
from periph_sim.scene.case.model import (
    Case,
    ChipTable,
    Controller,
    HostTable,
    OutsideTable,
    RequestTable,
    RoundsTable,
    ValueTable,
)
from periph_sim.scene.case.serial import ExpectTable, SendTable, SerialEntry, SerialTable
from periph_sim.scene.case.unit_table import Code, Compile, StubTable, Unit
from periph_sim.scene.case.wiring import Cable, TransceiverTable
from periph_sim.timing.budget_schema import REPLY, SPAN, WATCH, Budget, Condition, Limited
from periph_sim.timing.measures.registry import MEASURES, PHRASES
from tests.docs.pages import ROOT
from tests.timing.events_by_hand import make

PAGE = (ROOT / "docs" / "cases.md").read_text(encoding="utf-8")
TABLES: dict[str, type[Table]] = {
    "The case": Case,
    "`[unit.NAME]`": Unit,
    "`[unit.NAME.code]`": Code,
    "`[unit.NAME.compile]`": Compile,
    "`[[unit.NAME.stub]]`": StubTable,
    "`[[cable]]`": Cable,
    "`[[transceiver]]`": TransceiverTable,
    "`[chip.NAME]`": ChipTable,
    "`[chip.NAME.values]`": ValueTable,
    "`[device.NAME]`": DeviceTable,
    "`24c02` to `24lc512`": eeprom.Settings,
    "`isl12026` and `x1226`": rtc.Settings,
    "`registers`": registers.Settings,
    "`[[device.NAME.register]]`": RegisterTable,
    "`[device.NAME.interrupt]`": Interrupt,
    "`[device.NAME.stretch]`": StretchTable,
    "`[[device.NAME.fault]]`": DeviceFault,
    "`[controller]`": Controller,
    "`[[controller.request]]`": RequestTable,
    "`[rounds]`": RoundsTable,
    "`[outside]`": OutsideTable,
    "`[host]`": HostTable,
    "`[serial]`": SerialTable,
    "`[[serial.send]]`": SendTable,
    "`[[serial.expect]]`": ExpectTable,
    "`[watch.NAME]`": WatchTable,
    "`edges`": edges.Settings,
    "`blink`": blink.Settings,
    "`[[budget]]`": Budget,
}
LIKE: dict[str, type[Table]] = {  # the table that a section refers to with "as there"
    "`[chip.NAME]`": DeviceTable,
    "`[[device.NAME.fault]]`": StretchTable,
    "`[rounds]`": Controller,
}
EMPTY: tuple[object, ...] = (None, "", (), {}, b"", Code(), Compile())


def rows(heading: str) -> list[list[str]]:
    """The cells of the table under a heading, without its head."""
    section = re.split("\n##+ ", re.split(f"\n##+ {re.escape(heading)}\n", PAGE)[1])[0]
    lines = [line for line in section.splitlines() if line.startswith("|")][2:]
    return [[cell.strip() for cell in line.strip("|").split(" | ")] for line in lines]


@pytest.mark.parametrize("heading", TABLES)
def test_every_key_with_its_default(heading: str):
    kind = TABLES[heading]
    shared = {name for base in (BusParty, Strikes) if issubclass(kind, base) for name in keys_of(base)}
    keys = keys_of(kind)
    fields = {name: keys[name] for name in sorted(keys, key=lambda name: name in shared)}  # its own ones first
    shown = {one.strip("`"): default for key, _, default in rows(heading) for one in key.split(", ")}
    if issubclass(kind, SerialEntry):  # the page has the keys of both tables where a reader expects them
        assert sorted(shown) == sorted(fields)
    else:
        assert list(shown) == list(fields)
    for name, default in shown.items():
        about = fields[name]
        if default == "as there":
            assert about.default == keys_of(LIKE[heading])[name].default and not about.is_required, name
        elif default in ("required", ""):
            assert about.is_required == (default == "required"), name
            assert default == "required" or about.default in EMPTY, name
        else:
            value = tomllib.loads(f"value = {default.strip('`')}")["value"]
            wrong: list[Mistake] = []
            assert about.convert(value, (), wrong) == about.default and not wrong, name


def test_every_table_of_the_model_has_a_section():
    told = (Case, Unit, Cable, TransceiverTable, SerialTable, Budget, DeviceTable, RegisterTable, WatchTable)
    modules = {kind.__module__ for kind in told}
    bases = (Table, BusParty, Strikes, Limited, SerialEntry)
    kinds = {kind for base in bases for kind in base.__subclasses__() if kind.__module__ in modules}
    elsewhere = {eeprom.Settings, rtc.Settings, edges.Settings, blink.Settings}
    assert kinds - {BusParty, Strikes, Limited, Condition, Sets, SerialEntry} == {*TABLES.values()} - elsewhere


def test_every_family_of_devices_has_a_section():
    kinds = [*families().values(), *watchers().values()]
    assert {family.Settings for family in kinds} <= set(TABLES.values())


def test_every_measure_with_its_unit_and_meaning():
    measures = {name: make(name) for name in [*MEASURES, f"{SPAN}NAME", f"{REPLY}NAME", f"{WATCH}NAME"]}
    shown = [(name.strip("`"), unit, what.split(".")[0]) for name, unit, what in rows("Measures")]
    abouts = {name: row.about for name, row in MEASURES.items()} | {f"{SPAN}NAME": PHRASES["span"].about}
    assert shown == [
        (name, measure.unit, abouts.get(name, measure.__doc__ or "").strip().split(".")[0])
        for name, measure in measures.items()
    ]


def test_every_module_and_chip_is_named():
    what = {key.strip("`"): text for key, text, _ in rows("`[unit.NAME]`") + rows("`[controller]`")}
    assert re.findall(r"[A-Z0-9]+(?:-[A-C])?", what["modules"]) == list(PART.selectable)
    assert all(chip in what["order"] for chip in CHIPS)


def test_every_kind_of_fault_with_its_keys():
    common = {f.name for f in fields(When)}
    own = {name: {f.name for f in fields(kind.Settings)} - common for name, kind in kinds().items()}
    listed = rows("`[[fault]]`")
    assert [key.strip("`") for key, *_ in listed[: len(common) + 1]] == ["kind", *(f.name for f in fields(When))]
    shown = {key.strip("`"): set(re.findall(r"`(\w+)`", keys)) for key, _, keys in listed[-len(own) :]}
    assert shown == own
