"""Annotations of a class itself, without those of its bases."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, get_type_hints


def own_annotations(kind: type) -> Mapping[str, Any]:
    """Return the annotations of a class; types may still be text.

    In Python 3.14, a class stores a function that returns its annotations, instead of the annotations themselves.
    """
    if sys.version_info >= (3, 14):
        from annotationlib import Format, get_annotations

        return get_annotations(kind, format=Format.FORWARDREF)
    found: Mapping[str, Any] = vars(kind).get("__annotations__", {})
    return found


def resolved_annotation(kind: type, name: str, names: dict[str, Any]) -> Any:
    """Return one annotation of a class, with the names in it looked up in `names`."""
    alone: Any = SimpleNamespace(__annotations__={name: own_annotations(kind)[name]})
    return get_type_hints(alone, names, include_extras=True)[name]
