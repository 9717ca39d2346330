"""Measures of a user's own: lines such as `"late rounds" = "count of record round missed"`.

[measures] of a case, file of `measures_from` --> sentences by name; BadCase with file and line for an invalid one
"""

from __future__ import annotations

from ...timing.language.scope import BadEvent
from ...timing.measures.factory import check_measure
from .load import read
from .model import BadCase, Case
from .origin import Source


def measures_of(case: Case) -> dict[str, str]:
    """Return the sentences by name, each checked as far as no scene is needed for that."""
    sentences = dict(case.measures)
    file = case.folder / case.measures_from
    source = Source(file, "")
    if case.measures_from:
        text, tree = read(file, "measures")
        source = Source(file, text)
        for name, sentence in tree.items():
            if not isinstance(sentence, str):
                raise _mistake(case, source, name, "it is no sentence in quotes")
            if name in sentences:
                what = f"{file} has a measure {name!r}, too; give one of them another name"
                raise case.mistake(what, "measures", name)
            sentences[name] = sentence
    for name in sentences:
        try:
            check_measure(name, sentences)
        except BadEvent as error:
            raise _mistake(case, source, name, str(error)) from None
    return sentences


def _mistake(case: Case, source: Source, name: str, what: str) -> BadCase:
    """Return an error about a name of the case, or of the file that it names."""
    if name in case.measures:
        return case.mistake(what, "measures", name)
    return BadCase(f"{source.where((name,))}: {name}: {what}")
