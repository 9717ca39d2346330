"""Several shortcuts at once are caught up with in their order, each once, unless it has ended with one before."""

from __future__ import annotations

from periph_sim.core.kernel import Kernel, Shortcut
from periph_sim.core.shortcuts import Shortcuts, shortcuts_of


class Passing(Shortcut):
    """Notes its name as it is caught up with, and ends; others with it."""

    def __init__(self, name: str, shortcuts: Shortcuts, log: list[str]) -> None:
        self.name, self.shortcuts, self.log = name, shortcuts, log
        self.others: list[Passing] = []
        shortcuts.begin(self)

    def catch_up(self) -> None:
        self.log.append(self.name)
        for one in (self, *self.others):
            self.shortcuts.end(one)


def test_all_are_caught_up_with_in_the_order_in_which_they_began():
    kernel, log = Kernel(), []
    shortcuts = shortcuts_of(kernel)
    assert shortcuts_of(kernel) is shortcuts
    first, second, third = (Passing(name, shortcuts, log) for name in "abc")
    shortcuts.end(first)
    assert [shortcuts.passes(one) for one in (first, second, third)] == [False, True, True]
    shortcuts.begin(first)
    kernel.catch_up()
    assert log == ["b", "c", "a"]
    assert not any(shortcuts.passes(one) for one in (first, second, third))
    kernel.catch_up()
    assert len(log) == 3


def test_one_that_ended_with_another_is_left_alone():
    kernel, log = Kernel(), []
    first, second, third = (Passing(name, shortcuts_of(kernel), log) for name in "abc")
    first.others = [third]
    kernel.catch_up()
    assert log == ["a", "b"] and second.others == []
