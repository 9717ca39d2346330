"""Read-modify-writes during a run, and the flags that they cleared unintentionally.

    R . . R x W      the write W belongs to the nearest earlier read R of the same statement, a few cycles before
          '---'      flags that rise in this time are not in the value that was read
                F    a flag that the write clears unintentionally is lost if firmware has not read it since it rose

A read-modify-write is judged as soon as its read is so old that no later write can belong to the read. The flags that
firmware intends to clear at a place in its code are known at the end of the run. Reads without a write are dropped, and
flags that may have been lost are counted by place, so memory does not grow with the run.

`records/read_modify_write.py` matches reads and writes in the same way, in the recording of a whole run. Both modules
use `records/cleared_flags.py` to judge the cleared flags.
"""

# core: compiled

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import final

from ...core.phrases import counted
from ...core.records import NOWHERE, OF_MODIFIES, UNWANTED, Kind, Recorder, RecordSink, Subjects
from ...form.c_types import Text
from ...processor.source_location import statement
from ...records.cleared_flags import CLEARABLE, CLEARABLE_FLAGS, Cleared, ClearedRegister, Flag, Modify
from ...records.register_maps import MODIFY, OVERTAKEN
from .measure import Measure, MeasuredScene
from .watched_register import Watched


@final
class Access:
    """An access in the last cycles, as an element of a linked list.

    register: the accessed register; None if it has no flag that writing 1 clears.
    modify: for a read, the write that belongs to it; None if there is none.
    before, after: the next older and the next younger access in the list.
    """

    __slots__ = ("after", "before", "cause", "field", "modify", "number", "reads", "register", "text", "tick", "value")

    before: Access | None
    after: Access | None
    number: int
    tick: int
    value: int
    cause: int
    reads: bool
    text: Text
    field: str
    register: ClearedRegister | None
    modify: Modify | None


@final
class Recent:
    """The accesses of a unit in the last cycles, as a linked list from the oldest to the newest."""

    __slots__ = ("newest", "oldest")

    def __init__(self) -> None:
        self.oldest: Access | None = None
        self.newest: Access | None = None


@final
class JudgedTopic:
    """A topic: accesses to one register, or changes of one flag.

    recent: the accesses of the unit in the last cycles.
    register: the register of the accesses or of the flag; None if its flags are not judged.
    reads: True if the records are reads of the register.
    flag: the flag whose changes are recorded; None for accesses.
    """

    __slots__ = ("flag", "reads", "recent", "register")

    def __init__(self, recent: Recent, register: ClearedRegister | None, reads: bool, flag: Flag | None) -> None:
        self.recent = recent
        self.register = register
        self.reads = reads
        self.flag = flag


