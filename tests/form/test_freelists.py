"""Free lists: directives of a .pxd file are put where Cython heeds them, and lines keep their numbers."""

from __future__ import annotations

from pathlib import Path

from periph_sim import form
from periph_sim.form.freelists import KEPT, with_freelists

SOURCE = '''"""A module."""

from __future__ import annotations

ONE = 1


class Plain:
    pass


class Kept(Plain):
    pass
'''
PXD = """cimport cython


cdef class Plain:
    cdef long long number


@cython.final
cdef class Other:
    pass


@cython.final
@cython.freelist(4)
cdef class Kept(Plain):
    cdef Kept following
"""


def test_the_directive_is_put_above_its_class_in_place_of_empty_lines():
    made = with_freelists(SOURCE, PXD)
    assert made.splitlines()[2] == "from __future__ import annotations; import cython"
    assert "    pass\n@cython.freelist(4)\n@cython.cclass\nclass Kept(Plain):\n" in made
    assert made.splitlines().index("class Kept(Plain):") == SOURCE.splitlines().index("class Kept(Plain):")
    assert made.count("@") == 2


def test_a_source_without_free_lists_stays_as_it_is():
    assert with_freelists(SOURCE, "cdef class Plain:\n    pass\n") == SOURCE


def test_every_free_list_of_the_package_is_found_and_reaches_its_class():
    found = 0
    for path in form.PACKAGE.rglob("*.pxd"):
        pxd = path.read_text("utf-8")
        kept = KEPT.findall(pxd)
        assert len(kept) == pxd.count("@cython.freelist("), path
        made = with_freelists(Path(path).with_suffix(".py").read_text("utf-8"), pxd)
        for directive, name in kept:
            assert f"\n{directive}\n@cython.cclass\nclass {name}" in made, path
            found += 1
    assert found
