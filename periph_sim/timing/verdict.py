"""Verdicts: the figures of a budget after a run, and functions that return figures as text for tables and sentences.

This module imports no other module of the package, so that showing verdicts does not load the measures.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Final, Literal

Word = Literal["pass", "fail", "not judged"]

PASS: Final = "pass"
FAIL: Final = "fail"  # a limit is broken, or an event such as a wrong reply refutes the budget
NOT_JUDGED: Final = "not judged"  # no limit is broken, but too little was measured to say that all hold

SEEN: Final = "seen"  # the word for a pass: every limit held in this run
PROVEN: Final = "proven"  # the word for a pass that a proof covers
BROKEN: Final = "broken"


@dataclass
class Verdict:
    """Figures of one budget after a run.

    worst, limit, margin: in microseconds for times, percent for shares of time, LSB for values in LSB, else whole
        numbers. If the budget has several limits, these figures are for the limit with the smallest margin. `worst` and
        `margin` are None if nothing was measured that can be judged.
    at_s: the time of `worst` in seconds from the start of the run; for a refuted budget whose `worst` keeps the limit,
        the start of the fault that refutes the budget; None if there is neither.
    count: the number of values, or the measured count.
    which: the key of the limit. For a percentile, `worst` is the value of the percentile.
    found: a text that explains the figures, such as that no event matched; "" if nothing needs to be explained.
    measured: the number of events at which a value was measured.
    occasions: the number of events at which a value should have been measured; None if they are not counted.
    until_s: the end of the fault that `found` describes, such as a wrong reply, which began at `at_s`; None if there is
        no such fault.
    proven: True if a proof (`periph_sim.proof`) shows that the budget holds for every start that the proof covers. A
        start is the beginning of a round, a frame or a send.
    """

    name: str
    measure: str
    unit: str
    worst: float | int | None
    limit: float | int
    margin: float | int | None
    count: int
    verdict: Word
    at_s: float | None
    why: str = ""
    which: str = "max"
    found: str = ""
    measured: int = 0
    occasions: int | None = None
    until_s: float | None = None
    proven: bool = False

    @property
    def word(self) -> str:
        """The word in tables: "proven", "seen", "broken" or "not judged"."""
        if self.passed:
            return PROVEN if self.proven else SEEN
        return BROKEN if self.broken else NOT_JUDGED

    @property
    def passed(self) -> bool:
        """True if every limit holds and enough was measured to say so."""
        return self.verdict == PASS

    @property
    def broken(self) -> bool:
        """True if a limit is broken, or an event refutes the budget."""
        return self.verdict == FAIL

    @property
    def too_little(self) -> bool:
        """True if `worst` is critical because it is small: the limit is a `min`, or an `exactly` above `worst`."""
        return self.which == "min" or (self.which == "exactly" and self.worst is not None and self.worst < self.limit)

    @property
    def within(self) -> bool:
        """True if `worst` keeps the limit."""
        if self.worst is None:
            return False
        if self.which == "exactly":
            return self.worst == self.limit
        return self.worst >= self.limit if self.which == "min" else self.worst <= self.limit

    @property
    def counted(self) -> str:
        """`count` as text, such as "3"; "3 of 500" if a value was measured at only 3 of 500 occasions."""
        if self.occasions is None or self.measured >= self.occasions:
            return str(self.count)
        return f"{self.measured} of {self.occasions}"


PLAIN = ("count", "value")  # units that are not written after a number


def figure(value: float | int | None, unit: str) -> str:
    """Return a value as text: `5.000 us`, `17.380 ms`, `1.28 %`, or a plain count; `-` for None."""
    if value is None:
        return "-"
    if unit == "%":
        return f"{value:.2f} %"
    if unit == "LSB":
        return f"{value:.3f} LSB"
    if unit != "us":
        return f"{value}"
    return f"{value:.3f} us" if abs(value) < 1000 else f"{value / 1000:.3f} ms"


def in_words(value: float | int, unit: str) -> str:
    """Return a figure for use within a sentence, where no column names the unit: `12 words`, `1 word`."""
    text = figure(value, unit)
    if unit in PLAIN or text != f"{value}":
        return text
    return f"{text} {unit.removesuffix('s') if value == 1 else unit}"


def limit(value: float | int, unit: str, which: str) -> str:
    """Return a limit as text, exact to the nanosecond: `60 us`, `= 150`, `p99 3.4 us`.

    value: in the unit that `Verdict.unit` names. which: the key of the limit.
    """
    number, blank, symbol = figure(value, unit).partition(" ")
    if symbol == "ms":
        number = f"{value / 1000:.6f}"
    text = f"{number.rstrip('0').rstrip('.') if '.' in number else number}{blank}{symbol}"
    if which in ("max", "min", ""):
        return text
    return f"{'=' if which == 'exactly' else percentile(which)} {text}"


def simulated(seconds: float) -> str:
    """Return the length of a run as text: `1.5 s`, `6.667 us`."""
    return f"{seconds * 1_000_000:.3f} us" if 0 < seconds < 0.001 else f"{seconds:g} s"


def duration_text(seconds: float) -> str:
    """Return a duration as text: `60 ms`, `10 s`."""
    return f"{seconds * 1000:g} ms" if seconds < 1 else f"{seconds:g} s"


def percentile(which: str) -> str:
    """Return the name of a percentile as text, such as `p99.9` for the key `p99_9`."""
    return which.replace("_", ".")


def instant(at_s: float | None) -> str:
    """Return an instant, in seconds from the start of the run, as text such as `0.005290 s`; `-` for None."""
    return "-" if at_s is None else f"{at_s:.6f} s"


def broken(verdict: Verdict) -> str:
    """Return why a budget is broken, as a phrase: `37.153 ms is over its limit of 25.000 ms, at 0.025195 s`."""
    if verdict.worst is None or (verdict.margin is not None and verdict.margin >= 0):
        return verdict.found
    over = "over" if verdict.worst > verdict.limit else "under"
    at = "" if verdict.at_s is None else f", at {instant(verdict.at_s)}"
    found = f" ({verdict.found})" if verdict.found else ""
    worst, limit = (in_words(value, verdict.unit) for value in (verdict.worst, verdict.limit))
    return f"{worst} is {over} its limit of {limit}{at}{found}"


def assumes(names: Sequence[str]) -> str:
    """Return a phrase that names the undocumented behaviours on which a failure may depend.

    They are grouped by unit and module, or by chip.

    names: the options for these behaviours, such as "dsp.i2c.aas_sdir_point".
    """
    groups: dict[str, list[str]] = {}
    for name in names:
        group, _, option = name.rpartition(".")
        groups.setdefault(group, []).append(option)
    listed = "; ".join(f"{group}: {', '.join(options)}" for group, options in groups.items())
    return f"undocumented behaviours assumed in it or shortly before: {listed}"


def assumes_lines(names: Sequence[str]) -> list[str]:
    """Return the phrase about undocumented behaviours as indented lines of at most 80 characters.

    names: the options for these behaviours, such as "dsp.i2c.aas_sdir_point". If there are none, return [].
    """
    import textwrap  # imported here, because few runs fail

    text = assumes(names) if names else ""
    return textwrap.wrap(text, 80, initial_indent="  ", subsequent_indent="    ", break_long_words=False)


def title(word: str, budgets: Sequence[Verdict]) -> str:
    """Return the title of a run: "PASS, proven", "PASS, as seen in this run", "FAIL" or "NOT JUDGED".

    "PASS, proven" is the title if all budgets are proven. word: the verdict of the run.
    """
    if word != PASS:
        return word.upper()
    is_proven = bool(budgets) and all(one.word == PROVEN for one in budgets)
    return "PASS, proven" if is_proven else "PASS, as seen in this run"


def legend(words: Collection[str]) -> list[str]:
    """Return the lines of the legend below a table of verdicts. words: the values of `Verdict.word` in the table."""
    count = "count: occurrences" + "; seen: held in this run, other timings are not covered" * (SEEN in words)
    return [
        count,
        *["proven: holds for every start that the proof covers"] * (PROVEN in words),
        *["not judged: too little was measured; no pass"] * (NOT_JUDGED in words),
    ]
