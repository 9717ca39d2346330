"""Several shortcuts at once: a kernel goes in; the list of what passes without its events just now comes out.

whole bytes of a bus, whole frames of each line --> Shortcuts --> Kernel.shortcut
"""

from __future__ import annotations

from .kernel import Kernel, Shortcut


class Shortcuts(Shortcut):
    """under_way: what passes at once now. One that was caught up with has taken itself out."""

    __slots__ = ("under_way",)

    def __init__(self) -> None:
        self.under_way: list[Shortcut] = []

    def catch_up(self) -> None:
        for shortcut in tuple(self.under_way):
            if shortcut in self.under_way:  # it may have ended with one before
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
