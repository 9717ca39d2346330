"""Error messages for mistakes in a table: sentences with the file, the line, the key, the wrong value, and the fix."""

from __future__ import annotations

from typing import TypeVar

from ...core.convert import LIST_OF_TABLES, NOTHING, BadTable, Mistake, keys_of
from ...core.options import Value, options_from
from ...core.phrases import did_you_mean, nearest
from ...core.table import Table
from .device_tables import DeviceTable, WatchTable
from .model import BadCase, Case
from .origin import Place, Source, key_of, line_of

T = TypeVar("T")
SHOWN = 60  # maximum number of characters of a wrong value in a message


def explain(source: Source, error: BadTable, tree: object = None, above: Place = ()) -> str:
    """Return one sentence about the first mistake in a table.

    tree: the checked table; if given, the sentence names list entries by their key `name` instead of their number.
    above: the keys that lead from the top of the file to the checked table.
    """
    first = error.first
    place = (*above, *first.place)
    key, where = key_of(place, tree), source.where(place)
    if first.known is not None:
        return f"{where}: there is no key {key!r}; {did_you_mean(str(place[-1]), first.known)}"
    if first.is_missing:
        return f"{_header_place(source, place)}: {key} is missing{_where_it_is(place, tree)}"
    return f"{where}: {key or 'the case'}: {complaint(first, above)}"


def _header_place(source: Source, place: Place) -> str:
    """Return, for messages, the file and the line of the table that lacks the key at `place`.

    If the table has no header of its own, return the line of the first header of a table inside it.
    """
    return source.where(place if len(place) < 2 or line_of(source.text, place) else place[:-1])


def _where_it_is(place: Place, tree: object) -> str:
    """Return a hint if a missing key is in a table with a similar name, such as "; it is in [unit.dspp]"; else "".

    This happens if the header [unit.dsp] is mistyped as [unit.dspp]. A later header [unit.dsp.settings] then makes a
    second table `dsp`, which contains only `settings` and lacks the keys.

    place: the keys that lead to the missing key.
    """
    *above, name, key = place if len(place) > 1 else ("", *place)
    for part in above:
        tree = tree.get(part) if isinstance(tree, dict) else None
    if not isinstance(tree, dict) or not all(isinstance(one, dict) for one in tree.get(name, {}).values()):
        return ""
    near = nearest(str(name), [other for other, table in tree.items() if isinstance(table, dict) and key in table])
    return f"; it is in [{'.'.join(map(str, (*above, near[0])))}]" if near else ""


def complaint(first: Mistake, above: Place = ()) -> str:
    """Return a phrase that says what is wrong with a value. A short value is quoted.

    above: the keys that lead from the top of the file to the checked table.
    """
    if first.known is not None:
        return f"there is no such key; {did_you_mean(str(first.place[-1]), first.known)}"
    if first.is_missing:
        return "it is missing"
    # TOML writes true and false in lower case.
    found = str(first.found).lower() if isinstance(first.found, bool) else repr(first.found)
    is_list = isinstance(first.found, list)
    tables = first.found if is_list else [first.found]
    if first.what in ("expected a table", LIST_OF_TABLES) and all(isinstance(one, dict) for one in tables):
        header = ".".join(str(part) for part in (*above, *first.place) if isinstance(part, str))
        if is_list:
            return f"expected one table; write its header in single brackets, as in [{header}]"
        return f"{first.what}; write its header in double brackets, as in [[{header}]]"
    quoted_already = first.found is NOTHING
    # The value is not quoted if the message of the check already quotes the value or, for a list, one of its texts.
    # If the check raised BadCase, the value names a file, and the message about this file needs no value.
    if first.error is not None:
        quoted = [found, repr(first.found), *(repr(one) for one in tables if isinstance(one, str))]
        quoted_already |= (
            any(one in first.what for one in quoted) or "but it is" in first.what or isinstance(first.error, BadCase)
        )
        quoted_already |= isinstance(first.found, dict) or first.what.endswith("?")
    if quoted_already or len(found) > SHOWN:
        return first.what
    return f"{first.what[0].lower()}{first.what[1:]}, but it is {found}"


def own_settings(case: Case, kind: type[Table], table: DeviceTable | WatchTable, who: str, *place: str) -> Table:
    """Return the checked settings of a model or kind: the keys in `table` that this model or kind adds.

    kind: the class of the settings.
    who: the model or kind, with an article, for messages.
    place: the keys that lead to the table in the case, for a BadCase.
    """
    try:
        return kind.model_validate(table.own)
    except BadTable as error:
        first = error.first
        if first.known is None:
            what = complaint(first)
        else:
            known = first.known + (() if len(first.place) > 1 else tuple(keys_of(type(table))))
            what = f"{who} has no such key; {did_you_mean(str(first.place[-1]), known)}"
        raise case.mistake(what, *place, *first.place) from None


def checked_options(case: Case, kind: type[T], given: dict[str, Value], *place: str) -> T:
    """Return the answers to the open questions of a chip or module. Raise BadCase for a wrong answer.

    kind: the class whose fields are the questions.
    given: the answers that the case chooses. Each is checked separately, so that the message has the line of the
        wrong answer.
    place: the keys of the case that lead to these answers.
    """
    for name, value in given.items():
        try:
            options_from(kind, {name: value})
        except ValueError as error:
            raise case.mistake(str(error), *place, name) from None
    return options_from(kind, given)
