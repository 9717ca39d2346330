"""Changes of source code, and code that is not changed."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from tests.mutants.operators import changes

ROOT = Path(__file__).parents[2]


def mutants(source: str) -> set[str]:
    """Return every mutant of a source, as its changed line without surrounding blanks."""
    lines = source.encode().splitlines(keepends=True)
    return {change.applied(lines[change.line - 1]).decode().strip() for change in changes(source)}


@pytest.mark.parametrize(
    ("line", "wanted"),
    [
        ("x = a < b", {"x = a <= b"}),
        ("x = a <= b <= c", {"x = a < b <= c", "x = a <= b < c"}),
        ("x = (a) == (b)", {"x = (a) != (b)"}),
        ("x = a is not None", {"x = a is None"}),
        ("x = a not in b", {"x = a in b"}),
        ("x = a and b and c", {"x = a or b and c", "x = a and b or c"}),
        ("x = a & MASK | b", {"x = a | MASK | b", "x = a & MASK & b"}),
        ("x = a << b >> c", {"x = a >> b >> c", "x = a << b << c"}),
        ("x = a + b - c", {"x = a - b - c", "x = a + b + c"}),
        ("x = a ** b", set()),
        ("x = a * b // c", {"x = a + b // c", "x = a * b * c"}),
        ("x = a / b // c", {"x = a * b // c", "x = a / b * c"}),
        ("x = -a - b", {"x = a - b", "x = -a + b"}),
        ("x = 0.5", {"x = 1.5"}),
        ("x = 1e300", set()),
        ("x = -1", {"x = 1", "x = -2", "x = -0"}),
        ("x = min(a, b)", {"x = max(a, b)"}),
        ("x = any(a.all(b))", {"x = all(a.all(b))"}),
        (
            "x = [a for a in b if a.c if a]",
            {"x = [a for a in b if not (a.c) if a]", "x = [a for a in b if a.c if not (a)]"},
        ),
        ("x = not a", {"x = a"}),
        ("x = ~a", {"x = a"}),
        ("x = 7", {"x = 8", "x = 6"}),
        ("x = 0", {"x = 1"}),
        ("x = True", {"x = False"}),
        ("x += y", {"x -= y", "pass"}),
        ("x |= y", {"x &= y", "pass"}),
        ("f(x)", {"pass"}),
        ("self.x = y", {"pass"}),
        ("x = y", set()),
        ("x = 'größer' if a < b else c", {"x = 'größer' if a <= b else c", "x = 'größer' if not (a < b) else c"}),
    ],
)
def test_a_line_has_these_changes(line: str, wanted: set[str]) -> None:
    assert mutants(line) == wanted


def test_conditions_and_returns_are_changed() -> None:
    assert mutants("def f(x):\n    if x:\n        return g(x)\n    return x > y") == {
        "if not (x):",
        "return None",
        "return True",
        "return False",
        "return x >= y",
    }
    assert mutants("while x:\n    break") == {"while not (x):", "pass"}


@pytest.mark.parametrize(
    "source",
    [
        '"""Text."""',
        "def f(x: Literal[1, 2] = y) -> tuple[int, 3]: ...",
        "@cache(1)\ndef f(): ...",
        "class P(Protocol):\n    x = 1",
        "if TYPE_CHECKING:\n    x = 1",
        "assert x == 1",
        "raise ValueError(f'{1 + 2}')",
        "x = f'{a + 1}'",
        "__slots__ = (1, 2)",
        "from x import y",
        "X = Literal[1, 2]",
        "x = zip(a, b, strict=True)",
    ],
)
def test_code_that_no_test_can_check_is_not_changed(source: str) -> None:
    assert mutants(source) == set()


def test_keywords_of_calls_are_changed_and_bases_of_classes_are_not() -> None:
    assert mutants("x = f(most=3)") == {"x = f(most=4)", "x = f(most=2)"}
    assert mutants("class A(B, size=3):\n    y = 2") == {"y = 3", "y = 1"}


@pytest.mark.parametrize("path", sorted((ROOT / "periph_sim" / "f28335").glob("*.py")), ids=lambda path: path.name)
def test_every_mutant_of_a_file_is_a_valid_and_different_program(path: Path) -> None:
    source = path.read_text(encoding="utf-8")
    lines = source.encode().splitlines(keepends=True)
    own = ast.dump(ast.parse(source))
    for change in changes(source)[::7]:
        changed = [*lines]
        changed[change.line - 1] = change.applied(lines[change.line - 1])
        assert ast.dump(ast.parse(b"".join(changed))) != own, change
