"""The page docs/keys.md, generated from docstrings, annotations and defaults of the tables of case files.

tables of a case --descriptions, schema, defaults--> a section with a row for each key --> docs/keys.md
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from fractions import Fraction
from itertools import groupby

from periph_sim.bus.faults import When
from periph_sim.bus.faults import kinds as kinds_of_fault
from periph_sim.core.convert import Key, keys_of
from periph_sim.core.table import Spread, Table
from periph_sim.devices.targets import families
from periph_sim.devices.targets.register_settings import Interrupt, RegisterTable
from periph_sim.devices.watchers import watchers
from periph_sim.scene.case.device_tables import DeviceFault, DeviceTable, StretchTable, WatchTable
from periph_sim.scene.case.inputs_table import InputsTable
from periph_sim.scene.case.json_schema import descriptions, schema_of
from periph_sim.scene.case.model import Case
from periph_sim.scene.case.party_tables import (
    ChipTable,
    Controller,
    HostTable,
    OutsideTable,
    RequestTable,
    RoundsTable,
    ValueTable,
)
from periph_sim.scene.case.serial import ExpectTable, SendTable, SerialTable
from periph_sim.scene.case.unit_table import Code, Compile, StubTable, Unit
from periph_sim.scene.case.wiring import Cable, TransceiverTable
from periph_sim.timing.budget_schema import SPAN, Budget
from periph_sim.timing.measures.factory import PREFIXES, UNSOLICITED
from periph_sim.timing.measures.registry import MEASURES, PHRASES
from tests.docs.pages import ROOT
from tests.timing.events_by_hand import make

PAGE = ROOT / "docs" / "keys.md"
HEAD = """# Keys of case files

This page is generated from the sources. [cases.md](cases.md) explains what a case is and how values are written. Keys
without a default are optional, unless the last column says *required*.
"""
TABLES: dict[str, type] = {  # in the order of the page; the settings of devices, watchers and faults follow theirs
    "The case": Case,
    "`[unit.NAME]`": Unit,
    "`[unit.NAME.compile]`": Compile,
    "`[[unit.NAME.stub]]`": StubTable,
    "`[unit.NAME.code]`": Code,
    "`[[cable]]`": Cable,
    "`[[transceiver]]`": TransceiverTable,
    "`[chip.NAME]`": ChipTable,
    "`[chip.NAME.values]`": ValueTable,
    "`[device.NAME]`": DeviceTable,
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
    "`[inputs]`": InputsTable,
    "`[[serial.send]]`": SendTable,
    "`[[serial.expect]]`": ExpectTable,
    "`[watch.NAME]`": WatchTable,
    "`[[fault]]`": When,
    "`[[budget]]`": Budget,
}
SCALES = {  # units of numbers that a file contains as text, by a part of their pattern
    "ns|us|ms": (("s", Fraction(1)), ("ms", Fraction(1, 1000)), ("us", Fraction(1, 10**6)), ("ns", Fraction(1, 10**9))),
    "kHz": (("MHz", Fraction(10**6)), ("kHz", Fraction(1000)), ("Hz", Fraction(1))),
    "%": (("%", Fraction(1, 100)),),
}
FILE = re.compile(r"(?<![\[(])\b(\w+\.md)\b")  # the name of a page in a docstring
Row = tuple[str, str, str]


def added() -> dict[str, dict[str, type]]:
    """Return the settings that a model, a kind of watch or a kind of fault adds to a table, by heading."""
    models = {family: family.MODELS for family in families().values()}
    return {
        "`[device.NAME]`": {_span(names): family.Settings for family, names in models.items()},
        "`[watch.NAME]`": {f"`{name}`": family.Settings for name, family in watchers().items()},
        "`[[fault]]`": {f"`{name}`": kind.Settings for name, kind in kinds_of_fault().items()},
    }


def _span(models: tuple[str, ...]) -> str:
    """Return the names of a family's models, or the first and the last one of many."""
    return f"`{models[0]}` to `{models[-1]}`" if len(models) > 2 else " and ".join(f"`{one}`" for one in models)


def page() -> str:
    """Return the text of docs/keys.md."""
    return FILE.sub(r"[\1](\1)", "\n".join([HEAD, *_sections(), _measures()]))


def _sections() -> Iterator[str]:
    for heading, table in TABLES.items():
        yield _section("##", heading, table, descriptions(table)[1])
        common = descriptions(When)[1] if table is When else {}
        for name, settings in added().get(heading, {}).items():
            own = descriptions(settings)[1]
            yield _section("###", name, settings, {key: own[key] for key in own if key not in common})


def _section(level: str, heading: str, table: type, described: Mapping[str, str]) -> str:
    keys = keys_of(table)
    rows = [(message, described[message], default(keys[message])) for message in described]
    about = descriptions(table)[0]
    return f"{level} {heading}\n\n{about}\n" + (f"\n{_table(rows)}" if rows else "")


def _table(rows: list[Row]) -> str:
    lines = ["| key | meaning | default |", "|---|---|---|"]
    for (what, value), several in groupby(rows, lambda row: row[1:]):
        names = ", ".join(f"`{name}`" for name, *_ in several)
        lines.append(f"| {names} | {what} |{f' {value} ' if value else ' '}|".replace("||", "| |"))
    return "\n".join(lines) + "\n"


def default(key: Key) -> str:
    """Return the default of a key as a case file contains it; "" for an empty one, "required" if there is none."""
    value = key.default
    if key.is_required:
        return "required"
    if value is None or value in ("", b"", (), {}) or isinstance(value, Table):
        return ""
    if isinstance(value, Spread):
        value = value.least  # a default is a single value
    pattern = str(schema_of(key.annotation, {}))
    for part, units in SCALES.items():
        if part in pattern and isinstance(value, Fraction):
            name, scale = next(one for one in units if (value / one[1]).denominator == 1 and (value or one[0] == "s"))
            return f'`"{value / scale} {name}"`'
    return f"`{value if isinstance(value, Fraction) else json.dumps(value)}`"


def _measures() -> str:
    """Return the section of the measures that have a fixed name or are made from the name of an entry."""
    lines = ["## Measures", "", "| measure | unit | definition |", "|---|---|---|"]
    abouts = {name: row.about for name, row in MEASURES.items()} | {f"{SPAN}NAME": PHRASES["span"].about}
    for name in [*MEASURES, UNSOLICITED, *(f"{prefix}NAME" for prefix in (SPAN, *PREFIXES))]:
        measure = make(name)
        about = (abouts.get(name) or measure.__doc__ or "").strip().split(".")[0]
        lines.append(f"| `{name}` | {measure.unit} | {about}. |")
    return "\n".join(lines) + "\n"
