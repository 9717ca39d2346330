"""What the level `schedule` refuses."""

from __future__ import annotations

from ...scene.case.model import BadCase


class BadSchedule(BadCase):
    """A case or a change that the level does not know; one sentence, with the way out."""


def refuse(case: str, what: str) -> BadSchedule:
    """Of a case whose structure is another; fidelity "edge" takes every case."""
    return BadSchedule(f'case {case}: {what}; the level "schedule" does not know that, use fidelity = "edge"')
