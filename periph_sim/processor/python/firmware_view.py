"""Python firmware's view of its F28335: registers, waits, computations, interrupts and pins.

`Dsp` builds the unit.
"""

# core: compiled

from __future__ import annotations

import operator
from collections.abc import Callable
from fractions import Fraction
from random import Random

from ...core.chip import Note
from ...core.phrases import did_you_mean
from ...core.socket import Socket
from ...core.table import Spread
from ...f28335.cpu.interrupts import MASKABLE
from ...f28335.memory.memory_map import AddressMap
from ...f28335.parts.f28335 import PART
from ...f28335.pie import register_map as pie_map
from ...f28335.system_control.module import SystemControl
from ...form.c_types import BigInt, Text
from ..user_code import Misuse, flaw_of
from .cpu import Cpu
from .register_view import ModulePort
from .waits import Waits

LONG = 1 << 31  # cycles: times below this need no check against the end of time


class Span:  # core: python
    """Context manager of a span. Not made by contextlib, whose frames would be between the firmware and the call."""

    def __init__(self, cpu: Cpu, name: str) -> None:
        self._cpu = cpu
        self._name = name

    def __enter__(self) -> None:
        self._cpu.mark_span(self._name, 1)

    def __exit__(self, *_: object) -> None:
        self._cpu.mark_span(self._name, 0)


