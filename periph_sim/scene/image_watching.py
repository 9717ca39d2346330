"""Observers of a unit's image. An observer is added only if the case needs it:

unit.memory             --> PresetMemory: initial values of variables
budgets, span records   --> FunctionSpans: a span for each function
cpu load, wait records  --> record_waits: the waits, in IDLE or in loops
budgets on variables    --> VariableRecords: the values of variables
budgets on the stack    --> StackDepth: the depth of the stack
"""

from __future__ import annotations

from ..core.records import Kind, Recorder
from ..f28335.memory.ram import MEMORY
from ..processor.dsp import Dsp
from ..processor.image.observers import CPU, SECTION, STACK, FunctionSpans, PresetMemory, StackDepth, VariableRecords
from ..processor.image.program import ImageProgram
from ..processor.image_files.variables import BadVariable, Variables
from .case.model import Case
from .case.unit_table import Unit


def watch_image(case: Case, name: str, unit: Unit, dsp: Dsp, program: ImageProgram, recorder: Recorder) -> None:
    """Add the observers to a program before its first instruction.

    Raise BadCase if the image lacks a variable in `unit.memory` or its value does not fit, or if the image lacks the
    section of the stack that a budget needs.
    """
    if recorder.wants(Kind.SPAN):
        program.add_call_listener(FunctionSpans(recorder, name, program.place_of))
    if recorder.wants(Kind.WAIT):
        program.record_waits(recorder)
    if unit.memory:
        variables, presets = Variables(program.image), []
        for symbol, value in unit.memory.items():
            try:
                variable = variables.find(symbol)
                presets.append((variable, variable.bits_of(value)))
            except BadVariable as error:
                raise case.mistake(str(error), "unit", name, "memory", symbol) from None
        memory = PresetMemory(presets, program.cpu.fill)
        memory.put()
        program.add_call_listener(memory)
    wanted = recorder.named(Kind.FLAG)
    place = f"{name}.{MEMORY}."
    named = sorted(subject.removeprefix(place) for subject in wanted if subject.startswith(place))
    if named:
        variables = Variables(program.image)
        ram = dsp.processor.bus.ram
        found = map(variables.find, named)
        program.cpu.watched = records = VariableRecords(found, ram, recorder, dsp.clock, name, program.place)
        if unit.memory:
            program.add_call_listener(records)
    if f"{name}.{CPU}.{STACK}" in wanted:
        stacks = [section for section in program.image.sections if section.name == SECTION]
        if not stacks:
            what = f"a budget on its stack needs a section {SECTION}, which it has not"
            raise case.mistake(what, "unit", name, "image")
        program.watch_instructions(StackDepth(stacks[0], recorder, dsp.clock, name, program.place))


def variable_value(dsp: Dsp, name: str) -> int:
    """Return the present value of a variable. A budget must name this variable, so that it is observed."""
    assert isinstance(dsp.program, ImageProgram) and dsp.program.cpu.watched is not None
    return dsp.program.cpu.watched.values[name]
