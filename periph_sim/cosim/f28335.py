"""A component for cocotb tests that runs a case inside an HDL simulator, like the models of the cocotbext packages.

    scl, sda (resolved), rx --step to tick: floor--> Session.apply
    Session.advance --tick to step: ceil--> scl_o, sda_o, tx
    Session.next_output --> the time for which the timer is set

The simulator calls `_changed` when a line changes. A timer calls `_woken` when one of our pins may change, and `_woken`
advances the session's time. Both are plain callbacks, because waking a cocotb task takes several times as long.

A change of our pin is shown in the first step at or after its tick, and later than the line change that caused it: at
the earliest in the step after that change. A change of a line is applied at the tick that contains its step. There is
one exception: when the timer has shown a change of our pin at tick n, the session is already at tick n + 1. If a line
then changes in a later step of tick n, this change is applied at tick n + 1, because a session cannot go back.

The session receives the resolved level of a line, which includes our own pull. So after we release a line that another
party still holds low, the session sees no rise until that party has released it, too.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping
from contextlib import ExitStack
from fractions import Fraction
from pathlib import Path
from typing import Any

import cocotb
from cocotb import simulator
from cocotb.handle import Immediate
from cocotb.simtime import get_sim_time
from cocotb.triggers import Event, ReadWrite, Timer
from cocotb.utils import get_sim_steps

from ..core.phrases import did_you_mean
from ..outside.errors import OutsideError
from ..outside.log import refuse_input
from ..outside.session import Session
from ..records.recording import recording
from ..scene.case.load import load
from ..scene.case.model import Case
from ..scene.firmware_loader import Firmware
from ..scene.result import Result
from .axis import Axis
from .registers import peek

NEVER = 2**62
LEVELS = {"0": 0, "1": 1}
WAYS_OUT = {
    "z": "nothing drives it; give it a pull-up, for example `tri1`",
    "x": "two drivers disagree, or one has no value yet; give registers an initial value, or before_reset=1",
}


class F28335:
    """A case that runs from the current simulation time on, and whose wires are signals of `dut`.

    Each signal is given as an object or by its name in `dut`.

    case: a case from `load` or `make_case`, or the path of a file.
    scl, sda: the resolved lines, which are read.
    scl_o, sda_o: the signals that we drive: 0 pulls the line low, 1 releases it.
    rx: the line that we read.
    tx: the line that we drive.
    wires: the other wires of the case: a dictionary from the name of a wire to a pair of signals. The first signal is
        read, the second is driven, and either can be None.
    log: a file for the line changes, which `periph_sim.outside.replay` can replay.
    record: a file for the records, on the simulator's time axis.
    programs: a dictionary from the name of a unit to its firmware.
    before_reset: the level, 0 or 1, that replaces x and z on a line until the line's signal is 0 or 1 for the first
        time. From then on, x and z are errors. If `before_reset` is None, they are errors from the start.

    Raise OutsideError for a signal that is missing, x or z, for a step of the simulator that is longer than a tick, and
    for arguments that are invalid or do not fit each other.
    """

    def __init__(
        self,
        dut: Any,
        case: Case | str | Path,
        *,
        scl: Any = None,
        scl_o: Any = None,
        sda: Any = None,
        sda_o: Any = None,
        rx: Any = None,
        tx: Any = None,
        wires: Mapping[str, tuple[Any, Any]] | None = None,
        log: str | Path | None = None,
        record: str | Path | None = None,
        programs: Mapping[str, Firmware] | None = None,
        before_reset: int | None = None,
    ) -> None:
        self.log = logging.getLogger(f"cocotb.{dut._path}.f28335")
        for name, read, driven in (("scl", scl, scl_o), ("sda", sda, sda_o)):
            if (read is None) != (driven is None):
                raise OutsideError(
                    f"{name} and {name}_o go together: the resolved line, and a register for our own pull,"
                    f" for example assign {name} = {name}_o ? 1'bz : 1'b0"
                )
        pairs = {"SCL": (scl, scl_o), "SDA": (sda, sda_o), "RX": (rx, None), "TX": (None, tx), **(wires or {})}
        read = {name: _signal(dut, name, one) for name, (one, _) in pairs.items() if one is not None}
        self._driven = {name: _signal(dut, name, one) for name, (_, one) in pairs.items() if one is not None}
        if not read and not self._driven:
            raise OutsideError("no line is given; give scl, scl_o, sda, sda_o, rx or tx")
        case = case if isinstance(case, Case) else load(Path(case))
        if record is not None:
            refuse_input(Path(record), case, "record")
            if log is not None and Path(log).resolve() == Path(record).resolve():
                raise OutsideError(f"{log}: log and record are the same file; give different files")
        begin = get_sim_time("step")
        if before_reset not in (None, 0, 1):
            raise OutsideError(f"before_reset is {before_reset!r}; expected 0 or 1, the level of lines that are x or z")
        self._before_reset = before_reset or 0
        self._waiting = set() if before_reset is None else set(read)  # lines to which `before_reset` still applies
        if begin:  # the levels are not checked at time 0, because initial blocks have not run yet
            for name, signal in read.items():
                if name not in self._waiting:
                    _level(name, signal, "the beginning")
        per_second = get_sim_steps(1, "sec")
        if begin:  # the case starts at the simulator's present time, so that records have the simulator's times
            case = case.model_copy(update={"start": case.start + Fraction(begin, per_second)})
        self._files = ExitStack()
        subscribe, self._ended_at = self._files.enter_context(
            recording(None if record is None else Path(record), case.recorded_modules)
        )
        outside = tuple(dict.fromkeys((*read, *self._driven)))
        self.session = Session(case, outside, log=log, subscribe=subscribe, programs=programs)
        self.case = self.session.case
        self._axis = Axis(per_second, self.session.ticks_per_second, begin)
        self._end = self.session.scene.timebase.ticks(case.duration, "up")
        self._result: Result | None = None
        self.wakes = 0  # number of times that the timer has fired
        self._due = NEVER  # the tick for which the timer is set; NEVER if it is not set
        self._step = 0  # the step in which the timer fires
        self._timer: Any = None
        self._failed = Event()
        self._fault: Exception | None = None
        self._over = False  # True after the end or a failure: callbacks of the simulator are then ignored
        for signal in self._driven.values():
            signal.value = 1
        cocotb.start_soon(self._begin(read))
        cocotb.start_soon(self._last())
        for name, signal in read.items():
            self._listen(name, signal)
        self.log.info("F28335: case %s, lines %s", case.name, ", ".join(outside))

    # Called by tests ------------------------------------------------------------------

    @property
    def result(self) -> Result:
        """The result of the run with the verdicts of the case's budgets. The first access ends the run."""
        if self._result is None:
            session = self.session
            self._advance_to(min(self._axis.tick(get_sim_time("step")), max(self._end, session.now)))
            self._result = session.finish()
            self._over = True
            self._ended_at(session.scene.kernel.now, session.scene.clocks())
            self._files.close()
        return self._result

    async def finished(self) -> Result:
        """Wait until the case's duration is over, and return the Result."""
        left = self._axis.step(self._end) - get_sim_time("step")
        if self._result is None and left > 0:
            await Timer(left, "step")
        return self.result

    def peek(self, place: str) -> int:
        """Return the present value of a register or field, read as a debugger does, without side effects.

        place: for example "I2C-A.I2CSTR" or "dsp.I2C-A.I2CSTR.SCD". Raise OutsideError if it is unknown.
        """
        if self._result is None:
            self._advance_to(self._axis.tick(get_sim_time("step")))
        return peek(self.session.scene, place)

    # Lines ----------------------------------------------------------------------------

    async def _begin(self, read: Mapping[str, Any]) -> None:
        """Wait until initial blocks have run, then apply the initial levels of the lines."""
        await ReadWrite()
        if not self._over:
            for name, signal in read.items():
                self._moved(name, signal, _now())
            self._plan(_now())

    def _listen(self, name: str, signal: Any) -> None:
        """Register `_changed` as the callback for the next change of a line."""
        simulator.register_value_change_callback(signal._handle, self._changed, simulator.VALUE_CHANGE, name, signal)

    def _changed(self, name: str, signal: Any) -> None:
        if self._over:
            return
        self._listen(name, signal)
        try:
            step = _now()
            self._moved(name, signal, step)
            self._plan(step)
        except Exception as error:
            self._fail(error)

    def _moved(self, name: str, signal: Any, step: int) -> None:
        level = LEVELS.get(signal._handle.get_signal_val_binstr())
        if level is not None:
            self._waiting.discard(name)
        elif name in self._waiting:
            level = self._before_reset
        else:
            level = _level(name, signal)
        tick, session = self._axis.tick(step), self.session
        session.apply(tick if tick > session.now else session.now, {name: level})

    def _show(self, changes: list[Any]) -> None:
        for change in changes:
            signal = self._driven.get(change.line)
            if signal is not None:
                signal.value = Immediate(change.level)

    def _fail(self, error: Exception) -> None:
        """Store the error of a callback, which the simulator would discard. The task `_last` raises it in the test."""
        self._over = True
        self._fault = error
        self._failed.set()

    async def _last(self) -> None:
        """Wait during the whole test for the error of a callback, and raise it. Ignore callbacks after the test."""
        try:
            await self._failed.wait()
            if self._fault is not None:
                raise self._fault
        finally:
            self._over = True

    # Time -----------------------------------------------------------------------------

    def _advance_to(self, tick: int) -> None:
        """Advance the session to a tick, if it is not there yet, and show the changes of our pins."""
        if tick > self.session.now:
            self._show(self.session.advance(tick))

    def _plan(self, step: int) -> None:
        """Set the timer for the next change of our pins, unless it is already set for that tick or an earlier one.

        step: the simulator's present step. The timer fires in a later step.
        """
        due = self.session.next_output()
        if due is None or due >= self._due:
            return
        if self._timer is not None:
            self._timer.deregister()
        self._due = due
        self._step = max(self._axis.step(due), step + 1)
        self._timer = simulator.register_timed_callback(self._step - step, self._woken)

    def _woken(self) -> None:
        self._due, self._timer = NEVER, None
        if self._over:
            return
        self.wakes += 1
        try:
            step = self._step
            self._show(self.session.advance(self._axis.tick(step) + 1))
            self._plan(step)
        except Exception as error:
            self._fail(error)


def _now() -> int:
    """Return the simulator's current step."""
    high, low = simulator.get_sim_time()
    return high << 32 | low


def _level(name: str, signal: Any, at: str = "") -> int:
    """Return the level of a signal. If it is neither 0 nor 1, raise OutsideError, which says how to avoid that."""
    level: str = signal._handle.get_signal_val_binstr()
    if level in LEVELS:
        return LEVELS[level]
    way_out = WAYS_OUT.get(level.lower(), "it has to be 0 or 1")
    at = at or f"{get_sim_time('ns'):.3f} ns"
    raise OutsideError(f"{signal._path} (line {name}) is {level.lower()} at {at}: {way_out}")


def _signal(dut: Any, line: str, given: Any) -> Any:
    """Return the signal of a line. given: the signal itself, or its name in `dut`."""
    if not isinstance(given, str):
        return given
    try:
        return getattr(dut, given)
    except AttributeError:
        known = did_you_mean(given, [one._name for one in dut])
        raise OutsideError(f"{line}: {dut._path} has no signal {given!r}; {known}") from None
