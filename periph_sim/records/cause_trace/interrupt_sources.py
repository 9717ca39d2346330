"""Which fields of which modules ask for which interrupt: a vector goes in, module and fields come out."""

from __future__ import annotations

from ...f28335.parts.f28335 import PART


def sources(vector: str) -> tuple[str, tuple[str, ...]]:
    """Return the module that requests an interrupt, and the fields whose rise requests it; ("", ()) for any other."""
    found = PART.module_of_vector(vector)
    if found is None:
        return "", ()
    module, interrupt = found
    return (module.name, interrupt.fields) if interrupt.fields else ("", ())
