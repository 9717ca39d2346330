"""Several shortcuts at once: a kernel goes in; the list of what passes without its events just now comes out.

whole bytes of a bus, whole frames of each line --> Shortcuts --> Kernel.shortcut
"""

# core: compiled

from __future__ import annotations

from .kernel import Kernel, Shortcut


class Shortcuts(Shortcut):
    """What passes at once now. One that was caught up with has taken itself out."""

    __slots__ = ("_first", "_others")

    def __init__(self) -> None:
        self._first: Shortcut | None = None
        self._others: list[Shortcut] = []  # that began after it; hardly ever any

    def begin(self, shortcut: Shortcut) -> None:
        """From now on this one passes at once, too."""
        if self._first is None:
            self._first = shortcut
        else:
            self._others.append(shortcut)

    def passes(self, shortcut: Shortcut) -> bool:
        """Whether it does."""
        return shortcut is self._first or shortcut in self._others

    def end(self, shortcut: Shortcut) -> None:
        """It does no longer."""
        if shortcut is not self._first:
            self._others.remove(shortcut)
        elif self._others:
            self._first = self._others.pop(0)
        else:
            self._first = None

    def catch_up(self) -> None:
        if self._first is None:
            return
        shortcut: Shortcut
        for shortcut in (self._first, *self._others):
            if self.passes(shortcut):  # it may have ended with one before
                shortcut.catch_up()


class Untold(Shortcut):
    """What passes at once, and a chip has not been told of."""

    __slots__ = ()

    def settle(self) -> None:
        """Somebody looks at the chip: it is told up to now, and all else goes on."""
        raise NotImplementedError


def shortcuts_of(kernel: Kernel) -> Shortcuts:
    """Those of a kernel, which has no other shortcut."""
    known = kernel.shortcut
    if not isinstance(known, Shortcuts):
        known = kernel.shortcut = Shortcuts()
    return known
