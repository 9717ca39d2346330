"""The command line, which prints tables or one JSON object and ends with an exit status.

The exit status is 0 if the command finds nothing wrong, for example if all budgets hold, and 1 if it finds something.
It is 2 for incorrect usage or input, after Ctrl-C or SIGTERM, and if the output cannot be written. It is 3 for an
internal error, or if user code has ended the process or redirected its output (see `supervisor`). It is 141 if the
program that reads the output has ended.

A Python file in one of the `PACKAGES` defines a subcommand if it has a function with the file's name and the decorator
`command`. Only the subcommand that is run is imported, so `periph-sim decode` does not import chips and boards.
"""

from __future__ import annotations

import errno
import gc
import importlib
import os
import sys
from pathlib import Path
from typing import NoReturn

import click

from . import __version__, form
from .core.output_encoding import substitute_unencodable

MISTAKE, FAULT = 2, 3  # exit statuses for incorrect usage or input, Ctrl-C or a full disk, and for an internal error
CLOSED_PIPE = 141  # exit status that shells report for a process ended by SIGPIPE; 0 and 1 would be a verdict
CANNOT_WRITE = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)  # error numbers of a full disk, a quota or a file size limit
COMPLETING = "_PERIPH_SIM_COMPLETE"  # environment variable with which a shell asks click for completions
LONGEST_MESSAGE = 2000  # maximum number of characters of an error message, enough for a path and a few quotes

ROOT = Path(__file__).parent
PACKAGES = (
    "interfaces.commands",
    "imu.commands",
)  # packages within `periph_sim` whose files can be subcommands

SECTIONS = {  # sections of the command line's help; the decorator of each command names its section
    "run": "Run cases",
    "understand": "Understand a run",
    "traces": "Work with traces",
    "sensors": "Model sensors",
}


class Commands(click.Group):
    """Group of the subcommands in PACKAGES. An underscore in a file's name is a hyphen in the command's name."""

    def invoke(self, ctx: click.Context) -> object:
        """Run a subcommand. An error that the user's input causes becomes a ClickException."""
        from .core.input_files import inputs_of_one_command

        try:
            with inputs_of_one_command():
                return super().invoke(ctx)
        except Exception as error:
            if isinstance(error, OSError) and is_closed_pipe(error):
                # click would exit with 1, which means that a budget is broken
                raise click.exceptions.Exit(CLOSED_PIPE) from None
            from .interfaces.commands.command_frame import is_mistake

            if is_mistake(error):
                raise click.ClickException(str(error)) from None
            raise

    def list_commands(self, ctx: click.Context) -> list[str]:
        files = (file for package in PACKAGES for file in _folder(package).glob("*.py"))
        return sorted(file.stem.replace("_", "-") for file in files if _is_command(file))

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        file = _file(cmd_name)
        if not _is_command(file):
            return None
        name = ".".join([__package__, *file.relative_to(ROOT).with_suffix("").parts])
        if name not in sys.modules:
            gc.disable()  # imported modules stay in memory, so searching them for garbage would only take time
            importlib.import_module(name)
            gc.freeze()  # later garbage collections ignore the imported objects
            gc.enable()
        found: click.Command = getattr(sys.modules[name], file.stem)
        return found

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if not args[0].startswith("-") and not _is_command(_file(args[0])):
            from .core.phrases import did_you_mean
            from .removed import COMMANDS

            if args[0] in COMMANDS:
                raise click.ClickException(COMMANDS[args[0]])

            raise click.UsageError(
                f"there is no command {args[0]!r}; {did_you_mean(args[0], self.list_commands(ctx))}", ctx
            )
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        found: dict[str, list[tuple[str, str]]] = {}
        for name in self.list_commands(ctx):
            section, summary = _about(_file(name))
            found.setdefault(section, []).append((name, summary))
        widest = max((len(name) for rows in found.values() for name, _ in rows), default=0)
        for section, title in SECTIONS.items():
            if section in found:
                with formatter.section(title):
                    formatter.write_dl([(name.ljust(widest), summary) for name, summary in found[section]])


