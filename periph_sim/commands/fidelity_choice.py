"""What `--fidelity` and `--max-error` say: texts of options go in; a change of the case, or a bound, comes out."""

from __future__ import annotations

import click

from ..core.settings import duration

AUTO = "auto"


def error_given(text: str) -> float:
    """`--max-error` in seconds."""
    try:
        return float(duration(text))
    except ValueError as error:
        raise click.ClickException(f"--max-error: {error}") from None
