"""Make a table of the rules and the tests that prove them, from outcomes of pytest and the list of unmodelled rules.

    pytest --rules build/rules.json --> outcomes --> rules named by passed tests --> build/rules.md, gaps

Run `python -m tests.rules.coverage` after those runs of pytest. It writes the table with the texts of the rules, prints
one line per family, and fails if a rule is neither named by a passed test nor listed as not modelled in
docs/fidelity.md. A test that did not run, was skipped, failed or is expected to fail proves nothing.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from tests.rules.outcomes import PASSED, read_outcomes
from tests.rules.texts import texts

ROOT = Path(__file__).parents[2]
OUTCOMES = ROOT / "build" / "rules.json"
TABLE = ROOT / "build" / "rules.md"
FAMILIES = ("I2C", "SCI", "SPI", "SYS")
NOT_MODELLED = re.compile(r"^\| ((?:I2C|SCI|SPI|SYS)-\d{3}) \| (.+) \|$", re.MULTILINE)


@dataclass
class Named:
    """The tests that name a rule, without their parameters.

    passed: the number of passed cases of each test that has some.
    others: the outcome of each other test.
    """

    passed: dict[str, int] = field(default_factory=dict)
    others: dict[str, str] = field(default_factory=dict)


def named_rules(outcomes: Mapping[str, Mapping[str, object]]) -> dict[str, Named]:
    """Return the tests of every rule that a collected test names."""
    found: dict[str, Named] = {}
    for node, entry in outcomes.items():
        test = node.partition("[")[0]
        for rule in entry["rules"]:
            named = found.setdefault(rule, Named())
            if entry["outcome"] == PASSED:
                named.passed[test] = named.passed.get(test, 0) + 1
            else:
                named.others[test] = str(entry["outcome"])
    return found


def not_modelled() -> dict[str, str]:
    """Return the reason that docs/fidelity.md gives for each rule that is not modelled."""
    text = (ROOT / "docs" / "fidelity.md").read_text(encoding="utf-8")
    return dict(NOT_MODELLED.findall(text))


def gaps(named: Mapping[str, Named], left_out: Mapping[str, str]) -> list[str]:
    """Return a sentence for each rule that is neither proved nor listed as not modelled, or that is listed wrongly."""
    wrong = [
        f"{rule} is listed as not modelled in docs/fidelity.md, but there is no such rule"
        for rule in left_out
        if rule not in texts()
    ]
    for rule, (text, _) in texts().items():
        one = named.get(rule, Named())
        if rule in left_out and one.passed:
            wrong.append(
                f"{rule} is listed as not modelled in docs/fidelity.md, but {next(iter(one.passed))} proves it"
            )
        elif not one.passed and rule not in left_out:
            but = "".join(f"; {test} {outcome}" for test, outcome in one.others.items())
            wrong.append(f"{rule} is proved by no test, and docs/fidelity.md gives no reason{but}: {text}")
    return wrong


def table(named: Mapping[str, Named], left_out: Mapping[str, str]) -> str:
    """Return a Markdown table of all rules with their texts, sources and tests."""
    lines = ["| rule | what it says | source | proved by |", "|---|---|---|---|"]
    for rule, (text, source) in texts().items():
        passed = named.get(rule, Named()).passed
        tests = [f"{test} ({cases} cases)" if cases > 1 else test for test, cases in passed.items()]
        shown = "<br>".join(tests) or f"not modelled: {left_out.get(rule, '?')}"
        lines.append(f"| {rule} | {text} | {source} | {shown} |")
    return "\n".join(lines) + "\n"


def main() -> int:
    outcomes = read_outcomes(OUTCOMES)
    if not outcomes:
        sys.exit(
            f"{OUTCOMES.relative_to(ROOT)}: there is no such file; run pytest with --rules {OUTCOMES.relative_to(ROOT)}"
        )
    named, left_out = named_rules(outcomes), not_modelled()
    TABLE.write_text(table(named, left_out), encoding="utf-8")
    for family in FAMILIES:
        rules = [rule for rule in texts() if rule.startswith(family)]
        proved = sum(1 for rule in rules if rule in named and named[rule].passed)
        apart = sum(1 for rule in rules if rule in left_out)
        print(f"rules {family}: {len(rules)}, proved by tests that passed {proved}, not modelled {apart}")
    wrong = gaps(named, left_out)
    for line in wrong:
        print(line, file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
