"""None as an argument of a public method raises an exception or has no effect, compiled or interpreted.

The public methods of all compiled classes are called in one process. If one crashes, the last line of the output is
that call.
"""

from __future__ import annotations

import subprocess
import sys

import pytest

from periph_sim import form
from periph_sim.core.agent import Agent
from periph_sim.core.kernel import Kernel
from periph_sim.form.sources import Sources

MODULES = Sources(form.PACKAGE).compiled()

CALL = """
import inspect, sys
from importlib import import_module
from periph_sim.form import PACKAGE
from periph_sim.form.sources import UNCHECKED, Sources

MOST = 9  # arguments

def attempt(text, call, *given):
    print(text, flush=True)
    try:
        call(*given)
    except Exception:
        pass  # the other tests of this file name the exception

def objects_of(kind):
    if sources[kind.__module__.removeprefix("periph_sim.")].header != UNCHECKED:
        yield kind.__new__(kind)
    for count in range(MOST):
        try:
            yield kind(*[None] * count)
        except Exception:
            pass

sources = Sources(PACKAGE)
for name in sys.argv[1:]:
    module = import_module(f"periph_sim.{name}")
    for kind in [getattr(module, found) for found in sources[name].classes]:
        for one in objects_of(kind):
            for attribute in dir(kind):
                if attribute.startswith("__"):
                    continue
                if not callable(inspect.getattr_static(kind, attribute)):
                    attempt(f"{name}.{kind.__name__}.{attribute} = None", setattr, one, attribute, None)
                    continue
                for first in ((), (1,)):
                    for count in range(MOST):
                        text = f"{name}.{kind.__name__}.{attribute}{(*first, *[None] * count)}"
                        attempt(text, getattr(one, attribute), *first, *[None] * count)
print("alive")
"""


def test_no_call_with_none_ends_the_process():
    done = subprocess.run([sys.executable, "-c", CALL, *MODULES], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout.splitlines()[-1]) == (0, "alive"), done.stderr[-2000:]
    assert done.stdout.count("\n") > 1000


@pytest.mark.parametrize(
    "call",
    [
        lambda kernel: kernel.schedule(5, None),
        lambda kernel: kernel.reschedule(kernel.event(None), 5, 0),
        lambda kernel: kernel.reschedule(None, 5, 0),
        lambda kernel: kernel.cancel(None),
        lambda kernel: kernel.moved(None),
        lambda kernel: kernel.request_sample(None),
        lambda kernel: kernel.replay(0, None, 0),
        lambda kernel: setattr(kernel.schedule(5, Agent()), "agent", None),
    ],
    ids=["schedule", "event", "reschedule", "cancel", "moved", "request_sample", "replay", "agent"],
)
def test_none_instead_of_an_event_agent_or_party_raises_an_exception_by_the_time_it_is_due(call):
    kernel = Kernel()
    with pytest.raises((TypeError, AttributeError)):
        call(kernel)
        kernel.run_until(10)
