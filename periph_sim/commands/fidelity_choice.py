"""What `--fidelity` and `--max-error` say: texts of options go in; changes of the case, or a bound, come out."""

from __future__ import annotations

from pathlib import Path

import click

from ..core.settings import duration

AUTO = "auto"


def error_given(text: str) -> float:
    """`--max-error` in seconds."""
    try:
        return float(duration(text))
    except ValueError as error:
        raise click.ClickException(f"--max-error: {error}") from None


def fidelity_given(fidelity: str | None, max_error: str | None, record: Path | None) -> tuple[list[str], float | None]:
    """Changes of the case, and the bound that a level is chosen by; None where it is not."""
    if fidelity != AUTO:
        if max_error is not None:
            raise click.ClickException("--max-error belongs to --fidelity auto; give that, too")
        return ([] if fidelity is None else [f"fidelity={fidelity}"]), None
    if max_error is None:
        raise click.ClickException("--fidelity auto needs --max-error, how far times may be off, for instance '1 us'")
    if record is not None:
        raise click.ClickException("--record writes edges, which edge and adaptive have; give one of them, not auto")
    return [], error_given(max_error)
