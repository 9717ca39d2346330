"""What must be in time for the closed form to hold: a closed form goes in, the spare time of each deadline comes out.

STOP --> code, model --> wait for the next request   before its START, or the address is refused
RRDY --> code --> write of I2CSTR                    before SDIR rises, or the write clears it unseen, and the
                                                     firmware waits for it for ever while SCL is held low
flag --> poll pass                                   before it falls again, or another that the wait looks at rises
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from ...bus.i2c.transfer import Transfer
from ...core.registers import OnWrite
from ...f28335.i2c.register_map import I2C_MAP
from .closed_form import MEASURED, ClosedForm
from .latest_chain import LatestChain, chains, waits_between
from .terms import BadBound, Bound, Term, total


def deadlines(closed: ClosedForm) -> list[Bound]:
    """The spare time before each deadline, at its least; negative where it may be missed."""
    tightest: dict[str, Deadline] = {}
    for deadline in (*_ready(closed), *_cleared(closed), *_seen(closed)):
        name = deadline.name
        if name not in tightest or deadline.spare < tightest[name].spare:
            tightest[name] = deadline
    return [deadline.bound() for deadline in tightest.values()]


class Deadline(NamedTuple):
    """there: what makes up the time until then. cost: what has to be done before."""

    name: str
    spare: int
    there: tuple[Term, ...]
    cost: tuple[Term, ...]

    def bound(self) -> Bound:
        return Bound(self.name, "", (*self.there, *(term.taken_off() for term in self.cost)), least=True)


def _ready(closed: ClosedForm) -> Iterator[Deadline]:
    """Back in its wait when the next transfer begins."""
    calm = closed.calm
    for before, after in zip([None, *calm.transfers], calm.transfers, strict=False):
        begins = after.phases[0].start_at
        wait = next((wait for wait in calm.waits if wait.end >= begins), None)
        if wait is None:
            what = f"the firmware is in no wait when {after.name} is asked, so nothing says how soon it would notice"
            raise BadBound(f"{what}; wait for AAS or another flag there, by dsp.spin")
        if before is None:
            code = wait.first - calm.start
            first = Term("first request", begins - calm.start, "controller.first")
            cost = (Term("start-up", code, MEASURED), closed.preempted(code))
            yield _spare(f"{after.name} asked first", (first,), cost)
            continue
        for chain in chains(calm, waits_between(calm, before.phases[0].start_at, begins), wait.first, wait.place):
            there = _until(closed, chain, before, after)
            yield _spare(f"{after.name} asked", there, (*chain.terms, closed.preempted(chain.length)))


def _until(closed: ClosedForm, chain: LatestChain, before: Transfer, after: Transfer) -> tuple[Term, ...]:
    """The time from a chain's edge to the START of the transfer after."""
    calm = closed.calm
    begins = after.phases[0].start_at
    if any(over.start <= before.phases[0].start_at and begins <= over.end for over in calm.rounds):
        return (Term("edge to START", calm.bus(begins) - calm.bus(chain.edge), "controller.rate, gap"),)
    stop = Term("edge to STOP", calm.bus(before.stop_at) - calm.bus(chain.edge), "controller.rate")
    return stop, Term("slack", closed.slack.ticks, "its own bound")


def _cleared(closed: ClosedForm) -> Iterator[Deadline]:
    """I2CSTR written before a flag rises that the write would clear, and that is waited for afterwards."""
    calm = closed.calm
    clearable = {f"I2C-A.I2CSTR.{f.name}" for f in I2C_MAP["I2CSTR"].fields if f.on_write is OnWrite.ONE_CLEARS}
    for transfer in calm.transfers:
        begin = transfer.phases[0].start_at
        for written, place in calm.clears:
            later = next((w for w in waits_between(calm, written, transfer.stop_at) if w.flag in clearable), None)
            if later is None or later.edge is None or not begin <= written <= later.edge:
                continue
            flag = later.flag.rpartition(".")[2]
            for chain in chains(calm, waits_between(calm, begin, written), written, f"I2CSTR in {place}"):
                there = Term(f"edge to {flag}", calm.bus(later.edge) - calm.bus(chain.edge), "controller.rate")
                cost = (*chain.terms, closed.preempted(chain.length))
                yield _spare(f"{flag} of {transfer.name} rises", (there,), cost)


def _seen(closed: ClosedForm) -> Iterator[Deadline]:
    """A wait sees its flag before the bus makes it fall, or makes another flag rise that would end it another way."""
    calm = closed.calm
    for transfer in calm.transfers:
        begin = transfer.phases[0].start_at
        for wait in waits_between(calm, begin, transfer.stop_at):
            if wait.edge is None:
                continue
            ends = [
                tick
                for field in wait.polled
                for tick, value in calm.changes.get(field, ())
                if tick > wait.end and value == (field != wait.flag)
            ]
            if not ends:
                continue
            flag = wait.flag.rpartition(".")[2]
            for chain in chains(calm, waits_between(calm, begin, wait.end), wait.end, f"a read of {flag}"):
                left = calm.bus(min(ends)) - calm.bus(chain.edge) - calm.ticks(1) - calm.rounding
                there = Term("edge to the flag's next change", left, "controller.rate")
                yield _spare(f"{flag} seen in time", (there,), (*chain.terms, closed.preempted(chain.length)))


def _spare(name: str, there: tuple[Term, ...], cost: tuple[Term, ...]) -> Deadline:
    return Deadline(name, total(there) - total(cost), there, cost)
