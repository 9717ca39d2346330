"""Cost of things that a scene does not name, compared with naming them: imports, objects, events and memory.

    scenes of tests/scene/absent.py, form --> a process per scene --> a row for each thing that can be absent

tests/scene/test_absent.py requires zero imports and objects of absent things. Here, the cost of presence is shown.
"""

from __future__ import annotations

import tempfile
import tracemalloc
from collections.abc import Iterator, Sequence
from contextlib import chdir
from pathlib import Path
from typing import Any

from periph_sim import form
from tests.scene import absent

from .child import in_form

Row = dict[str, Any]


def rows(forms: Sequence[str]) -> Iterator[Row]:
    for which in forms:
        bare = in_form(which, "nothing", "counted")
        for what, row in absent.ROWS.items():
            if row.present:
                continue
            having = in_form(which, "nothing", "counted", what)
            lacking = bare["modules"], bare["objects"]
            yield {
                "absent": what,
                "form": which,
                "imports": len(in_rooms(lacking[0], row.packages)),
                "objects": sum(instances(lacking[1], row.packages).values()),
                "imports_with_it": len(in_rooms(having["modules"], row.packages)),
                "objects_with_it": sum(instances(having["objects"], row.packages).values()),
                "events": bare["events"],
                "events_with_it": having["events"],
                "kib": bare["kib"],
                "kib_with_it": having["kib"],
            }


def counted(what: str = "") -> Row:
    """Run the scene with this thing in this process. Without a name, run the slave of `BARE` with nothing else."""
    tables, record = (absent.ROWS[what].named, absent.ROWS[what].record) if what else (absent.BARE["slave"], "")
    with tempfile.TemporaryDirectory() as folder, chdir(folder):
        Path("mine.py").write_text(absent.DEVICE, "utf-8")
        tracemalloc.start()
        scene = absent.run(tables, record)
        kib = tracemalloc.get_traced_memory()[0] / 1024  # imports included
        tracemalloc.stop()
    found = absent.census(scene)
    return {
        "modules": absent.loaded(),
        "objects": found,
        "events": scene.kernel.events,
        "kib": kib,
        "form": form.running,
    }


def in_rooms(names: Sequence[str], packages: tuple[str, ...]) -> list[str]:
    return [name for name in names if absent.is_in_packages(name, packages)]


def instances(objects: dict[str, int], packages: tuple[str, ...]) -> dict[str, int]:
    return {name: count for name, count in objects.items() if absent.is_in_packages(name.rpartition(".")[0], packages)}


def line(row: Row) -> str:
    return (
        f"without {row['absent']:24} {row['form']:12} {row['imports']} imports, {row['objects']} objects; with it "
        f"{row['imports_with_it']:3} and {row['objects_with_it']:3}, "
        f"events {row['events']} and {row['events_with_it']}, "
        f"memory {row['kib']:,.0f} and {row['kib_with_it']:,.0f} KiB"
    )
