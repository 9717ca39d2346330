"""The page results.md, with a row for each statement and what catches its mutants."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby

from .argued import ARGUMENTS, argument_of
from .changes import DELAYS, DELETED, EXCHANGED, MOVED
from .survivors import KNOWN
from .tally import WAYS, Tally
from .trials import BROKEN, ENDED, FIRMWARES, MOVED_IN_TIME, Trial, all_mutants

KINDS = (DELETED, *(f"{cycles} cycles late" for cycles in DELAYS), MOVED, EXCHANGED)
HEAD = """# Firmware mutants

`make firmware-mutants` changes each statement of the service path, the start-up and the SCI routine of both emulators,
runs the flagship's cases with each change, and writes this page. A statement is deleted, delayed by 20 and by 300
cycles, moved past the next one, and has each constant, named constant and register field in it exchanged for another:
a constant loses its lowest set bit, a field is replaced by the next one of its register.

Cases are run for a fraction of a second, with earlier faults. A mutant counts as caught if

* **a budget** in bold is broken or no longer judged: `periph-sim run` fails,
* the run *ends* with an error that names the line,
* a budget's worst, least or count, in plain letters, differs from that of the unchanged firmware: `periph-sim check`
  fails; *when* follows it if only the instant of a worst or least value differs. If the code between two waits takes
  another time, the phase of the polls also changes the margin of I2CDXR, or the end of a wait.

A number in brackets refers to an argument below that the mutant has no observable effect on this chip.
"""


def page(trials: Mapping[str, Sequence[Trial]]) -> str:
    text = HEAD + _summary(trials)
    for file, of_file in trials.items():
        text += f"\n## {file}\n\n{FIRMWARES[file]}{_left_out(file, of_file)}\n\n" + _statements(of_file)
    return text + _survivors(trials) + _arguments()


def _left_out(file: str, trials: Sequence[Trial]) -> str:
    """Return a sentence if not every mutant of a file was tried."""
    every = len(all_mutants(file))
    return "" if len(trials) == every else f" {len(trials)} of {every} mutants were tried."


def _summary(trials: Mapping[str, Sequence[Trial]]) -> str:
    rows = [f"\n| | mutants | {' | '.join(WAYS)} | caught of those not argued |", f"|---{'|---:' * (len(WAYS) + 2)}|"]
    everything = [trial for of_file in trials.values() for trial in of_file]
    groups = {f"`{file}.py`": list(of_file) for file, of_file in trials.items()}
    groups |= {kind: [trial for trial in everything if trial.mutant.kind.startswith(kind)] for kind in KINDS}
    for name, chosen in {**groups, "all": everything}.items():
        tally = Tally(chosen)
        counts = " | ".join(str(tally.ways[way]) for way in WAYS)
        rows.append(f"| {name} | {tally.total} | {counts} | {tally.share:.1f} % |")
    return "\n".join(rows) + "\n"


def _statements(trials: Sequence[Trial]) -> str:
    rows = [f"| line | statement | {' | '.join(KINDS)} |", f"|---:|---{'|---' * len(KINDS)}|"]
    for (line, before), group in groupby(trials, lambda trial: (trial.mutant.line, trial.mutant.before)):
        of_statement = list(group)
        cells = [_cell([t for t in of_statement if t.mutant.kind.startswith(kind)]) for kind in KINDS]
        statement = before.replace("|", "\\|")
        rows.append(f"| {line} | `{statement}` | {' | '.join(cells)} |")
    return "\n".join(rows) + "\n"


def _cell(trials: Sequence[Trial]) -> str:
    return "; ".join(_caught(trial) for trial in trials)


def _caught(trial: Trial) -> str:
    if trial.how == ENDED:
        return "*ends*"
    if trial.how == BROKEN:
        return f"**{trial.by}**"
    argument = argument_of(trial.mutant)
    if not trial.how:
        return f"[{ARGUMENTS.index(argument) + 1}]" if argument else "SURVIVED"
    return f"{trial.by}, *when*" if trial.how == MOVED_IN_TIME else trial.by


def _survivors(trials: Mapping[str, Sequence[Trial]]) -> str:
    """Return what would catch the mutants that survived, or nothing if none did."""
    left = [(file, trial.mutant) for file, of_file in trials.items() for trial in Tally(of_file).survivors]
    rows = [
        f"* `{file}.py`, line {one.line}, {one.kind}: {KNOWN.get(one.text, 'not looked at')}." for file, one in left
    ]
    return "\n".join(["\n## What would catch the survivors\n", *rows, ""]) if left else ""


def _arguments() -> str:
    rows = ["\n## Without effect on this chip\n"]
    for number, one in enumerate(ARGUMENTS, 1):
        source = f" ({', '.join(one.rules)})" if one.rules else ""
        said = f" `lint` reports it: {one.lint}." if one.lint else ""
        rows.append(f"{number}. {one.why}{source}.{said}")
    return "\n".join(rows) + "\n"
