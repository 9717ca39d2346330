"""The interface of an F28335 for its Python firmware: registers, waits, computations, interrupts and pins."""

# core: compiled

from __future__ import annotations

import operator
from collections.abc import Callable, Sequence
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

LONG = 1 << 31  # to save time, only larger numbers of cycles are compared with the length of the longest possible run


class Span:  # core: python
    """Context manager of a span.

    It is a class, because a generator of contextlib would add stack frames between the firmware and `Cpu.mark_span`.
    """

    def __init__(self, cpu: Cpu, name: str) -> None:
        self._cpu = cpu
        self._name = name

    def __enter__(self) -> None:
        self._cpu.mark_span(self._name, 1)

    def __exit__(self, *_: object) -> None:
        self._cpu.mark_span(self._name, 0)


class FirmwareView:
    """One unit as its firmware uses it. sockets: the sockets of its modules, by the names of the modules."""

    cpu: Cpu
    waits: Waits
    memory: AddressMap
    control: SystemControl

    def __init__(self, name: str, seed: int, costs: Sequence[Fraction] = ()) -> None:
        """name: the name of the unit. seed: the seed of the durations that are drawn from spreads.

        costs: the durations, in seconds, of the first computations whose cost is a spread. Later durations are drawn.
        """
        self.name: str = name
        self.sockets: dict[str, Socket] = {}
        self._ports: dict[str, ModulePort] = {}
        self._random: Random = Random(f"{seed} {name} computations")
        self._costs: Sequence[Fraction] = costs
        self._drawn = 0  # number of computations so far whose cost was a spread

    def has(self, module: Text) -> bool:
        """Return True if the unit has this module."""
        return module in self.sockets

    def module(self, name: Text) -> ModulePort:
        """Return the registers of a module, such as "I2C-A". Raise KeyError if the unit does not have the module."""
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
        """Wait until `condition()` is true, as `while (!...);` does. Return False if the wait has timed out.

        The condition need not be called again before a bit that it has read changes or an interrupt is served, so its
        result must depend on nothing else.

        pass_cycles: all cycles of one pass of the loop, as counted in its disassembly. By default, they are computed:
        a pass with one read in peripheral frame 2 takes the cycles in the key `code.poll_pass` of the unit, and each
        further read of the pass adds its cycles.
        timeout: cycles, or seconds (rounded up to a cycle), from the start of the wait, service routines included. It
        is checked between two passes.
        """
        if not callable(condition):
            raise _no_condition("spin", condition)
        pass_cycles = self._pass("spin", pass_cycles)
        return self.waits.spin(condition, pass_cycles, None if timeout is None else self._cycles(timeout))

    def spin_either(
        self, ready: Callable[[], object], over: Callable[[], object], *, pass_cycles: int | None = None
    ) -> bool:
        """Wait as `while (!ready) if (over) break;` does. Return True if `over` has ended the wait.

        pass_cycles: all cycles of one pass of the loop, as for `spin`.
        """
        if not (callable(ready) and callable(over)):
            raise _no_condition("spin_either", over if callable(ready) else ready)
        return self.waits.spin_either(ready, over, self._pass("spin_either", pass_cycles))

    def _pass(self, what: Text, cycles: BigInt | None) -> BigInt | None:
        """Return `cycles`, the cycles of a pass, or None if it is None. Raise Misuse if it is no integer above 0."""
        if cycles is None:
            return None
        if type(cycles) is not int or cycles < 1:
            raise Misuse(f"dsp.{what}: pass_cycles is {cycles!r}; expected a whole number of cycles above 0")
        return self._fitting(cycles, f"dsp.{what}: pass_cycles = {cycles}") if cycles > LONG else cycles

    def compute(self, cost: Spread | Fraction | int, name: Text = "") -> None:  # core: python
        """Let the time of a computation pass. cost: an int is cycles, a Fraction is seconds (rounded up to a cycle).

        For a spread, each call takes the next of `costs`; after the last one, it draws a whole number of cycles, each
        with the same probability. name: the name of a span around the computation; "" for no span.
        """
        if isinstance(cost, Spread):
            cost = self._value_in(cost)
        self.cpu.compute(self._cycles(cost), name)

    def _value_in(self, spread: Spread) -> int:
        """Return the cycles of a computation whose cost is a spread: the next of `costs`, or a drawn time.

        Raise Misuse if the next of `costs` is not in the spread.
        """
        number, self._drawn = self._drawn, self._drawn + 1
        if number >= len(self._costs):
            return self._random.randint(self._cycles(spread.least), self._cycles(spread.most))
        cost: Fraction = self._costs[number]
        if not spread.least <= cost <= spread.most:
            given, least, most = (f"{float(1_000_000 * one):g} us" for one in (cost, spread.least, spread.most))
            raise Misuse(f"entry {number + 1} of costs in [inputs] is {given}; expected {least} to {most}")
        return self._cycles(cost)

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
        """Return a number of cycles, or the number of cycles that remain in the longest possible run if that is less.

        Raise Misuse if the number exceeds the length of the longest possible run.

        what: the number and its use, for the message.
        """
        time = self.cpu.time
        left = time.left()
        if cycles > left + time.cycle:
            raise Misuse(f"{what} exceeds the longest possible run, of {left + time.cycle} cycles")
        return min(cycles, left)

    def span(self, name: Text) -> Span:
        """Return a context manager that names a span of firmware, for budgets and recordings. It takes no cycles."""
        if not isinstance(name, str) or not name:
            raise Misuse(f"dsp.span needs the name of the span, but got {name!r}")
        return Span(self.cpu, name)

    def report_overflow(self, text: Text) -> None:  # core: python
        """Make a note of a fixed-point result that does not fit its format. text: the result and the format."""
        self.cpu.processor.notes.note(self.cpu.time.cycle, Note("overflow", text, "IQmath guide V1.70"))

    def set_pin(self, pin: BigInt) -> None:  # core: python
        """Set a GPIO pin by one write of its bit to the register GPxSET. Do nothing without a GPIO module."""
        self._write_pin("SET", pin)

    def clear_pin(self, pin: BigInt) -> None:  # core: python
        """Clear a GPIO pin by one write of its bit to the register GPxCLEAR. Do nothing without a GPIO module."""
        self._write_pin("CLEAR", pin)

    def _write_pin(self, what: Text, pin: BigInt) -> None:
        if self.has("GPIO"):
            from ...f28335.gpio.register_map import PINS  # imported only for units with a GPIO module

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
        """Set a bit of IER, as `IER |= M_INTn` does. number: 1 to 14 for INT1 to INT14, 15 DLOGINT, 16 RTOSINT."""
        _require(number, range(1, MASKABLE + 1), "a CPU interrupt")
        self.cpu.or_ier(1 << (number - 1))

    def handle(self, name: Text, handler: Callable[[], None]) -> tuple[int, int]:
        """Make `handler` the service routine of a vector. Return (group, line) in the PIE.

        For a vector without a group, such as "INT13" or "NMI", return (number of the vector, 0). Raise Misuse if
        `handler` is no plain function without arguments, or the vector is RESET; KeyError if there is no such vector.
        name: the name of the vector, such as "I2CINT1A".
        """
        if not callable(handler):
            raise Misuse(f"the routine of {name!r} is {handler!r}; give the function itself, without calling it")
        what = flaw_of(handler, 0)
        if what:
            raise Misuse(f"the routine of {name!r} {what}; a service routine is a plain function without arguments")
        if name not in pie_map.VECTORS:
            raise KeyError(f"there is no vector {name!r}; {did_you_mean(name, [*pie_map.LINES, *pie_map.CPU_VECTORS])}")
        if name == "RESET":
            raise Misuse("the vector 'RESET' is in boot ROM, so it takes no routine; after a reset, main begins again")
        self.cpu.program.handle(name, handler)
        return pie_map.LINES[name] if name in pie_map.LINES else (pie_map.CPU_VECTORS[name], 0)


def _require(number: BigInt, numbers: range, what: Text) -> None:
    """Raise Misuse if a number is none of `numbers`. what: the thing that the number should name, for the message."""
    if type(number) is not int or number not in numbers:
        raise Misuse(f"{number!r} does not name {what}; expected a number from {numbers[0]} to {numbers[-1]}")


def _no_condition(what: Text, given: object) -> Misuse:
    way = "write dsp.spin(lambda: ...), so that each pass evaluates it again"
    return Misuse(f"dsp.{what} needs a function to call in each pass, but got {given!r}; {way}")
