"""Every place of the product that keeps only the last items of a sequence, and the effect if an older one is needed."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import periph_sim

ROOT = Path(periph_sim.__file__).parent
PACKAGES = ("timing", "records", "interfaces/reports/explain", "scene", "devices", "processor")

WINDOWS = {
    ("timing/derived/origins.py", "deque"): "older frames are in a frame history, or the verdict is not judged",
    ("timing/derived/origins.py", "slice"): "omitted chains are counted as left out; _anew only finds more",
    ("timing/derived/error_records.py", "deque"): "a read that may belong to an omitted frame is not judged",
    ("devices/chips/adxl345.py", "slice"): "the FIFO of the chip",
    ("scene/serial/send_schedule.py", "slice"): "as many characters as in the text that they are compared with",
    ("records/subject.py", "slice"): "the parts of a name",
    ("processor/image_files/assemble.py", "slice"): "the last two names of a path",
    ("records/cause_trace/causes.py", "slice"): "`why` reports that it searched no further",
}


def windows(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call) and any(keyword.arg == "maxlen" for keyword in node.keywords):
            yield "deque"
        if isinstance(node, ast.Slice) and node.upper is None and node.lower is not None:
            lower = ast.unparse(node.lower)
            if lower.startswith("-") and lower != "-1":
                yield "slice"


def test_every_limited_window_is_listed_with_its_effect():
    found = {
        (path.relative_to(ROOT).as_posix(), kind)
        for package in PACKAGES
        for path in sorted((ROOT / package).rglob("*.py"))
        for kind in windows(path)
    }
    assert found == set(WINDOWS)
