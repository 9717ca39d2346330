"""A target that stretches the clock or has faults: rules change its answers by held lines, NACKs and wrong bytes.

    call of answer, send_byte or receive_byte --> the target's answer --> changed by each rule whose `When` is true

Bytes are numbered from 0, which is the address. A phase is a START with the target's address. Phases are numbered from
1. A rule with `access` counts only the phases whose R/W bit equals `access`. A target without power does not answer
until the power returns.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from random import Random
from typing import Protocol, runtime_checkable

from ...core.kernel import Kernel
from ...core.state import State
from ..faults import HeldLine
from .target_side import Reply, Stretches, Target, TargetSide

READ = 1


@runtime_checkable
class HasPowerOff(Protocol):
    """A target that drives more wires than those of the bus."""

    def power_off(self) -> None:
        """Handle the loss of the supply: these wires become inactive until `power_on`."""


@dataclass(frozen=True)
class When:
    """The conditions under which a rule applies to a byte. All of them must hold.

    bytes, phases: the numbers of the bytes and phases; empty for all.
    access: the R/W bit of the phase, or None for both.
    share: the probability that the rule applies if the other conditions hold; drawn from `random`.
    after: the first tick at which the rule applies.
    until: the tick from which on the rule no longer applies; None for no end.
    """

    STATE = State("random")

    random: Random
    bytes: tuple[int, ...] = ()
    phases: tuple[int, ...] = ()
    access: int | None = None
    share: Fraction = Fraction(1)
    after: int = 0
    until: int | None = None

    def strikes(self, byte: int, phase: int, access: int, now: int) -> bool:
        if (self.bytes and byte not in self.bytes) or (self.access is not None and access != self.access):
            return False
        if (self.phases and phase not in self.phases) or now < self.after:
            return False
        if self.until is not None and now >= self.until:
            return False
        return self.share == 1 or self.random.random() < self.share


@dataclass
class Rule:
    """A disturbance of a target. By default nothing is changed.

    refuses: True if the bytes are not acknowledged.
    replace: a function that gets the byte that the target would send, and returns the byte to send instead.
    strike: disturbs the lines; called at the fall of SCL before an ACK or before the first bit of a byte.
    held: the line that `strike` holds low, if there is one.
    phase: number of phases so far whose R/W bit matches `when.access`.
    """

    STATE = State("when phase held")

    when: When
    refuses: bool = False
    replace: Callable[[int], int] | None = None
    strike: Callable[[], None] | None = None
    held: HeldLine | None = None
    phase: int = 0


def stretch(random: Random, least: int, most: int, hold_clock: Callable[[int], None]) -> None:
    """Hold SCL low for a random time. least, most: the range of the time, in ticks.

    hold_clock: the method `TargetSide.hold_clock` of the target.
    """
    if ticks := random.randint(least, most):
        hold_clock(ticks)


def replaced(sent: int, value: int) -> int:
    """Return `sent` in place of the byte `value`."""
    return sent


def flip(random: Random, bit: int | None, value: int) -> int:
    """Return the byte `value` with one bit inverted. bit: the bit's number, 7 for the first; None for a random bit."""
    return value ^ 1 << (random.randrange(8) if bit is None else bit)


class DisturbedTarget:
    """A target whose answers are changed by rules. Its `answer` returns this object itself as the `Reply`."""

    STATE = State("_target _rules _reply _access")

    ack = True

    def __init__(self, kernel: Kernel, target: Target, rules: Sequence[Rule]) -> None:
        self._kernel = kernel
        self._target = target
        self._rules = rules
        self._reply: Reply | None = None
        self._access = 0

    @property
    def addresses(self) -> tuple[int, ...]:
        return self._target.addresses

    @property
    def stretches(self) -> Stretches:
        return () if self._reply is None else self._reply.stretches

    def power_on(self) -> None:
        self._target.power_on()

    def on_end(self, stop: bool, whole: bool) -> None:
        self._target.on_end(stop, whole)

    def answer(self, address_byte: int) -> DisturbedTarget | None:
        if address_byte >> 1 not in self._target.addresses:
            return None
        self._access = address_byte & READ
        for rule in self._rules:
            rule.phase += rule.when.access in (None, self._access)
        striking = self._striking(0)
        if any(rule.refuses for rule in striking):
            return None
        self._reply = self._target.answer(address_byte)
        if self._reply is None or not self._reply.ack:
            return None
        _strike(striking)
        return self

    def receive_byte(self, byte: int, value: int) -> bool:
        assert self._reply is not None
        striking = self._striking(byte + 1)
        _strike(striking)
        return not any(rule.refuses for rule in striking) and self._reply.receive_byte(byte, value)

    def send_byte(self, byte: int) -> int:
        assert self._reply is not None
        value = self._reply.send_byte(byte)
        striking = self._striking(byte + 1)
        _strike(striking)
        for rule in striking:
            value = value if rule.replace is None else rule.replace(value)
        return value

    def _striking(self, byte: int) -> list[Rule]:
        now = self._kernel.now
        return [rule for rule in self._rules if rule.when.strikes(byte, rule.phase, self._access, now)]


def _strike(rules: Sequence[Rule]) -> None:
    for rule in rules:
        if rule.strike is not None:
            rule.strike()


def cut_power(kernel: Kernel, side: TargetSide, target: Target, at: int, until: int | None) -> None:
    """Switch the target off at tick `at`, and on again at tick `until`; if `until` is None, the target stays off."""

    def go_off() -> None:
        side.power(False)
        if isinstance(target, HasPowerOff):
            target.power_off()

    def come_back() -> None:
        target.power_on()
        side.power(True)

    kernel.call_at(at, go_off)
    if until is not None:
        kernel.call_at(until, come_back)