class Modifies(RecordSink):
    """Finds the flags that read-modify-writes cleared unintentionally.

    concerns: a function from (kind, place, thing) that returns True if such records are evaluated.
    is_about: a function from (kind, place, thing) that returns True if such accesses are to a register whose flags are
        judged. Other accesses matter only because the number of accesses between a read and its write is limited.
    status: True if all status registers are judged, and no other registers.
    writes: the number of writes to the judged registers, with or without a read.
    recent: a dictionary from a unit to its accesses in the last cycles.
    """

    def __init__(
        self, concerns: Callable[[Kind, str, str], bool], is_about: Callable[[Kind, str, str], bool], status: bool
    ) -> None:
        self.writes = 0
        self._status = status
        self._concerns = concerns
        self._is_about = is_about
        self._longest = 0  # maximum number of ticks from a read to the write that belongs to it
        self._per_second: Fraction = Fraction(1)
        self._clocks: list[tuple[int, Fraction]] = []  # pairs (tick, SYSCLKOUT in Hz from then on) up to now
        self._known = 0  # number of entries of `_clocks` that were evaluated
        self._spare: Access | None = None  # the first of a linked list of Access objects that can be used again
        self._topics: list[JudgedTopic] = []  # entry i describes the records that `keep` receives with tag i
        self.recent: dict[str, Recent] = {}  # maps a unit to its accesses in the last cycles
        # `_registers` maps the unit and the name of a register to the judged register.
        self._registers: dict[tuple[str, str], ClearedRegister] = {}

    def set_clocks(self, per_second: int, clocks: list[tuple[int, Fraction]]) -> None:
        """Set the number of ticks per second, and the history of SYSCLKOUT.

        clocks: pairs (tick, SYSCLKOUT in Hz from then on). The owner appends later changes to this list.
        """
        self._per_second, self._clocks = Fraction(per_second), clocks
        self._retuned()

    def _retuned(self) -> None:
        self._known = len(self._clocks)
        self._longest = int(MODIFY * self._per_second / self._clocks[-1][1])

    def tag_of(self, kind: Kind, where: str, what: str) -> int:
        if not (self._status or self._concerns(kind, where, what)):
            return UNWANTED
        register: ClearedRegister | None
        if kind is Kind.FLAG:
            unit, _, module = where.partition(".")
            name, _, field = what.partition(".")
            register = self._register(unit, f"{module}.{name}")
            flag: Flag | None = None if register is None else register.flag(field)
            if flag is None:
                return UNWANTED
            topic = JudgedTopic(Recent(), register, False, flag)
        else:
            about = self._status or self._is_about(kind, where, what)
            register = self._register(where, what[2:]) if about else None
            if where not in self.recent:
                self.recent[where] = Recent()
            topic = JudgedTopic(self.recent[where], register, what.startswith("R "), None)
        self._topics.append(topic)
        return len(self._topics) - 1

    def _register(self, unit: str, name: str) -> ClearedRegister | None:
        register = CLEARABLE.get(name)
        if register is None:
            return None
        key = unit, name
        if key not in self._registers:
            self._registers[key] = ClearedRegister(register)
        return self._registers[key]

    def places(self, tag: int) -> int:
        """Return OF_MODIFIES for accesses to a judged register; else NOWHERE.

        OF_MODIFIES requests the firmware's statement of an access. It is needed because a write belongs to an earlier
        read only if the same statement made both.
        """
        topic = self._topics[tag]
        return NOWHERE if topic.register is None or topic.flag is not None else OF_MODIFIES

    def keep(self, tag: int, number: int, tick: int, value: int, text: Text, cause: int, field: Text) -> None:
        topic: JudgedTopic = self._topics[tag]
        if topic.flag is not None:
            topic.flag.register.flag_changed(topic.flag, number, tick, value, cause)
            return
        recent: Recent
        register: ClearedRegister | None
        recent, register = topic.recent, topic.register
        if len(self._clocks) != self._known:
            self._retuned()
        before = tick - self._longest
        if recent.oldest is not None and recent.oldest.tick < before:
            self._forget(recent, before)
        one = self._spare
        if one is None:
            one = Access()
        else:
            self._spare = one.after
        one.number, one.tick, one.value, one.cause = number, tick, value, cause
        one.reads, one.text, one.field = topic.reads, text, field
        one.register, one.modify = register, None
        if register is not None and not topic.reads:
            self.writes += 1
            self._landed(one, register, recent)
        newest: Access | None
        newest, recent.newest = recent.newest, one
        one.before, one.after = newest, None
        if newest is None:
            recent.oldest = one
        else:
            newest.after = one

    def _landed(self, write: Access, register: ClearedRegister, recent: Recent) -> None:
        """Find the read to which a write belongs: the nearest earlier read of the same field in the same statement.

        If there is no such read, the write is not judged.
        """
        passed: int
        passed, one = 0, recent.newest
        while one is not None and passed < OVERTAKEN:
            if one.cause == write.cause:  # both are in the same routine
                passed += 1
                if (
                    one.reads
                    and one.register is register
                    and one.modify is None
                    and one.field == write.field
                    and (one.text is write.text or statement(one.text) == statement(write.text))
                ):
                    one.modify = register.written(write.number, write.tick, write.value, write.text)
                    return
            one = one.before

    def _forget(self, recent: Recent, before: int) -> None:
        """Evaluate and drop the accesses before the tick `before`. Later writes cannot belong to them."""
        one = recent.oldest
        while one is not None and one.tick < before:
            if one.register is not None and one.reads:
                one.register.judge(one.number, one.value, one.field, one.modify)
            after, one.after, self._spare = one.after, self._spare, one
            one = after
        recent.oldest = one
        if one is None:
            recent.newest = None
        else:
            one.before = None

    def finish(self) -> None:
        """Evaluate the remaining accesses at the end of the run."""
        for recent in self.recent.values():
            if recent.newest is not None:
                self._forget(recent, recent.newest.tick + 1)

    def cleared(self, name: str = "") -> Cleared:
        """Return the number of flags that were cleared unintentionally, and when.

        name: the only flag to count, whether or not firmware had read it; "" for all flags that firmware had not read.
        """
        found = Cleared()
        for _, gone in self._cleared(name):
            found.add(gone)
        return found

    def named(self, name: str = "") -> str:
        """Return a phrase with the flags that `cleared` counts, how often each was cleared, and where; "" for none.

        name: the only flag to name, whether or not firmware had read it; "" for all flags that firmware had not read.
        """
        counts = {what: gone.count for what, gone in self._cleared(name)}
        return "; ".join(f"{what}, {counted(count, 'time')}" for what, count in counts.items() if count)

    def _cleared(self, name: str) -> Iterator[tuple[str, Cleared]]:
        """Yield (text, clears) for each flag and each place in the firmware.

        name: the only flag to yield, whether or not firmware had read it; "" for all flags that firmware had not read.
        text: names the flag and the place.
        clears: how often writes at this place cleared the flag unintentionally, and the first time.
        """
        for (unit, title), register in self._registers.items():
            if not register.status and self._status:
                continue
            for where, place in register.places.items():
                meant = place.meant(register.flags)
                for flag, of in zip(register.flags, place.flags, strict=True):
                    if name in ("", flag.name):
                        gone = Cleared()
                        gone.add(of.between)
                        if flag.name not in meant:
                            gone.add(of.along if name else of.unseen)
                        yield f"{unit}.{title}.{flag.name} at {where or 'an unknown place'}", gone