class FirmwareView:
    """One unit as its firmware sees it. sockets: its modules by name. seed: seed of the values drawn from spreads."""

    cpu: Cpu
    waits: Waits
    memory: AddressMap
    control: SystemControl

    def __init__(self, name: str, seed: int) -> None:
        self.name: str = name
        self.sockets: dict[str, Socket] = {}
        self._ports: dict[str, ModulePort] = {}
        self._random: Random = Random(f"{seed} {name} computations")

    def has(self, module: Text) -> bool:
        """Return True if the unit has this module."""
        return module in self.sockets

    def module(self, name: Text) -> ModulePort:
        """Return the registers of a module, such as "I2C-A", "PIE" or "TIMER0". Raise KeyError if it is not built."""
        if name not in self.sockets:
            known = name in PART.selectable
            way = f"name it in modules of [unit.{self.name}]" if known else did_you_mean(name, self.sockets)
            raise KeyError(f"{self.name} has no module {name!r}; {way}")
        if name not in self._ports:
            self._ports[name] = ModulePort(self.cpu, self.memory.places[name])
        return self._ports[name]

    def spin(
        self,
        condition: Callable[[], object],
        *,
        pass_cycles: int | None = None,
        timeout: Fraction | int | None = None,
    ) -> bool:
        """Wait until `condition()` is true, as `while (!...);` does. Return False if the wait timed out.

        pass_cycles: all cycles of one pass of this loop, counted in its disassembly; by default the unit's
        `code.poll_pass` and the cycles of further reads. timeout: cycles, or seconds (rounded up to a cycle), from the
        begin of the wait, service routines included; it is checked between two passes. The condition is called again
        only if a bit that it read has changed, or an interrupt was served: it must depend on nothing else.
        """
        if not callable(condition):
            raise _no_condition("spin", condition)
        pass_cycles = self._pass("spin", pass_cycles)
        return self.waits.spin(condition, pass_cycles, None if timeout is None else self._cycles(timeout))

    def spin_either(
        self, ready: Callable[[], object], over: Callable[[], object], *, pass_cycles: int | None = None
    ) -> bool:
        """Wait as `while (!ready) if (over) break;` does. Return True if `over` ended it. pass_cycles: see `spin`."""
        if not (callable(ready) and callable(over)):
            raise _no_condition("spin_either", over if callable(ready) else ready)
        return self.waits.spin_either(ready, over, self._pass("spin_either", pass_cycles))

    def _pass(self, what: Text, cycles: BigInt | None) -> BigInt | None:
        """Return the cycles, if they are given. Raise Misuse if a pass of a wait cannot take this number."""
        if cycles is None:
            return None
        if type(cycles) is not int or cycles < 1:
            raise Misuse(f"dsp.{what}: pass_cycles is {cycles!r}; expected a whole number of cycles above 0")
        return self._fitting(cycles, f"dsp.{what}: pass_cycles = {cycles}") if cycles > LONG else cycles

    def compute(self, cost: Spread | Fraction | int, name: Text = "") -> None:  # core: python
        """Compute for `cost`: a whole number of cycles, or seconds (rounded up to a cycle).

        Each call draws a whole number of cycles from a spread, all of them equally likely.
        """
        if isinstance(cost, Spread):
            cost = self._random.randint(self._cycles(cost.least), self._cycles(cost.most))
        self.cpu.compute(self._cycles(cost), name)

    def _cycles(self, cost: Fraction | int) -> BigInt:
        if isinstance(cost, Fraction):
            hz = self.control.sysclk_hz
            cycles = -(-cost.numerator * hz.numerator // (cost.denominator * hz.denominator))
        else:
            try:
                cycles = operator.index(cost)
            except TypeError:
                way = "expected whole cycles, or seconds as a Fraction: Fraction(250, 10**6)"
                raise Misuse(f"a time of {cost!r} is not an exact number; {way}") from None
        if cycles < 0:
            raise Misuse(f"a time of {cycles} cycles is negative; expected 0 or more")
        return self._fitting(cycles, f"a time of {cycles} cycles") if cycles > LONG else cycles

    def _fitting(self, cycles: BigInt, what: Text) -> BigInt:
        """Return the cycles, limited to the last tick. Raise Misuse if they exceed the longest possible run."""
        time = self.cpu.time
        left = time.left()
        if cycles > left + time.cycle:
            raise Misuse(f"{what} exceeds the longest possible run, of {left + time.cycle} cycles")
        return min(cycles, left)

    def span(self, name: Text) -> Span:
        """Return a context manager that names a span of firmware, for budgets and recordings; it costs no cycles."""
        if not isinstance(name, str) or not name:
            raise Misuse(f"dsp.span needs the name of the span, but got {name!r}")
        return Span(self.cpu, name)

    def report_overflow(self, text: Text) -> None:  # core: python
        """Report a result of fixed-point arithmetic that does not fit, for the notes of the run and `overflows`.

        text: the result, and the format that it exceeds.
        """
        self.cpu.processor.notes.note(self.cpu.time.cycle, Note("overflow", text, "IQmath guide V1.70"))

    def set_pin(self, pin: BigInt) -> None:  # core: python
        """Set a pin by one whole-register write, GPxSET = bit. Without GPIO in the scene, do nothing."""
        self._write_pin("SET", pin)

    def clear_pin(self, pin: BigInt) -> None:  # core: python
        """Clear a pin by one whole-register write, GPxCLEAR = bit."""
        self._write_pin("CLEAR", pin)

    def _write_pin(self, what: Text, pin: BigInt) -> None:
        if self.has("GPIO"):
            from ...f28335.gpio.register_map import PINS  # loaded only if the scene names the GPIO module

            _require(pin, range(PINS), "a pin")
            self.module("GPIO")[f"GP{'ABC'[pin // 32]}{what}"].all = 1 << pin % 32

    def eallow(self) -> None:  # core: python
        self.cpu.eallow()

    def edis(self) -> None:  # core: python
        self.cpu.edis()

    def eint(self) -> None:  # core: python
        self.cpu.eint()

    def dint(self) -> None:  # core: python
        self.cpu.dint()

    def enable_interrupt(self, number: BigInt) -> None:  # core: python
        """Set a bit of IER, IER |= M_INTn. number: 1 to 14 for INT1 to INT14, 15 for DLOGINT, 16 for RTOSINT."""
        _require(number, range(1, MASKABLE + 1), "a CPU interrupt")
        self.cpu.or_ier(1 << (number - 1))

    def handle(self, name: Text, handler: Callable[[], None]) -> tuple[int, int]:
        """Make `handler` the service routine of a vector. Return its PIE group and line, (n, 0) for INTn."""
        if not callable(handler):
            raise Misuse(f"the routine of {name!r} is {handler!r}; give the function itself, without calling it")
        what = flaw_of(handler, 0)
        if what:
            raise Misuse(f"the routine of {name!r} {what}; a service routine is a plain function without arguments")
        if name not in pie_map.VECTORS:
            raise KeyError(f"there is no vector {name!r}; {did_you_mean(name, [*pie_map.LINES, *pie_map.CPU_VECTORS])}")
        self.cpu.program.handle(name, handler)
        return pie_map.LINES[name] if name in pie_map.LINES else (pie_map.CPU_VECTORS[name], 0)


def _require(number: BigInt, numbers: range, what: Text) -> None:
    """Raise Misuse if this is not one of these numbers."""
    if type(number) is not int or number not in numbers:
        raise Misuse(f"{number!r} does not name {what}; expected a number from {numbers[0]} to {numbers[-1]}")


def _no_condition(what: Text, given: object) -> Misuse:
    way = "write dsp.spin(lambda: ...), so that each pass evaluates it again"
    return Misuse(f"dsp.{what} needs a function to call in each pass, but got {given!r}; {way}")
