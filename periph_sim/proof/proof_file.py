"""The file of a proof: proofs/NAME.json beside the case, with the proven budgets and everything they depend on.

    TableProof --proof_of--> ProofFile --text_of--> file --current--> the proven budgets, for `run`, `check` and pytest

Only closed tables are saved. A proof holds for the case as it was then: if a dependency changes, it is out of date.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, ClassVar

from msgspec import Meta

from ..core.phrases import counted
from ..timing.verdict import NOT_JUDGED
from .closed_table import milliseconds, starts_text
from .dependencies import Dependencies
from .saved_file import SavedFile
from .table_proof import TableProof, WorstRun

TOO_LITTLE = "too little was measured to judge it"


class ProofFile(SavedFile, frozen=True, kw_only=True):
    """The contents of a proof file.

    case: the name of the case.
    moved: the kinds of the free starts: "rounds", "frames", or "rounds and frames".
    ticks_per_second: the number of ticks per second.
    within_ppm: the proof holds for all clocks of the controller that differ from that of the case by at most this; None
        for the clock of the case only.
    host_within_ppm: the same for the bit rates of the host, in ppm.
    any_tick: True if rounds can start at any tick; False if they start with a cycle. It only matters for a case with
        rounds and frames.
    any_data: True if the proof holds for frames with any data, except for the budgets in `following_data`.
    following_data: the proven budgets that hold for the data of the case only.
    first: the tick of the first start or, if `rests_first` is True, of the first rest, from the start of the run.
    rests_first: True if the proof holds for a first start at any tick after `first`; False if for `first` only.
    apart: the least distance of two starts for which the proof holds, in ticks.
    starts: the number of entries that were run.
    again: the number of entries that were run again.
    proven: the worst value of each proven budget, by its name.
    not_proven: the reason for each other budget of the case, by its name.
    """

    WHAT: ClassVar[str] = "proof"
    RENEW: ClassVar[str] = "write it again with prove --table --save"
    case: str
    moved: str
    ticks_per_second: Annotated[int, Meta(ge=1)]
    within_ppm: float | None
    host_within_ppm: float | None = None
    any_tick: bool = False
    any_data: bool = False
    following_data: tuple[str, ...] = ()
    first: int
    rests_first: bool
    apart: int
    starts: int
    again: int
    proven: dict[str, WorstRun]
    not_proven: dict[str, str]

    @property
    def command(self) -> str:
        """The options that make this proof again, such as "prove --table --ppm 10 --save"."""
        clocks = {"--ppm": self.within_ppm, "--host-ppm": self.host_within_ppm}
        ranges = "".join(f" {option} {within:.15g}" for option, within in clocks.items() if within is not None)
        return f"prove --table{ranges}{' --any-tick' if self.any_tick else ''} --save"

    @property
    def line(self) -> str:
        """For example, "1 of 1 budget proven for all sequences of rounds that start at least 4.4001 ms apart"."""
        of = len(self.proven) + len(self.not_proven)
        apart = milliseconds(self.apart, self.ticks_per_second)
        inputs = [starts_text(self.moved, apart, self.any_tick)]
        ranges = {"clocks of the controller": self.within_ppm, "bit rates of the host": self.host_within_ppm}
        inputs += [f"all {what} within {within:.15g} ppm" for what, within in ranges.items() if within is not None]
        if self.any_data:
            inputs.append(f"any data of the frames{except_for(self.following_data)}")
        return f"{len(self.proven)} of {counted(of, 'budget')} proven for {', and '.join(inputs)}"


def except_for(names: Sequence[str]) -> str:
    """Return a phrase that names budgets which are proven for the data of the case only; "" for no names."""
    return f", except for {', '.join(names)}, whose events are data" if names else ""


def proof_of(made: TableProof, dependencies: Dependencies) -> ProofFile:
    """Return the contents of the proof file of a proof whose tables are closed."""
    covered, worst = made.covered, made.worst()
    not_proven = covered.not_whole | made.not_proven()
    proven: dict[str, WorstRun] = {}
    for name, word in made.words().items():
        if word == NOT_JUDGED:
            not_proven.setdefault(name, TOO_LITTLE)
        elif name not in not_proven:
            proven[name] = worst[name].run()
    return ProofFile(
        case=covered.case.name,
        moved=made.moved,
        ticks_per_second=covered.phases.ticks_per_second,
        within_ppm=None if made.within is None else float(made.within),
        host_within_ppm=None if made.rates is None else float(made.rates),
        any_tick=made.any_tick,
        any_data=made.data_use == "",
        following_data=tuple(made.following_data()),
        first=made.first,
        rests_first=made.rests_first,
        apart=made.apart,
        starts=made.entries,
        again=made.again,
        proven=proven,
        not_proven=not_proven,
        dependencies=dependencies,
    )
