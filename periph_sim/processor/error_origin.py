"""Origin of exceptions: the statement of the firmware that caused one, if any."""

from __future__ import annotations

from collections.abc import Callable
from inspect import (
    CO_ASYNC_GENERATOR,
    CO_COROUTINE,
    CO_GENERATOR,
    isasyncgenfunction,
    iscoroutinefunction,
    isgeneratorfunction,
    signature,
)
from pathlib import Path
from types import CodeType, FunctionType

from .source_location import is_firmware, is_helper, is_ours
from .stall_watch import NoProgress

FIRMWARE_VIEW = (
    str(Path("processor", "python", "register_view.py")),
    str(Path("processor", "python", "firmware_view.py")),
)  # these reject wrong names


class FirmwareError(Exception):
    """Firmware that cannot continue: it raised, or it violated a rule of a scene with `strict`."""


class Misuse(FirmwareError):
    """A call or a value that the DSP's interface rejects. Reported with the firmware's statement."""


class FirmwareStalled(FirmwareError):
    """Firmware that let no simulated time pass for too long. The run fails; it is no mistake in the use of the tool."""


class FirmwareLost(FirmwareStalled):
    """Compiled code that cannot continue, as at an illegal instruction. The run fails there."""


class InterruptFault(FirmwareError):
    """An interrupt whose context or vector is outside of memory."""


def flaw_of(function: Callable[..., object], arguments: int) -> str:
    """Return, as a clause, why a function cannot be firmware with this number of arguments; empty if it can."""
    plain = getattr(function, "__func__", function)
    if _takes(plain, arguments + (plain is not function)):
        return ""
    if iscoroutinefunction(plain):
        return "is async"
    if isgeneratorfunction(plain) or isasyncgenfunction(plain):
        return "is a generator (it has a yield), so calling it runs nothing"
    try:
        signature(function).bind(*[None] * arguments)
    except TypeError:
        return f"takes {signature(function)}"
    except ValueError:  # a builtin without a signature
        return ""
    return ""


RUNS_NOTHING = CO_COROUTINE | CO_GENERATOR | CO_ASYNC_GENERATOR  # a call of such a function executes none of its code


def _takes(function: object, arguments: int) -> bool:
    """Return True for an ordinary function, checked by its code alone; a signature takes 30 times as long."""
    if type(function) is not FunctionType or function.__dict__:  # attributes set by a decorator
        return False
    code = function.__code__
    least = code.co_argcount - len(function.__defaults__ or ())
    return least <= arguments <= code.co_argcount and not (code.co_kwonlyargcount or code.co_flags & RUNS_NOTHING)


def defined_at(function: object) -> str:
    """Return the place of a definition, "line 3 of blink.py"; empty if the function is not written in Python."""
    code = getattr(function, "__code__", None)
    return f"line {code.co_firstlineno} of {Path(code.co_filename).name}" if isinstance(code, CodeType) else ""


def raised_at(error: BaseException) -> str:
    """Return the origin of an exception in the firmware, "line 7 of blink.py"; empty if the fault is our own."""
    place = ""
    ours = False
    refused = isinstance(error, Misuse | NoProgress)  # raised by us, about the firmware
    step = error.__traceback__
    while step is not None:
        code = step.tb_frame.f_code
        ours = is_ours(code.co_filename) and not code.co_filename.endswith(FIRMWARE_VIEW)
        if is_firmware(code.co_filename) and not (place and is_helper(code.co_filename)):  # its caller is to blame
            place = f"line {step.tb_lineno} of {Path(code.co_filename).name}"
        step = step.tb_next
    return "" if ours and not refused else place
