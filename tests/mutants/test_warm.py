"""Modules that a warm process imports before its first test: all except the room and modules that need it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from tests.mutants.warm import modules

FILES = {
    "a/__init__.py": "",
    "a/low.py": "",
    "a/room/__init__.py": "",
    "a/room/code.py": "",
    "a/rooms.py": "",
    "a/above.py": "from a.room import code",
    "a/top.py": "try:\n    from a import above\nexcept ImportError:\n    above = None",
    "a/half/__init__.py": "from a.half import one\nfrom a import top",
    "a/half/one.py": "",
    "a/whole.py": "from a.half.one import *",
    "a/broken.py": "import no_such_library",
    "a/__main__.py": "raise SystemExit",
    "tests/__init__.py": "",
    "tests/test_a.py": "",
    "docs/conf.py": "",
    "setup.py": "",
}
PROGRAM = """
import sys
sys.path.insert(0, sys.argv[1])
from tests.mutants import warm
sys.path.remove(sys.argv[1])
for name in [name for name in sys.modules if name.startswith("tests")]:
    del sys.modules[name]
sys.path.insert(0, "")
sys.meta_path.insert(0, warm.Lock(["a.room"]))
from pathlib import Path
print(warm.open_to_all(warm.modules(Path.cwd())), [name for name in sys.modules if name[0:2] in ("a", "a.")])
"""


def test_exactly_the_modules_that_do_not_need_the_room_are_imported(tmp_path: Path) -> None:
    for path, text in FILES.items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text, encoding="utf-8")
    assert modules(tmp_path) == [
        *("a", "a.above", "a.broken", "a.half", "a.half.one", "a.low"),
        *("a.room", "a.room.code", "a.rooms", "a.top", "a.whole"),
    ]
    root = str(Path(__file__).parents[2])
    ran = subprocess.run(
        [sys.executable, "-c", PROGRAM, root], cwd=tmp_path, capture_output=True, text=True, check=True
    ).stdout
    assert ran == "['a', 'a.low', 'a.rooms'] []\n"  # and the attempts leave no modules imported
