"""The fixtures scene and case_run, the mark `case` and the assertions, as tests of a user's project use them."""

from __future__ import annotations

import pytest

from .project import SMALL

SCENE = """
from periph_sim.records.run import Run
from periph_sim.traces.compliance import check
from periph_sim.traces.decode import i2c

def test_a_run(scene):
    run = scene("timing/small.toml", seconds=0.007)
    assert run.result.simulated_s == 0.007
    assert list(run.budgets) == ["response", "round complete", "wrong bytes"]
    assert run.budgets["response"].count == 2
    assert [bytes(transfer.phases[1].got) for transfer in run.transfers] == [b"\\1\\2"] * 2
    assert [bytes(transfer.phases[1].data) for transfer in i2c.transfers(run.edges())] == [b"\\1\\2"] * 2
    assert run.edges() is run.edges()
    check(run.edges()).assert_compliant()
    run.assert_budgets("response", "wrong bytes")
    run.assert_all()

def test_changes(scene):
    run = scene("timing/small.toml", "controller.request.0.count=1", "controller.request.0.expect=01")
    assert [len(transfer.phases[1].got) for transfer in run.transfers] == [1, 1, 1]

def test_records_and_edges_are_of_one_run(scene):
    kept, repeated = scene("timing/small.toml", record=True), scene("timing/small.toml")
    assert repeated.records is None
    edges = kept.records.rows(where="SCL", what="level")
    assert kept.records.tick[edges].tolist() == kept.edges().channel("SCL").edges.tolist()
    assert repeated.edges().channel("SCL").edges.tolist() == kept.edges().channel("SCL").edges.tolist()
    assert repeated.edges().length == kept.edges().length

def test_records_have_the_clocks_of_the_units(scene):
    run = scene("timing/small.toml", "unit.dsp.pll=8", record=True)
    assert Run(run.records).cycles.how == "SYSCLKOUT 120 MHz"

"""


PYTHON = """
import pytest
from firmware.python import responder

def blinks(dsp, settings):
    while True:
        with dsp.span("work"):
            dsp.compute(settings["cycles"])
        dsp.compute(50)

def test_span(scene):
    budget = {"name": "work", "measure": "span:work", "max": "1 us"}
    run = scene(blinks, modules=["GPIO"], settings={"cycles": 150}, budget=[budget], seconds="50 us")
    assert run.budgets["work"].worst == 1.0
    run.assert_all()

def test_bus(scene):
    request = {"name": "r", "address": 0x50, "pointer": 0, "count": 2, "expect": "01 02"}
    run = scene(responder.main, "controller.period=2 ms", modules=["I2C-A"], settings=responder.Settings(),
                controller={"first": "1 ms", "request": [request]},
                budget=[{"name": "wrong", "measure": "wrong bytes", "max": 0}], duration="6 ms")
    assert len(run.transfers) == 3
    run.assert_budgets("wrong")

seen = []

def test_the_function_runs_once(scene):
    def firmware(dsp, settings):
        seen.append(1)
        with dsp.span("work"):
            dsp.compute(300)
        dsp.module("I2C-A").I2CMDR.IRS = 1
        dsp.spin(lambda: False)
    run = scene(firmware, modules=["I2C-A"], seconds="1 ms",
                budget=[{"name": "work", "measure": "span:work", "max": "1 us"}])
    run.edges()
    with pytest.raises(AssertionError, match="work 2.000 us, limit 1 us"):
        run.assert_budgets("work")
    assert seen == [1]
"""


MARKS = """
import pytest

@pytest.mark.case("small.toml")
class TestAll:
    def test_own(self, case_run):
        assert case_run.budgets["response"].count == 3

    @pytest.mark.case("small.toml", "budget.response.max=1 us", seconds="3 ms")
    def test_nearer(self, case_run):
        assert case_run.budgets["response"].count == 1
        case_run.assert_budgets("round complete")
        case_run.assert_budgets("response", "wrong bytes")

def test_no_mark(case_run):
    pass

@pytest.fixture(scope="module")
def shared(scene):
    return scene("timing/small.toml")

def test_shared_one(shared):
    shared.assert_budgets("response")

def test_shared_two(shared):
    shared.assert_budgets("wrong bytes")
"""


def test_each_test_judges_the_budgets_that_it_asserts(project: pytest.Pytester) -> None:
    (project.path / "timing" / "test_marks.py").write_text(MARKS)
    result = project.runpytest_inprocess("timing/test_marks.py", "--strict-markers")
    result.assert_outcomes(passed=3, failed=1, errors=1)
    result.stdout.fnmatch_lines(
        [
            'fixture case_run: the test has no mark; add @pytest.mark.case("timing/mine.toml")',
            "case_run = <run of small, 0.003 s: fail>",
            ">       case_run.assert_budgets(*",
            "E       AssertionError: small: response * us, limit 1 us",
            "E       SCL *",
            "*test_marks.py:13: AssertionError",
            " case/budget *judged by",
            " small/round complete * seen *timing/test_marks.py::TestAll::test_nearer",
            " small/response * broken *timing/test_marks.py::TestAll::test_nearer",
            " small/wrong bytes * seen *timing/test_marks.py::TestAll::test_nearer",
            " small/response * seen *timing/test_marks.py::test_shared_one",
            " small/wrong bytes * seen *timing/test_marks.py::test_shared_two",
        ]
    )


