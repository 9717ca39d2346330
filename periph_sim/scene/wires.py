"""The wires of a scene, by name. Each is made at its first use, so that a scene has none that it does not need."""

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
        """Return a new wire."""
        return Wire(kernel, name, recorder)
