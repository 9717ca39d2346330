"""What a round comes to that nothing disturbs, or one interrupt in the middle of a wait: worked out once for all lanes.

    round:  START .. | AAS flag f | ... waits of the reads ... | end of the last read | models
    phase   p = (first fetch of the first wait - f) mod poll            0 .. poll - 1
    row     0: no interrupt; w: one that is latched in wait w, behind its first fetch and well before its flag

Where all scenarios have the round's START and the unit's clock in common, the bus is the same in all, and the CPU's
place in it is p alone, up to the first interrupt. One within a wait begins the passes anew: m passes and a service
routine later, so that it moves their phase by `service` whenever it comes, as long as it is over before the flag. So a
round is one of rows x poll outcomes, found by `read` itself; the few scenarios beside them go read by read.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .clock import CpuClock, Ints
from .lanes import FAR, Interrupts
from .read import Read, read
from .stored import Stored
from .terms import Terms


@dataclass(frozen=True)
class RoundTable:
    """Of one round. start: its START. flag: cycle of the first AAS. heard: cycle in which the START is seen.

    windows: cycles from `flag`, begin and end of each wait in turn, in order; last: where no interrupt of the round
    begins any more. Of each row and phase, int64[rows * poll]: begin: cycles from `flag` to the models; begun: the same
    as a tick. margins, asked, rises: (worst, least). plain: False where it is no outcome that counts.
    """

    start: int
    flag: int
    heard: int
    windows: Ints
    last: int
    begin: Ints
    begun: Ints
    margins: tuple[Ints, Ints]
    asked: tuple[Ints, Ints] | None
    rises: tuple[Ints, Ints]
    plain: Ints


@dataclass
class _Outcome:
    """Of lanes, one for each round, row and phase. waits: of all reads in turn."""

    begin: Ints
    taken: Ints
    plain: Ints
    margins: list[Ints]
    asked: list[Ints]
    rises: list[Ints]
    waits: list[tuple[Ints, Ints]]


def round_tables(terms: Terms, clock: CpuClock, starts: Ints) -> list[RoundTable]:
    """Of each round with such a START."""
    poll, rounds = terms.poll, len(starts)
    phases = np.arange(poll, dtype=np.int64)
    flags = clock.cycle_at(starts + terms.bus[0].aas) + terms.seen
    calm = _outcome(terms, clock, np.repeat(starts, poll), _firsts(flags, phases, 1, terms), None)
    lows, highs = _windows(terms, calm, rounds)
    rows = lows.shape[0] + 1
    latches = np.full((rounds, rows, poll), FAR, np.int64)
    middle = np.where(highs > lows, (lows + highs) // 2, FAR).T  # round, wait
    latches[:, 1:, :] = middle[:, :, None]
    lanes = np.repeat(starts, rows * poll)
    all_ = _outcome(terms, clock, lanes, _firsts(flags, phases, rows, terms), latches.reshape(-1))
    expected = (latches < FAR).reshape(-1).astype(np.int64)
    plain = all_.plain & (all_.taken == expected)
    shape = (rounds, rows * poll)
    begun = clock.tick(all_.begin).reshape(shape)
    tables = []
    for number in range(rounds):
        of = slice(number * rows * poll, (number + 1) * rows * poll)
        flag = int(flags[number])
        windows = np.stack([lows[:, number], highs[:, number]], axis=1).reshape(-1) - flag
        begin = all_.begin[of] - flag
        tables.append(
            RoundTable(
                int(starts[number]),
                flag,
                int(clock.cycle_at(starts[number : number + 1])[0]) + terms.seen,
                windows,
                int(begin.max()),
                begin,
                begun[number],
                _extremes(all_.margins, of),
                _extremes(all_.asked, of) if all_.asked else None,
                _extremes(all_.rises, of),
                plain[of],
            )
        )
    return tables


def _firsts(flags: Ints, phases: Ints, rows: int, terms: Terms) -> Ints:
    """The first fetch of the first wait, some passes before its flag: of each round, row and phase."""
    begin = flags[:, None, None] - 4 * terms.poll + phases[None, None, :]
    return np.broadcast_to(begin, (len(flags), rows, terms.poll)).reshape(-1)


def _windows(terms: Terms, calm: _Outcome, rounds: int) -> tuple[Ints, Ints]:
    """int64[waits, rounds]: the latches that meet a wait behind its first fetch, and are served well before its flag.

    The first wait is left out: it has begun long before the round.
    """
    most = 2 * max(terms.poll, terms.poll_two) + terms.waits + terms.service
    firsts = np.array([first for first, _ in calm.waits[1:]]).reshape(-1, rounds, terms.poll)
    flags = np.array([flag for _, flag in calm.waits[1:]]).reshape(-1, rounds, terms.poll)
    lows = firsts.max(axis=2) + 1
    return lows, np.maximum(flags.min(axis=2) - most, lows)


def _outcome(terms: Terms, clock: CpuClock, starts: Ints, first: Ints, latches: Ints | None) -> _Outcome:
    count = len(starts)
    none = np.full(count, FAR, np.int64)
    rows = Stored.of(np.stack([none if latches is None else latches, none]))
    of = Interrupts(rows, terms.service, terms.waits)
    lanes = of.lanes(np.arange(count))
    plain = np.ones(count, np.bool_)
    margins, asked, rises, waits = [], [], [], []
    ready = none
    for chip, code in enumerate(terms.reads):
        if chip:
            plain &= ready < clock.cycle_at(starts) + terms.seen
            asked.append(starts - clock.tick(first))
        came: Read = read(terms, chip, clock, lanes, starts, first)
        plain &= ~came.hung & (came.held == 0) & (came.response == terms.low)
        margins += list(came.margins)
        rises.append(came.cleared)
        waits += came.waits
        first, marks = lanes.code(came.seen, code.after)
        starts = came.stop + terms.gap
        ready = marks[1] if marks else none
    return _Outcome(first, lanes.places // count, plain.astype(np.bool_), margins, asked, rises, waits)


def _extremes(values: list[Ints], of: slice) -> tuple[Ints, Ints]:
    rows = np.array([value[of] for value in values])
    return rows.max(axis=0), rows.min(axis=0)
