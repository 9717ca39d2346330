"""The lists of rules are complete and well-formed, and `gaps` finds each rule that is not proved."""

from __future__ import annotations

import re
from dataclasses import fields

from periph_sim.f28335.i2c.options import I2cOptions
from periph_sim.f28335.sci.options import SciOptions
from periph_sim.f28335.spi.options import SpiOptions
from periph_sim.f28335.system_options import SystemOptions
from tests.rules.coverage import Named, gaps, named_rules, not_modelled, table
from tests.rules.texts import texts

COUNTS = {"I2C": 342, "SCI": 212, "SPI": 86, "SYS": 153}


def proved() -> dict[str, Named]:
    return {rule: Named({"test_x.py::test_x": 1}) for rule in texts() if rule not in not_modelled()}


def test_rules_are_numbered_consecutively_and_have_text_and_source():
    for family, count in COUNTS.items():
        rules = [rule for rule in texts() if rule.startswith(f"{family}-")]
        assert rules == [f"{family}-{number:03}" for number in range(1, count + 1)]
    assert sum(COUNTS.values()) == len(texts())
    for rule, (text, source) in texts().items():
        assert len(text) > 8 and source, rule
        assert not set("|\n") & set(text + source), rule  # both are cells of a Markdown table


def test_there_is_no_gap_if_all_rules_are_proved():
    assert gaps(proved(), not_modelled()) == []


def test_a_rule_whose_tests_did_not_pass_is_a_gap_with_its_text():
    named = proved() | {"I2C-111": Named({}, {"test_i2c.py::test_bcm": "skipped"})}
    del named["SCI-001"]
    found = gaps(named, not_modelled())
    assert found[0] == (
        "I2C-111 is proved by no test, and docs/fidelity.md gives no reason; test_i2c.py::test_bcm skipped: "
        "BCM changes XRDY and XSMT of a slave-transmitter, and nothing else"
    )
    assert found[1].startswith("SCI-001 is proved by no test") and len(found) == 2


def test_a_rule_listed_as_not_modelled_must_exist_and_must_not_be_proved():
    named = proved() | {"I2C-007": Named({"test_dma.py::test_dma": 1})}
    assert gaps(named, not_modelled()) == [
        "I2C-007 is listed as not modelled in docs/fidelity.md, but test_dma.py::test_dma proves it"
    ]
    assert gaps(proved(), not_modelled() | {"I2C-999": "no"})[0].startswith("I2C-999 is listed as not modelled")


def test_only_passed_cases_of_a_test_prove_its_rules():
    outcomes = {
        "a.py::test[1]": {"rules": ["I2C-001", "I2C-002"], "outcome": "passed"},
        "a.py::test[2]": {"rules": ["I2C-001"], "outcome": "passed"},
        "a.py::test[3]": {"rules": ["I2C-003"], "outcome": "failed"},
        "b.py::test": {"rules": ["I2C-003"], "outcome": "not run"},
    }
    named = named_rules(outcomes)
    assert named["I2C-001"].passed == {"a.py::test": 2} and named["I2C-002"].passed == {"a.py::test": 1}
    assert named["I2C-003"] == Named({}, {"a.py::test": "failed", "b.py::test": "not run"})
    shown = table(named, not_modelled())
    assert f"| I2C-001 | {texts()['I2C-001'].text} | T4; SC T88 | a.py::test (2 cases) |" in shown
    assert (
        "| I2C-007 | The DMA controller cannot reach the registers | DS T3-5 | not modelled: there is no DMA" in shown
    )


def test_options_that_are_named_as_sources_exist():
    known = {one.name for kind in (I2cOptions, SciOptions, SpiOptions, SystemOptions) for one in fields(kind)}
    named = {option for _, source in texts().values() for option in re.findall(r"`(\w+)`", source)}
    assert len(named) > 50 and named - known == set()
