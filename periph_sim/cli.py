"""The command line: arguments go in; tables or one JSON object come out, and an exit status.

0 all budgets hold or the replay agrees, 1 not so, 2 bad usage or bad input, 3 a fault of our own.
"""

from __future__ import annotations

import sys
import traceback

import click

from .commands.regs import regs
from .commands.replay import replay
from .commands.run import run

MISTAKE, FAULT = 2, 3


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="periph-sim")
def cli() -> None:
    """Run F28335 firmware against SCI and I2C models and check its timing."""


cli.add_command(run)
cli.add_command(replay)
cli.add_command(regs)


def main() -> None:
    """Entry point of `periph-sim`."""
    try:
        status = cli.main(standalone_mode=False)
        sys.exit(status if isinstance(status, int) else 0)
    except click.ClickException as error:
        error.show()
        sys.exit(MISTAKE)
    except click.Abort:
        click.echo("stopped", err=True)
        sys.exit(MISTAKE)
    except BrokenPipeError:
        sys.exit(0)
    except Exception:
        click.echo("periph-sim: a fault of its own; please report it with the command and what follows.", err=True)
        traceback.print_exc()
        sys.exit(FAULT)


if __name__ == "__main__":
    main()
