"""Loading of cases: TOML and `key=value` changes are read into a checked `Case`.

text --> tree of TOML --> Case
change of host.jitter --> only the table [host] is read and checked again; the changed case shares all other tables
                          with the unchanged case (`CaseFile`)
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Sequence
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

from ...core.convert import BadTable, Mistake, keys_of
from ...core.input_files import note_inputs_of
from ...core.phrases import did_you_mean, shorten
from ...core.table import separate
from .error_text import explain
from .model import BadCase, Case
from .origin import SHOWN, Place, Source, texts_in
from .toml_file import copied, text_of, tree_of

WIDEST = 2**63 - 1  # the largest integer that a case may contain, because TOML and compiled code use 64 bits


NAMES = {
    "name",
    "measure",
    "chip",
    "model",
    "pair",
    "breaks",
    "order",
}  # keys whose values must be printable names


class UnknownKey(BadCase):
    """Error: a case, or a change of a case, names an unknown key or entry."""


def load(path: Path | str, changes: list[str] | None = None) -> Case:
    """Return the case in a file, with `key=value` changes applied. Raise BadCase if the case is not valid.

    Paths of firmware files are relative to the folder of the case, not to the current folder.
    """
    path = Path(path)
    case, changeable = _loaded(path, text_of(path, "case"), tuple(changes or ()))
    note_inputs_of(case.files())
    return case.model_copy(update={name: separate(getattr(case, name)) for name in changeable})


@lru_cache(maxsize=16)
def _loaded(path: Path, text: str, changes: tuple[str, ...]) -> tuple[Case, list[str]]:
    """Return a case from a cache, and the names of the fields that contain dicts or lists. `load` copies these fields.

    The case depends only on `path`, `text` and `changes`, so it is checked once for all scenes.
    """
    case = _checked(path, text, changes)
    fields = ((name, getattr(case, name)) for name in case.__struct_fields__)
    return case, [name for name, value in fields if separate(value) is not value]


def _checked(path: Path, text: str, changes: tuple[str, ...]) -> Case:
    tree = tree_of(path, text)
    places = tuple((change, apply(tree, change)) for change in changes)
    source = Source(path, text, places, tuple(texts_in(tree)))
    refuse_unusable(source, tree)
    return _case_in(source, tree)


def _case_in(source: Source, tree: dict[str, Any]) -> Case:
    try:
        return built(located(Case.model_validate(tree), source.path.parent), source)
    except BadTable as error:
        raise refusal(source, error, tree) from None


def built(case: Case, source: Source) -> Case:
    """Return a checked case with `source` added, and without the parties that its table [outside] replaces."""
    case = case.from_source(source)
    if case.outside is None:
        return case
    from ..outside_parties import as_driven

    return as_driven(case)


def case_of(tree: dict[str, Any], path: Path) -> Case:
    """Return the case that a tree of TOML tables describes, as if it had been read from the file `path`.

    Raise BadCase if the tree is not valid.
    """
    return _case_in(Source(path, "", values=tuple(texts_in(tree))), copied(tree))


def case_of_tables(tree: dict[str, Any], label: str, changes: Sequence[str] = ()) -> Case:
    """Return the case that these tables describe, which were not read from a file, with `key=value` changes applied.

    Raise BadCase if the case is not valid.

    label: the name of the case in messages, in place of a file.
    """
    places = tuple((change, apply(tree, change)) for change in changes)
    shown = Path(label if label.isprintable() else ascii(label)[1:-1])
    source = Source(shown, "", places, tuple(texts_in(tree)), is_label=True)
    refuse_unusable(source, tree)
    try:
        return built(Case.model_validate(tree), source)
    except BadTable as error:
        raise refusal(source, error, tree) from None


def refusal(source: Source, error: BadTable, tree: object) -> BadCase:
    """Return a BadCase about the first mistake in a case. tree: the tree of the case that was checked."""
    kind = BadCase if error.first.known is None else UnknownKey
    return kind(explain(source, error, tree))


def located(case: Case, folder: Path) -> Case:
    """Return the case with `folder` put before the paths of firmware files, images, C sources and header folders."""
    moved = {}
    for name, unit in case.unit.items():
        if unit.firmware.endswith(".py"):
            moved[name] = unit.model_copy(update={"firmware": str(folder / unit.firmware)})
        elif unit.image:
            moved[name] = unit.model_copy(update={"image": str(folder / unit.image)})
        elif unit.sources:
            found = {"sources": tuple(str(folder / file) for file in unit.sources)}
            include = tuple(str(folder / path) for path in unit.compile.include)
            compile = unit.compile.model_copy(update={"include": include})
            moved[name] = unit.model_copy(update=found | {"compile": compile})
    return case.model_copy(update={"unit": case.unit | moved})


def refuse_unusable(source: Source, tree: object, place: Place = ()) -> None:
    """Raise BadCase, with file, line and key, for an integer beyond 64 bits or a name with unprintable characters."""
    if isinstance(tree, dict):
        for key, value in tree.items():
            _check_name(source, str(key), (*place, key))
            refuse_unusable(source, value, (*place, key))
    elif isinstance(tree, list | tuple):
        for number, value in enumerate(tree):
            refuse_unusable(source, value, (*place, number))
    elif isinstance(tree, str):
        if next(part for part in reversed(place) if isinstance(part, str)) in NAMES:
            _check_name(source, tree, place)
    elif isinstance(tree, int) and not -WIDEST - 1 <= tree <= WIDEST:
        key = ".".join(map(str, place))
        raise BadCase(f"{source.where(place)}: {key} is an integer that does not fit 64 bits; give a smaller number")


def _check_name(source: Source, name: str, place: Place) -> None:
    if not name.isprintable():
        key = ".".join(ascii(part)[1:-1] if isinstance(part, str) else str(part) for part in place)
        where = source.where(place)
        raise BadCase(f"{where}: {key}: {name!a} is no name; a name is one line of printable characters")


def apply(tree: dict[str, object], change: str) -> Place:
    """Apply a change such as "unit.dsp.settings.model_cost=400 us" to the tree of a case. Return the place of the key.

    The value is read as TOML. A value that is not valid TOML is a text. A number with underscores is also a text,
    because an answer to an option can look like the number 3_4_5. Raise BadCase if the change cannot be applied, for
    example because it does not have the form KEY=VALUE, or names a list entry that does not exist.
    """
    key, found, value = change.partition("=")
    names = [name.strip() for name in key.split(".")]
    if not found or not all(names):
        raise BadCase(f"--set {change!r}: expected key=value, for instance controller.period=10 ms")
    if not re.fullmatch(r"[\w-]+", names[0]):
        meant = ".".join((*filter(None, re.split(r"[^\w-]+", names[0])), *names[1:]))
        raise BadCase(f"--set {change!r}: the parts of a key are separated by points; write {meant}={value.strip()}")
    try:
        parsed = tomllib.loads(f"value = {value.strip()}")["value"]
    except tomllib.TOMLDecodeError:
        parsed = value.strip()
    except ValueError:
        shown = shorten(repr(change), SHOWN)
        raise BadCase(f"--set {shown}: an integer is too long; it must fit 64 bits") from None
    except RecursionError:
        raise BadCase(f"--set {shorten(repr(change), SHOWN)}: its lists are nested too deeply") from None
    if isinstance(parsed, int | float) and "_" in value:
        parsed = value.strip()
    table: object = tree
    place: list[str | int] = []
    for name in names[:-1]:
        step, table = _child(table, name, change)
        place.append(step)
    if isinstance(table, list):
        number = _index(table, names[-1], change)
        place.append(number)
        table[number] = parsed
    else:
        assert isinstance(table, dict)
        place.append(names[-1])
        table[names[-1]] = parsed
    return tuple(place)


def _child(table: object, name: str, change: str) -> tuple[str | int, object]:
    """Return the key or index of the entry `name` in a table or list, and the entry.

    A key that is missing in a table is added, with an empty table as its value.
    """
    if isinstance(table, list):
        number = _index(table, name, change)
        return number, _not_a_value(table[number], name, change)
    assert isinstance(table, dict)
    return name, _not_a_value(table.setdefault(name, {}), name, change)


def _not_a_value(child: object, name: str, change: str) -> object:
    if not isinstance(child, dict | list):
        raise UnknownKey(f"--set {change!r}: {name} is a value, not a table")
    return child


def _index(table: list[object], name: str, change: str) -> int:
    """Return the index of an entry in a list. Raise UnknownKey if there is no such entry.

    name: the index as text, or the value of the entry's key `name`.
    """
    for i, entry in enumerate(table):
        if name == str(i) or (isinstance(entry, dict) and entry.get("name") == name):
            return i
    names = [str(e.get("name", i)) if isinstance(e, dict) else str(i) for i, e in enumerate(table)]
    raise UnknownKey(f"--set {change!r}: there is no entry {name!r}; {did_you_mean(name, names)}")


BUDGETS = frozenset(("serial", "watch", "budget"))  # keys that decide which budgets a case has


class CaseFile:
    """The text of a case file, from which cases with different changes are made.

    These cases share tables, so the dicts and lists in a case must not be changed.

    changes: the `key=value` texts that are applied to every case before its own changes.

    Raise BadCase if the file cannot be read.
    """

    def __init__(self, path: Path | str, changes: Sequence[str] = ()) -> None:
        self.path = Path(path)
        self.changes = tuple(changes)
        self._text = text_of(self.path, "case")

    @cached_property
    def case(self) -> Case:
        """The case with `self.changes` applied, and no others. Raise BadCase if this case is not valid."""
        return _loaded(self.path, self._text, self.changes)[0]

    def changed(self, changes: Sequence[str]) -> Case:
        """Return the case with `self.changes` and then these changes applied. Raise BadCase as `load` does."""
        if not changes:
            return self.case
        try:
            found = None if self.case.outside is not None else self._changed(changes)
        except ValueError:  # the case is invalid before or after the changes, so the changed case is loaded as a whole
            found = None
        return _loaded(self.path, self._text, (*self.changes, *changes))[0] if found is None else found

    @cached_property
    def _tree(self) -> dict[str, Any]:
        tree = tree_of(self.path, self._text)
        self._places = [(change, apply(tree, change)) for change in self.changes]
        self._texts = {key: tuple(texts_in(value)) for key, value in tree.items()}
        return tree

    def _changed(self, changes: Sequence[str]) -> Case | None:
        """Return the changed case. Only its changed tables are checked.

        Return None if a changed key is unknown or has a wrong value. Raise ValueError if a change cannot be applied, or
        if the changed tables contradict other tables.
        """
        named = {change.partition("=")[0].partition(".")[0].strip() for change in changes}
        tree = self._tree | {key: copied(self._tree[key]) for key in named if key in self._tree}
        places = [(change, apply(tree, change)) for change in changes]
        texts = self._texts | {key: tuple(texts_in(tree[key])) for key in named}
        values = tuple(text for key in tree for text in texts[key])
        source = Source(self.path, self._text, (*self._places, *places), values)
        refuse_unusable(source, {key: tree[key] for key in named})
        if named & BUDGETS:
            named.add("budget")
        keys, mistakes = keys_of(Case), list[Mistake]()
        fields: dict[str, object] = {}
        for said in named & keys.keys():
            key = keys[said]
            fields[key.name] = key.convert(tree[said], (said,), mistakes) if said in tree else key.default
        if mistakes or named - keys.keys():
            return None
        case = self.case.model_copy(update=fields).completed()
        return built(located(case, self.path.parent) if "unit" in named else case, source)