SMALL_RUN = 'scene("timing/small.toml")'
MISTAKES = {
    f'{SMALL_RUN}.assert_budgets("respons")': "case small has no budget 'respons'; did you mean response?",
    f'{SMALL_RUN}.budgets["wrong"]': "case small has no budget 'wrong'; did you mean wrong bytes?",
    f"{SMALL_RUN}.assert_budgets()": "assert_budgets: give at least one budget; assert_all() judges *",
    f'{SMALL_RUN}.assert_budgets("response", guaranteed=True)': "small: no budget is proven: there is no *",
    f"{SMALL_RUN}.assert_all(guaranteed=True)": "small: no budget is proven: there is no *",
    'scene("timing/smal.toml")': "timing/smal.toml: there is no such case file * did you mean timing/small.toml?",
    'scene("timing/small.toml", "controler.rate=1 kHz")': "*: there is no key 'controler'; did you mean controller?",
    'scene("timing/small.toml", seconds="7")': "seconds='7': *",
    'scene("timing/small.toml", seconds=0)': "seconds=0: expected more than 0",
    'scene("timing/small.toml", modules=["GPIO"])': "*: modules= is for firmware given as a function; *",
    'scene(idle, modules=["GPIO"])': "scene(idle): its duration is missing; give seconds=",
    'scene(idle, modules=["GPOI"], seconds=1)': "scene(idle): *: there is no module 'GPOI'; did you mean GPIO?",
    "scene(idle, hosts={}, seconds=1)": "scene(idle): there is no key 'hosts'; did you mean host?",
    'scene(idle, seconds="1 ms").assert_all()': "case idle has no budgets, so nothing would be judged; add some",
    'scene(idle, seconds="1 ms").transfers': "case idle has no controller; *edges()*",
}


@pytest.mark.parametrize(("call", "message"), MISTAKES.items())
def test_a_wrong_call_is_one_error_message(project: pytest.Pytester, call: str, message: str) -> None:
    project.makepyfile(test_it=f"def idle(dsp, settings):\n    pass\n\ndef test_it(scene):\n    {call}\n")
    result = project.runpytest_inprocess("--tb=short", "test_it.py")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines([f"E   *: {message}".replace("?", "[?]")])
    assert "pytest_plugin/" not in result.stdout.str()


LONG = SMALL.replace("count = 2", "count = 30").replace('expect = "01 02"', f'expect = "{"55 " * 30}"')


def test_a_long_worst_occurrence_is_drawn_whole_and_others_around_their_instant(project: pytest.Pytester) -> None:
    (project.path / "timing" / "small.toml").write_text(LONG)
    project.makepyfile(test_it='def test_it(scene):\n    scene("timing/small.toml").assert_all()\n')
    result = project.runpytest_inprocess("test_it.py")
    result.stdout.fnmatch_lines(
        [
            "E *small: 2 of 3 budgets broken: round complete, wrong bytes",
            "E *first wrong: two bytes read *",
            "E *round complete: worst begins",
            "E *bytes * 0x50*0x50 R 30*",
            "E *v wrong bytes",
            "E *bytes *0x50 R*A*0x01*",
        ]
    )


def test_the_budget_of_an_xfail_test_is_broken_as_expected(project: pytest.Pytester) -> None:
    project.makepyfile(
        test_it="""
        import pytest

        @pytest.mark.xfail(strict=True)
        def test_it(scene):
            scene("timing/small.toml", "budget.response.max=1 us").assert_budgets("response")
        """
    )
    result = project.runpytest_inprocess("test_it.py")
    result.assert_outcomes(xfailed=1)
    result.stdout.fnmatch_lines([" small/response * broken, as expected  test_it.py::test_it"])


PICTURES = """
def said(run):
    try:
        run.assert_all()
    except AssertionError as error:
        return str(error)

def test_it(scene):
    change = "budget.response.max=1 us", "budget.round complete.max=1 us", "start=1 s"
    repeated = said(scene("timing/small.toml", *change))
    kept = said(scene("timing/small.toml", *change, record=True))
    assert repeated == kept and "0x50 R" in kept and "from 0.001290 s on" in kept
"""


LIMITS = """
import pytest

def works(dsp, settings):
    while True:
        with dsp.span("work"):
            dsp.compute(1500)

def test_still(scene):
    budget = {"name": "work", "measure": "span:work", "max": "1 us"}
    with pytest.raises(AssertionError, match="work, 10.000 us at 0.000000 s: no wire moves around it$"):
        scene(works, modules=["I2C-A"], budget=[budget], seconds="1 ms").assert_all()

@pytest.mark.parametrize("record", [False, True])
def test_short(scene, record):
    run = scene("timing/small.toml", "budget.round complete.max=1 us", seconds="1.5 ms", record=record)
    with pytest.raises(AssertionError) as raised:
        run.assert_budgets("round complete")
    numbers = str(raised.value).splitlines()[-2].split()  # the round ends at 480 us, the run at 500
    assert numbers == ["0", "100", "200", "300", "400"]
"""


@pytest.mark.parametrize(("source", "passed"), [(SCENE, 4), (PYTHON, 3), (PICTURES, 1), (LIMITS, 3)])
def test_a_run_gives_figures_waves_and_pictures(project: pytest.Pytester, source: str, passed: int) -> None:
    """Figures and waves of cases and of Python firmware; the picture from a second run and inside a short run."""
    project.makepyfile(test_it=source)
    project.runpytest_inprocess("test_it.py").assert_outcomes(passed=passed)
