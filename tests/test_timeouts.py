"""A test with an endless loop fails with the place of the loop, and the tests after it run."""

from __future__ import annotations

import pytest

LOOPING = """
    from greenlet import greenlet

    def forever():
        while True:
            pass

    def test_loops():
        {loop}

    def test_after_it():
        pass
"""


@pytest.mark.parametrize("loop", ["forever()", "greenlet(forever).switch()"], ids=["plain", "in a greenlet"])
def test_an_endless_loop_is_ended(pytester: pytest.Pytester, loop: str) -> None:
    pytester.makepyfile(LOOPING.format(loop=loop))
    result = pytester.runpytest_subprocess("-o", "timeout=1", "-o", "timeout_method=signal", "-p", "no:cacheprovider")
    result.assert_outcomes(failed=1, passed=1)
    result.stdout.fnmatch_lines(["*Failed: Timeout*", "*.py:4: Failed"])


def test_the_suite_has_limits(pytestconfig: pytest.Config) -> None:
    assert 60 < float(pytestconfig.getini("faulthandler_timeout")) < float(pytestconfig.getini("timeout")) <= 900
