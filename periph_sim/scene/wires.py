"""The wires of a scene, by name: each is made when somebody first asks for it, so that no scene has one too many."""

from __future__ import annotations

from ..core.kernel import Kernel
from ..core.records import Recorder
from ..core.wire import Wire


class SceneWires(dict[str, Wire]):
    def __init__(self, kernel: Kernel, recorder: Recorder) -> None:
        self._kernel = kernel
        self._recorder = recorder

    def wire(self, name: str) -> Wire:
        if name not in self:
            self[name] = self.made(self._kernel, name, self._recorder)
        return self[name]

    def made(self, kernel: Kernel, name: str, recorder: Recorder) -> Wire:
        """A new one."""
        return Wire(kernel, name, recorder)