class LostFlags(Measure):
    """Number of flags that read-modify-writes cleared unintentionally, in one of two modes.

    without a field in `watched`   flags that firmware had not read since they rose
    with a field                   this flag, whenever a read-modify-write for another flag cleared it, even if firmware
                                   had read the flag; useful for a flag that firmware reads early and waits for later

    `worst` is this number. `count` is the number of writes of the registers, with or without a read before; if it is 0,
    the budget is not judged. Writes without a read are assumed to clear only what they should clear.
    """

    unit = "flags"
    series = False
    kinds = frozenset({Kind.ACCESS, Kind.FLAG})

    def __init__(self, watched: Watched) -> None:
        super().__init__()
        # The number of lost flags is computed at the end of the run, from all accesses. Only then are the flags known
        # that firmware clears on purpose at a place in its code.
        self.looks_back = "the whole run"
        self.watched = watched
        self.modifies = Modifies(watched.concerns, watched.is_about, not watched.register)

    @property
    def subjects(self) -> Subjects:
        watched = self.watched
        if watched.register:
            return {Kind.FLAG: {f"{watched.unit}.{watched.module}.{watched.register}"}}
        return {Kind.FLAG: [f"{unit}.{register}" for unit in watched.units for register in CLEARABLE]}

    def listen(self, scene: MeasuredScene) -> None:
        self.modifies.set_clocks(scene.ticks_per_second, scene.clock_history(self.watched.unit))

    def subscribe(self, recorder: Recorder) -> None:
        recorder.subscribe((Kind.ACCESS,), self.modifies)
        recorder.subscribe((Kind.FLAG,), self.modifies, self.subjects, CLEARABLE_FLAGS)

    def finish(self, now: int) -> None:
        self.modifies.finish()
        gone = self.modifies.cleared(self.watched.field)
        self.count = self.modifies.writes
        self.worst = self.least = gone.count
        self.worst_at = self.least_at = gone.first

    def close(self, now: int) -> str:
        # Other measures take values of unfinished occurrences here. A write is an instant, so it is never unfinished.
        return self.modifies.named(self.watched.field)

    def why_silent(self) -> str:
        what = self.watched.text or "a register with flags that writing 1 clears"
        return f"the firmware never wrote {what}"
