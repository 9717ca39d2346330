"""Text about the undocumented behaviours that a run depended on.

assumes 23 undocumented behaviours (-v lists them)

assumes 2 undocumented behaviours; docs/options.md has the question of each:      with -v
  dsp.i2c.bcm_reset = 0; the default is 1
  dsp.i2c.rrdy_point = fall8, the default
"""

from __future__ import annotations

from collections.abc import Sequence

from ...core.options import Value
from ...scene.case.model import Case

PAGE = "docs/options.md"


def assumptions(names: Sequence[str], case: Case, verbose: bool) -> list[str]:
    """Return lines to print; none if the run depended on no option. names: `UNIT.GROUP.OPTION` or `CHIP.OPTION`."""
    if not names:
        return []
    head = f"assumes {len(names)} undocumented behaviour{'s' * (len(names) > 1)}"
    if not verbose:
        return [f"{head} (-v lists {'them' if len(names) > 1 else 'it'})"]
    return [f"{head}; {PAGE} has the question of each:", *(f"  {name} {_answer(name, case)}" for name in names)]


def _answer(name: str, case: Case) -> str:
    from .option_groups import OPTIONS

    owner, _, rest = name.partition(".")
    given: dict[str, Value]
    if owner in case.unit:
        group, _, option = rest.partition(".")
        given = case.unit[owner].options.get(group, {})
    else:
        group, option, given = case.chip[owner].model, rest, case.chip[owner].options
    default = OPTIONS[group]().unrecorded()[option]
    value = given.get(option, default)
    return f"= {_text(value)}{', the default' if value == default else f'; the default is {_text(default)}'}"


def _text(value: Value) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
