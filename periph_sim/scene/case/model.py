"""The data of a case: the parts of the scene, the schedule of each party, and the budgets that must hold.

Each table of a case file is a class, whose fields are its keys. Unknown keys are rejected.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

from ...core.convert import BadTable, Mistake, convert
from ...core.phrases import did_you_mean
from ...core.table import Duration, Table
from ...devices.host_frames import host_frames
from ...timing.budget_schema import REPLY, SILENCE, WATCH, Budget
from .device_tables import DeviceTable, WatchTable
from .inputs_table import InputsTable
from .optimizations import Disabled, Fidelity
from .origin import Place, Source, key_of, line_of, named_files
from .party_tables import ChipTable, Controller, HostTable, OutsideTable, RoundsTable
from .serial import SerialTable, in_words
from .unit_table import Unit
from .wiring import Cable, TransceiverTable, wiring_of


class BadCase(ValueError):
    """Error: a case cannot be loaded or run.

    The message is one sentence for the user. It has the file and the line of the key that is wrong, if there is one.
    """


class Case(Table, frozen=True, kw_only=True):
    """A case: the parts of a scene, how long it runs, and the budgets that must hold.

    name: name in messages and tables
    about: description of the case
    duration: simulated time of the run
    start: simulated time at the beginning of the run; reports count from there
    seed: seed of all random values; equal seeds give equal runs
    disable: names of optimizations to switch off, or `"all"`; they change no result
    fidelity: obsolete; accepted without effect
    strict: the run ends with status 2 and the firmware's line as soon as firmware breaks a rule of the manuals,
        such as the range of the I2C module clock
    stall_limit: CPU time that your Python code may take while simulated time does not advance; then the run fails with
        status 1 and the line. Off under a debugger; `"0 s"` is no limit
    unit, cable, transceiver, chip, device, controller, rounds, host, serial, inputs, watch, outside, fault: tables
        of the parts
    measures: measures of your own: `"late" = "count of record round missed"`
    measures_from: TOML file of measures
    budget: limits, `[[budget]]`
    breaks: budgets that a known bug breaks; `periph-sim check` requires exactly these to break, `run` ignores the
        key
    """

    name: str
    about: str = ""
    duration: Duration
    start: Duration = Fraction(0)
    seed: int = 0
    disable: Disabled = ()
    fidelity: Fidelity = ""
    strict: bool = False
    stall_limit: Duration = Fraction(10)
    unit: dict[str, Unit] = {}
    cable: tuple[Cable, ...] = ()
    transceiver: tuple[TransceiverTable, ...] = ()
    chip: dict[str, ChipTable] = {}
    device: dict[str, DeviceTable] = {}
    controller: Controller | None = None
    rounds: RoundsTable | None = None
    host: HostTable | None = None
    serial: SerialTable | None = None
    inputs: InputsTable | None = None
    watch: dict[str, WatchTable] = {}
    outside: OutsideTable | None = None
    fault: tuple[dict[str, object], ...] = ()
    measures: dict[str, str] = {}
    measures_from: str = ""
    budget: tuple[Budget, ...] = ()
    breaks: tuple[str, ...] = ()
    _source: Source | None = None
    _all_budgets: tuple[Budget, ...] = ()  # all budgets of the file; empty if none were removed from `budget`
    _replaced: dict[str, str] = {}  # maps each replaced party to a sentence about its replacement

    @classmethod
    def model_validate(cls, tree: object) -> Case:
        """Return the case that a tree of TOML tables describes. Raise BadTable if the tree is not valid."""
        return convert(cls, tree).completed()

    def completed(self) -> Case:
        """Return this case with a budget for each expected reply, send with `expect = "nothing"` and watched wire.

        Raise BadTable if a table contradicts another table, if `breaks` names an unknown budget, if `host.lose` names a
        byte that no frame has, or if times of [inputs] are not in order.
        """
        known_budgets = {(budget.name, budget.measure) for budget in self.budget}
        made = [budget for _, budget in self._made_budgets() if (budget.name, budget.measure) not in known_budgets]
        case = self.model_copy(update={"budget": self.budget + tuple(made)})
        known = [budget.name for budget in case.budget]
        strange = [
            Mistake(("breaks", number), f"there is no budget {name!r}; {did_you_mean(name, known)}")
            for number, name in enumerate(case.breaks)
            if name not in known
        ]
        if case.host is not None and case.host.lose:
            last = host_frames().FRAME_BYTES - 1
            strange += [
                Mistake(("host", "lose", number, 1), f"expected 0 to {last}, but it is {byte}")
                for number, (_, byte) in enumerate(case.host.lose)
                if not 0 <= byte <= last
            ]
        strange += case._flaws_of_inputs()
        if case.controller is not None and case.rounds is not None:
            strange.append(Mistake(("rounds",), "[controller] says its rounds already; leave one of them out"))
        if strange:
            raise BadTable(strange)
        return case

    def _flaws_of_inputs(self) -> Iterator[Mistake]:
        """Yield a mistake for each key of [inputs] that applies to no part of the case.

        Yield one also for each start that is not after the start before it in its list.
        """
        inputs = self.inputs or InputsTable()
        if inputs.rounds is not None and self.controller is None:
            yield Mistake(("inputs", "rounds"), "there is no [controller] whose rounds could start then; leave it out")
        if inputs.frames is not None and self.host is None:
            yield Mistake(("inputs", "frames"), "there is no [host] whose frames could start then; leave it out")
        if inputs.sends_later and self.serial is None:
            yield Mistake(("inputs", "sends_later"), "there is no [serial] whose sends could be later; leave it out")
        for name, times in (("rounds", inputs.rounds), ("frames", inputs.frames)):
            for number, (before, after) in enumerate(pairwise(times or ()), 1):
                if after <= before:
                    yield Mistake(("inputs", name, number), "it is not after the start before it; list them in order")
        for unit in inputs.costs:
            if unit not in self.unit:
                yield Mistake(("inputs", "costs", unit), f"there is no unit {unit!r}; {did_you_mean(unit, self.unit)}")
            elif not self.unit[unit].firmware:
                way = "only computations of Python firmware have a range; leave it out"
                yield Mistake(("inputs", "costs", unit), way)

    def _made_budgets(self) -> Iterator[tuple[Place, Budget]]:
        """Yield (place, budget) for each send with `expect = "nothing"`, each expected reply and each watched wire.

        The place is that of the table in the case from which the budget is made.
        """
        serial = self.serial or SerialTable()
        for n, send in enumerate(serial.send):
            if send.expect is not None and send.name is not None:
                yield ("serial", "send", n), Budget(name=send.name, measure=SILENCE + send.name, max=0)
        for n, reply in enumerate(serial.expect):
            within = in_words(reply.within)
            place = ("serial", "expect", n)
            yield place, Budget(name=reply.name, measure=REPLY + reply.name, max=within, why=reply.why)
        for name, watch in self.watch.items():
            most = in_words(watch.tolerance)
            yield ("watch", name), Budget(name=name, measure=WATCH + name, max=most, why=watch.why)

    def from_source(self, source: Source) -> Case:
        """Return a copy of this case with `source`, the file from which the case was read."""
        return self.model_copy(update={"_source": source})

    @property
    def folder(self) -> Path:
        """The folder of the case's file, to which its paths are relative; the current folder if there is no file."""
        return Path() if self._source is None else self._source.folder

    @property
    def file(self) -> Path | None:
        """The path of the case's file; for tables given to `make_case`, their label; None for a Case without source."""
        return None if self._source is None else self._source.path

    def files(self) -> Iterator[Path]:
        """Yield the case's file, the files that texts in the case may name, and the files that these may import.

        See `named_files`.
        """
        if self._source is not None:
            yield self._source.path
            yield from named_files(self.folder, self._source.values)

    @property
    def changes(self) -> tuple[str, ...]:
        """The `key=value` texts that were applied to the case's file."""
        return () if self._source is None else tuple(change for change, _ in self._source.changes)

    @property
    def replaced(self) -> tuple[str, ...]:
        """A sentence about each party of the case that an outside party replaces, or that stays active with it."""
        return tuple(self._replaced.values())

    @property
    def rx_sender(self) -> str:
        """A phrase for the sender on RX: "the host"; "the outside" if an outside party replaces the host; else ""."""
        return "the host" if self.host is not None else "the outside" if "host" in self._replaced else ""

    @property
    def checks_host(self) -> bool:
        """True if the bytes that are read from known chips are compared with the values of the host's frames.

        If the firmware has sensor models, the bytes are compared with the values that the models compute from the
        frames.
        """
        rounds = self.controller or self.rounds
        return rounds is not None and rounds.check == "host"

    @property
    def recorded_modules(self) -> dict[str, tuple[str, ...]]:
        """A dictionary from a unit to the names that a recording lists for this unit.

        The names are the modules of the unit, and "pin:WIRE" for its wires and RS-485 pairs other than SDA, SCL, RX and
        TX. A wire that is connected to several units is listed only for the first of them.
        """
        usual = ("SDA", "SCL", "RX", "TX")
        wires = {name: dict.fromkeys(pins.values()) for name, pins in wiring_of(self).pins.items()}
        listed: set[str] = set()
        found: dict[str, tuple[str, ...]] = {}
        for name, unit in self.unit.items():
            pairs = [one.pair for one in self.transceiver if one.on.startswith(f"{name}.") or len(self.unit) == 1]
            all_wires = dict.fromkeys([*wires[name], *pairs])
            new = [wire for wire in all_wires if wire not in listed and wire not in usual]
            found[name] = (*unit.modules, *(f"pin:{wire}" for wire in new))
            listed.update(new)
        return found

    def mistake(self, what: str, *place: str | int) -> BadCase:
        """Return an error about the key at `place` in this case, with file and line if there is a file."""
        place = self._written(place)
        key = key_of(place, self._named())
        where = f"case {self.name}" if self._source is None else self._source.where(place)
        return BadCase(f"{where}: {key}: {what}")

    def unknown(self, kind: str, name: str, known: Iterable[str], *place: str | int) -> BadCase:
        """Return an error about an unknown name at `place`, with similar names from `known`.

        kind: a noun for the things that have such names, such as "wire".
        """
        return self.mistake(f"there is no {kind} {name!r}; {did_you_mean(name, known)}", *place)

    def line(self, *place: str | int) -> int:
        """Return the line of a key in the case's file.

        If the file does not contain the key, return the line of the header of the key's table, or else of a table that
        contains this table. Return 0 if the file has no such header, or if the case was not read from a file.
        """
        return 0 if self._source is None else line_of(self._source.text, self._written(place))

    def _named(self) -> dict[str, Any]:
        """Return the names of the case's budgets, sends and replies, in a tree for `key_of`."""
        serial = self.serial or SerialTable()
        return {
            "budget": [{"name": budget.name} for budget in self._all_budgets or self.budget],
            "serial": {
                "send": [{"name": send.name} for send in serial.send],
                "expect": [{"name": expect.name} for expect in serial.expect],
            },
        }

    def _written(self, place: tuple[str | int, ...]) -> tuple[str | int, ...]:
        """Convert a place in this case to the corresponding place in its file.

        Only places of budgets differ:
        - A budget that was made from another table is at the place of this table: an expected reply, a send with
          `expect = "nothing"`, or a watched wire.
        - The index of another budget can be different in the file. If [outside] has replaced a party of the case, the
          budgets that cannot be judged without this party are in the file, but not in this case.
        """
        if len(place) < 2 or place[0] != "budget":
            return place
        budget = self.budget[int(place[1])]
        for written, made in self._made_budgets():
            if made == budget:
                return written if written[0] == "watch" else (*written, *place[2:])
        return ("budget", self._all_budgets.index(budget), *place[2:]) if self._all_budgets else place
