"""Tables and paragraphs that fit a terminal of 80 columns.

budget  seen   limit            a rule under the titles, two spaces between columns,
───────────────────────         numbers to the right; long cells continue on the next
a long  3 us  at most           line, within their column
name             4 us
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from textwrap import wrap

WIDTH = 80
GAP = "  "  # the space between two columns
FOLD = 16  # words are not broken to make a column narrower than this
KEPT = "\u00a0"  # a space at which lines are not broken
ROOM = 24  # minimum width of a column whose continuation lines are indented by two spaces

Cells = Sequence[str]


def text_table(
    titles: Cells,
    rows: Sequence[Cells],
    right: Collection[int] = (),
    width: int = WIDTH,
    names: Collection[int] = (),
) -> list[str]:
    """Return the lines of a table: titles, a rule, and the rows.

    A cell may contain several lines. Cells are broken between words, and within words only if the table would be wider
    than `width` otherwise.
    right: the indices of the right-aligned columns of numbers, whose cells are never broken.
    names: the indices of the columns of names, which users search for or copy; their words are broken last.
    """
    head, *body = table_rows(titles, rows, right, width, names)
    return [*head, *(line for row in body for line in row)]


def table_rows(
    titles: Cells,
    rows: Sequence[Cells],
    right: Collection[int] = (),
    width: int = WIDTH,
    names: Collection[int] = (),
) -> list[list[str]]:
    """Return the lines of a table in groups: first the titles and the rule, then one group for each row."""
    widths = _fitted([titles, *rows], titles, right, width, names)
    head, *body = [_lines(row, widths, right, " ") for row in (titles, *rows)]
    longest = max(len(line) for row in (head, *body) for line in row)
    return [[*head, f" {'─' * (longest - 1)}"], *body]


def columns(rows: Sequence[Cells], right: Collection[int] = (), width: int = WIDTH, indent: str = "  ") -> list[str]:
    """Return the lines of a table without titles. Columns whose cells are all empty are left out."""
    if not rows:
        return []
    used = [n for n in range(len(rows[0])) if any(row[n] for row in rows)]
    kept = [[row[n] for n in used] for row in rows]
    to_right = {place for place, n in enumerate(used) if n in right}
    widths = _fitted(kept, (), to_right, width - len(indent) + 1)
    return [line for row in kept for line in _lines(row, widths, to_right, indent)]


def paragraph(text: str, first: str = "", then: str = "  ") -> list[str]:
    """Return text as lines of at most 80 columns, broken between words; a longer word makes a longer line.

    first: the prefix of the first line. then: the prefix of each other line.
    """
    lines = wrap(
        text, WIDTH, initial_indent=first, subsequent_indent=then, break_long_words=False, break_on_hyphens=False
    )
    return [line.replace(KEPT, " ") for line in lines]


def together(text: str) -> str:
    """Return the text with each space replaced by KEPT, at which the functions of this module break no line."""
    return text.replace(" ", KEPT)


def _fitted(
    rows: Sequence[Cells], titles: Cells, right: Collection[int], width: int, names: Collection[int] = ()
) -> list[int]:
    """Return the width of each column, such that the lines of the table have at most `width` characters if possible.

    Columns become narrower, the widest first, in this order until the table fits: titles are broken between words;
    cells are broken between words; words longer than FOLD are broken, except in the columns `names`; then in these,
    too. Cells of the columns `right` are never broken.
    """
    places = range(len(rows[0]))
    widths = [max(_longest(row[n]) for row in rows) for n in places]
    words = [max(_longest_word(row[n]) for row in rows) for n in places]
    cells = [max((_longest(row[n]) for row in rows[bool(titles) :]), default=0) for n in places]
    whole = [max(cells[n], _longest_word(titles[n]) if titles else 0) for n in places]
    between = [whole[n] if n in right else words[n] for n in places]
    within = [whole[n] if n in right else min(words[n], FOLD) for n in places]
    others = [between[n] if n in names else within[n] for n in places]
    for least in (whole, between, others, within):
        while 1 + sum(widths) + len(GAP) * (len(widths) - 1) > width:
            wide = max(places, key=lambda n: widths[n] if widths[n] > least[n] else 0)
            if widths[wide] <= least[wide]:
                break
            widths[wide] -= 1
    return widths


def _lines(row: Cells, widths: Sequence[int], right: Collection[int], indent: str) -> list[str]:
    cells = [_broken(cell, width) for cell, width in zip(row, widths, strict=True)]
    lines = []
    for number in range(max(map(len, cells))):
        parts = [cell[number] if number < len(cell) else "" for cell in cells]
        sides = (f"{parts[n]:>{w}}" if n in right else f"{parts[n]:{w}}" for n, w in enumerate(widths))
        lines.append((indent + GAP.join(sides)).rstrip().replace(KEPT, " "))
    return lines


def _broken(cell: str, width: int) -> list[str]:
    """Return the lines of a cell. Lines longer than `width` are broken."""
    lines = []
    for line in cell.split("\n"):
        start = line[: len(line) - len(line.lstrip())]
        then = start + GAP if width >= ROOM else start
        lines += wrap(line, max(width, 1), subsequent_indent=then, break_on_hyphens=False) or [""]
    return lines


def _longest(cell: str) -> int:
    return max(map(len, cell.split("\n")))


def _longest_word(cell: str) -> int:
    """Return the length of the longest word of a cell with the indentation of its line."""
    lines = [(len(line) - len(line.lstrip()), line.split()) for line in cell.split("\n")]
    return max((start + len(word) for start, words in lines for word in words), default=0)
