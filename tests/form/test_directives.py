"""Each directive of a .pxd file has an effect in the C code, or the build stops and names it."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

import pytest

from periph_sim.form import build
from periph_sim.form.directives import disobeyed
from tests.form.package import written

SOURCE = """
class Plain:
    def doubled(self, at):
        twice = at * 2
        return twice

class Chained:
    pass
"""
PXD = """cimport cython

cdef class Plain:
    @cython.locals(twice=cython.longlong)
    cpdef long long doubled(self, long long at)

@cython.final
cdef class Chained:
    cdef public Chained following
"""

pytestmark = pytest.mark.skipif(find_spec("Cython") is None, reason="Cython is missing")


def c_code(folder: Path, pxd: str, monkeypatch: pytest.MonkeyPatch) -> str:
    (written(folder, "directed", one=SOURCE) / "one.pxd").write_text(pxd)
    monkeypatch.chdir(folder)
    return build.generate("one", "directed").read_text("utf-8")


def test_directives_that_have_an_effect_are_not_named(tmp_path, monkeypatch):
    assert list(disobeyed(PXD, c_code(tmp_path, PXD, monkeypatch))) == []


def test_without_the_trashcan_a_class_that_releases_objects_is_named(tmp_path, monkeypatch):
    monkeypatch.setattr(build, "FOR_ALL_CLASSES", {})
    assert list(disobeyed(PXD, c_code(tmp_path, PXD, monkeypatch))) == [
        "the deallocator of class Chained releases other objects by recursion: the directive trashcan is lost"
    ]


@pytest.mark.parametrize(
    ("line", "instead", "said"),
    [
        ("@cython.final", "@cython.freelist(16)", "@cython.freelist(16) of class Chained has no effect in the C code"),
        (
            "(twice=cython.longlong)",
            "(thrice=cython.longlong)",
            "@cython.locals(thrice=cython.longlong) of doubled declares no such variable in the C code",
        ),
    ],
    ids=["freelist in a .pxd file", "no such local variable"],
)
def test_a_directive_without_effect_is_named(tmp_path, monkeypatch, line: str, instead: str, said: str):
    pxd = PXD.replace(line, instead)
    assert list(disobeyed(pxd, c_code(tmp_path, pxd, monkeypatch))) == [said]


def test_a_class_that_is_not_final_in_c_is_named(tmp_path, monkeypatch):
    text = c_code(tmp_path, PXD.replace("@cython.final\n", ""), monkeypatch)
    assert list(disobeyed(PXD, text)) == ["@cython.final of class Chained has no effect in the C code"]


def test_the_build_stops_at_a_directive_without_effect(tmp_path, monkeypatch):
    pxd = PXD.replace("@cython.final", "@cython.freelist(16)")
    c_code(tmp_path, pxd, monkeypatch)
    with pytest.raises(build.NoBuild, match=r"one\.pxd: @cython\.freelist\(16\) of class Chained has no effect"):
        build.require_directives(pxd, tmp_path / "one.c")


@pytest.mark.parametrize("kept", ["Plain", "Inherits"])
def test_the_build_stops_if_a_typed_method_of_another_module_is_passed_as_a_value(tmp_path, monkeypatch, kept):
    c_code(tmp_path, PXD, monkeypatch)
    pxd = "from .one cimport Plain\n\ncdef class Inherits(Plain):\n    pass\n\n"
    pxd += f"cdef class Again:\n    cdef {kept} plain\n"
    (tmp_path / "directed" / "two.pxd").write_text(pxd)
    (tmp_path / "directed" / "two.py").write_text(
        "from .one import Plain\n\nclass Inherits(Plain):\n    pass\n\n"
        "class Again:\n    def again(self):\n        return map(self.plain.doubled, [1])\n"
    )
    c_file = build.generate("two", "directed")
    with pytest.raises(build.NoBuild, match=r"two\.py passes on the typed method doubled, "):
        build.require_directives(pxd, c_file)