def _folder(package: str) -> Path:
    return ROOT.joinpath(*package.split("."))


def _file(command: str) -> Path:
    """Return the file of a command; if there is none, a path for which `_is_command` returns False."""
    paths = [_folder(package) / f"{command.replace('-', '_')}.py" for package in PACKAGES]
    return next(filter(_is_command, paths), paths[0])


def _is_command(file: Path) -> bool:
    return file.is_file() and "\n@command(" in file.read_text(encoding="utf-8")


def _about(file: Path) -> tuple[str, str]:
    """Return the section and the summary of the command in a file, for `periph-sim --help`.

    Both are read from the source, because importing the file takes longer. Return ("", "") if the file has no function
    of its own name with the decorator `command` and a literal section.
    """
    import ast

    for node in ast.parse(file.read_text(encoding="utf-8")).body:
        match node:
            case ast.FunctionDef(name=file.stem, decorator_list=[ast.Call(args=[ast.Constant(str(section)), *_]), *_]):
                return section, " ".join((ast.get_docstring(node) or "").partition("\n\n")[0].split())
    return "", ""


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="periph-sim", message=f"%(prog)s, version %(version)s, {form.running}")
def cli() -> None:
    """Run F28335 firmware against SCI and I2C models and check its timing."""


def main() -> NoReturn:
    """Run the command as `periph-sim` does. Launchers that an older version installed call this function."""
    from .supervisor import supervise

    supervise(run_command, "periph-sim")


def run_command() -> None:
    """Run the command that sys.argv names, in this process, and exit with its status."""
    substitute_unencodable()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # OpenBLAS's threads only help with large matrices
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # so that pydantic does not search for plugins
    completing = COMPLETING in os.environ
    if completing:
        from .interfaces.commands.completion import register_shells

        register_shells()
    elif form.note:
        click.echo(form.note, err=True)
    try:
        status = cli.main(standalone_mode=False)
        if status == CLOSED_PIPE:
            _drop_output()
        sys.exit(status if isinstance(status, int) else 0)
    except click.ClickException as error:
        if completing:  # the user is still typing the command line, and a message would be printed into it
            sys.exit(0)
        from io import StringIO

        from .core.phrases import shorten

        said = StringIO()
        error.show(said)
        click.echo(shorten(said.getvalue().rstrip("\n"), LONGEST_MESSAGE), err=True)
        sys.exit(MISTAKE)
    except click.Abort:
        click.echo("stopped", err=True)
        sys.exit(MISTAKE)
    except form.DoesNotLoad as error:
        click.echo(f"Error: {error}", err=True)
        sys.exit(MISTAKE)
    except Exception as error:
        if isinstance(error, OSError) and error.errno in CANNOT_WRITE:
            _drop_output()
            found = f"{error.filename or 'standard output'}: found {os.strerror(error.errno).lower()}"
            click.echo(f"Error: {found}, expected room for the output; make room, or redirect it", err=True)
            sys.exit(MISTAKE)
        if _output_is_gone(error):
            click.echo("Error: standard output is closed, expected a file, a pipe or a terminal", err=True)
            sys.exit(MISTAKE)
        import traceback

        click.echo("periph-sim: internal error; please report it with the command and what follows.", err=True)
        traceback.print_exc()
        sys.exit(FAULT)


def is_closed_pipe(error: OSError) -> bool:
    """Return True if this error means that the program that reads the output has ended.

    On Windows, such an error has the number EINVAL and no file name.
    """
    invalid = os.name == "nt" and error.errno == errno.EINVAL and error.filename is None
    return invalid or isinstance(error, BrokenPipeError)


def _output_is_gone(error: Exception) -> bool:
    """Return True if standard output was missing at the start, or if user code has closed it or its descriptor."""
    closed = sys.stdout is None or sys.stdout.closed
    return closed or (isinstance(error, OSError) and error.errno == errno.EBADF and error.filename is None)


def _drop_output() -> None:
    """Redirect standard output to the null device, because writing its buffer at exit would fail again."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


if __name__ == "__main__":
    main()
