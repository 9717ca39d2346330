"""A case file that is read once. Changes (`key=value`) are applied to it, and only changed tables are checked again.

text --> tree of TOML --> Case
change of host.jitter --> the table [host] is read and checked anew; all others are the same objects
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

from ...core.convert import Mistake, keys_of
from .load import apply, built, copied, located, refuse_unusable, shared_case, text_of, tree_of
from .model import Case
from .named_files import texts_in
from .origin import Source

BUDGETS = frozenset(("serial", "watch", "budget"))  # keys that decide which budgets a case has


class CaseFile:
    """A case file as it was read, and the cases that changes make of it.

    The cases share their tables: a dict or a list in them must not be changed.
    changes: applied to the file first, as `--set` has them. BadCase if the file cannot be read.
    """

    def __init__(self, path: Path | str, changes: Sequence[str] = ()) -> None:
        self.path = Path(path)
        self.changes = tuple(changes)
        self._text = text_of(self.path, "case")

    @cached_property
    def case(self) -> Case:
        """The case without further changes. BadCase if there is none."""
        return shared_case(self.path, self._text, self.changes)

    def changed(self, changes: Sequence[str]) -> Case:
        """Return the case with changes applied behind those of this object. BadCase as of `load`."""
        if not changes:
            return self.case
        try:
            found = None if self.case.outside is not None else self._changed(changes)
        except ValueError:  # of the unchanged case, or of this one: the whole of it tells which
            found = None
        return shared_case(self.path, self._text, (*self.changes, *changes)) if found is None else found

    @cached_property
    def _tree(self) -> dict[str, Any]:
        tree = tree_of(self.path, self._text)
        self._places = [(change, apply(tree, change)) for change in self.changes]
        self._texts = {key: tuple(texts_in(value)) for key, value in tree.items()}
        return tree

    def _changed(self, changes: Sequence[str]) -> Case | None:
        """Return the changed case, or None if the tables that changed are not enough to tell whether it is one."""
        named = {change.partition("=")[0].partition(".")[0].strip() for change in changes}
        tree = self._tree | {key: copied(self._tree[key]) for key in named if key in self._tree}
        places = [(change, apply(tree, change)) for change in changes]
        texts = self._texts | {key: tuple(texts_in(tree[key])) for key in named}
        values = tuple(text for key in tree for text in texts[key])
        source = Source(self.path, self._text, (*self._places, *places), values)
        refuse_unusable(source, {key: tree[key] for key in named})
        if named & BUDGETS:
            named.add("budget")
        fields = _converted(tree, named)
        if fields is None:
            return None
        case = self.case.model_copy(update=fields).completed()
        return built(located(case, self.path.parent) if "unit" in named else case, source)


def _converted(tree: Mapping[str, Any], named: set[str]) -> dict[str, object] | None:
    """Return the fields of a case that these keys of a tree define; None if one of them is wrong."""
    keys, mistakes = keys_of(Case), list[Mistake]()
    fields: dict[str, object] = {}
    for said in named:
        if said not in keys:
            return None
        key = keys[said]
        fields[key.name] = key.convert(tree[said], (said,), mistakes) if said in tree else key.default
    return None if mistakes else fields
