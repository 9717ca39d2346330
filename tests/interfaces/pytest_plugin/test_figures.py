"""Figures of budgets as text, as properties of a test, and as lines of the summary made from these properties."""

from __future__ import annotations

from types import SimpleNamespace

from periph_sim.interfaces.pytest_plugin.figures import properties, table
from periph_sim.timing.verdict import Verdict


def verdict(name: str = "response", worst: float | None = 5.0, unit: str = "us") -> Verdict:
    margin = None if worst is None else 4 - worst
    at_s = None if worst is None else 0.5
    return Verdict(
        name, "response", unit, worst, 4, margin, 9, "fail" if margin is None or margin < 0 else "pass", at_s
    )


def report(test: str, *given: object, **more: object) -> SimpleNamespace:
    return SimpleNamespace(nodeid=test, user_properties=[one for part in given for one in part], **more)


def test_figures_survive_the_way_through_test_properties() -> None:
    slow, silent = properties("a/b", verdict()), properties("a/b", verdict("x / y", None))
    lines = table(
        [
            report("t.py::one", slow),  # set up
            report("t.py::one", slow, silent, slow),  # called; the first budget was judged twice
            report("t.py::two", [("mine", 1), ("periph-sim", 2)], wasxfail=""),
            report("case.toml::response", properties("c", verdict(worst=3, unit="count")), wasxfail=""),
            report("case.toml::p", properties("c", verdict("held", 2.0))),
            report("case.toml::x", properties("c", verdict()), wasxfail=""),
            SimpleNamespace(nodeid="a collector's"),
        ]
    )
    assert lines == [
        (" case/budget       seen  limit        when                       judged by", True),
        (f" {'─' * 73}", True),
        (" a/b/response  5.000 us   4 us  0.500000 s  broken               t.py::one", False),
        (" a/b/x / y            -   4 us           -  broken               t.py::one", False),
        (" c/response           3      4  0.500000 s  seen", True),
        (" c/held        2.000 us   4 us  0.500000 s  seen", True),
        (" c/response    5.000 us   4 us  0.500000 s  broken, as expected", True),
    ]


def test_without_figures_there_are_no_lines() -> None:
    assert table([report("t.py::one", [("mine", 1)])]) == []


def test_a_property_with_the_plugin_prefix_but_no_figures_is_shown() -> None:
    """A user's test may record such a property, which must not end the session with an error."""
    lines = table([report("t.py::one", [("periph-sim/mine/verdict", "seen")])])
    assert lines[-1] == (" mine            -      -     -  seen  t.py::one", True)
