"""Which test proves which rule: markers in the tests and the not-modelled list go in, a table comes out.

`python -m tests.rules.coverage` writes build/rules.md and prints one line a family; it
fails on a rule that nobody names, and on a name that is no rule.
"""

from __future__ import annotations

import ast
import re
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
FAMILIES = {"I2C": 342, "SCI": 212, "SYS": 153}  # how many rules each list has
RULES = [f"{family}-{number:03}" for family, count in FAMILIES.items() for number in range(1, count + 1)]
NOT_MODELLED = re.compile(r"^\| ((?:I2C|SCI|SYS)-\d{3}) \| (.+) \|$", re.MULTILINE)


def named_rules() -> dict[str, list[str]]:
    """rule -> the tests whose marker names it, as "file::function"."""
    found: dict[str, list[str]] = {}
    for path in sorted((ROOT / "tests").rglob("test_*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        module_wide = [r for node in tree.body if isinstance(node, ast.Assign) for r in rules_in(node)]
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef) and node.name.startswith("test_"):
                rules = [r for decorator in node.decorator_list for r in rules_in(decorator)] + module_wide
                for rule in dict.fromkeys(rules):
                    found.setdefault(rule, []).append(f"{path.relative_to(ROOT)}::{node.name}")
    return found


def rules_in(node: ast.AST) -> list[str]:
    """The rules that `pytest.mark.rule(...)` names anywhere below a node."""
    return [
        argument.value
        for call in ast.walk(node)
        if isinstance(call, ast.Call) and name_of(call.func) == "rule"
        for argument in call.args
        if isinstance(argument, ast.Constant) and isinstance(argument.value, str)
    ]


def name_of(function: ast.expr) -> str:
    """`rule` of `pytest.mark.rule` and of `rule = pytest.mark.rule`."""
    if isinstance(function, ast.Attribute):
        return function.attr
    return function.id if isinstance(function, ast.Name) else ""


def not_modelled() -> dict[str, str]:
    """rule -> the reason that docs/fidelity.md gives."""
    text = (ROOT / "docs" / "fidelity.md").read_text(encoding="utf-8")
    return dict(NOT_MODELLED.findall(text))


def gaps() -> list[str]:
    """What is wrong, one sentence each; empty when every rule is named or explained."""
    named, left_out = named_rules(), not_modelled()
    known = set(RULES)
    wrong = [f"{rule} is named by {named[rule][0]}, but there is no such rule" for rule in named if rule not in known]
    wrong += [
        f"{rule} is named by no test and docs/fidelity.md gives no reason"
        for rule in RULES
        if rule not in named and rule not in left_out
    ]
    wrong += [
        f"{rule} stands as not modelled in docs/fidelity.md, but {named[rule][0]} proves it"
        for rule in left_out
        if rule in named
    ]
    return wrong


def table() -> str:
    """Every rule and its tests, as Markdown."""
    named, left_out = named_rules(), not_modelled()
    lines = ["| rule | proved by |", "|---|---|"]
    for rule in RULES:
        tests = "<br>".join(named.get(rule, [])) or f"not modelled: {left_out.get(rule, '?')}"
        lines.append(f"| {rule} | {tests} |")
    return "\n".join(lines) + "\n"


def main() -> int:
    target = ROOT / "build" / "rules.md"
    target.parent.mkdir(exist_ok=True)
    target.write_text(table(), encoding="utf-8")
    named, left_out = named_rules(), not_modelled()
    for family, count in FAMILIES.items():
        proved = sum(1 for rule in RULES if rule.startswith(family) and rule in named)
        apart = sum(1 for rule in RULES if rule.startswith(family) and rule in left_out)
        print(f"rules {family}: {count}, named by tests {proved}, not modelled {apart}")
    wrong = gaps()
    for line in wrong:
        print(line, file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
