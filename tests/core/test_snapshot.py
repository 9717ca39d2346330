"""Snapshots of declared state, and restoring them into other objects."""

from __future__ import annotations

import ast
from array import array
from collections import deque
from collections.abc import Callable, Iterable
from functools import cache, partial
from importlib import import_module
from pathlib import Path
from random import Random
from typing import Any, NamedTuple

import pytest

import periph_sim
from periph_sim.core.chip import NEVER
from periph_sim.core.restore import NotRestorable, restore
from periph_sim.core.snapshot import (
    Absent,
    Fixed,
    Foreign,
    Found,
    FunctionRef,
    Keyed,
    Made,
    Module,
    PlainContainer,
    Ref,
    Snapshot,
    take_snapshot,
)
from periph_sim.core.state import State, Time, state_of

PACKAGE = Path(periph_sim.__file__).parent
HERE = __name__


class Item:
    STATE = State("value", ticks="at", made=True)

    def __init__(self, value: object, at: int = -1) -> None:
        self.value = value
        self.at = at
        self.following: Item | None = None


class Pair(NamedTuple):
    first: object
    second: object


class Owner:
    STATE = State("held call", ticks="due", cycles="since", records="cause", chains="first")

    def __init__(self) -> None:
        self.held: Any = None
        self.call: Callable[..., object] = print
        self.due: Any = 0
        self.since: Any = 0
        self.cause = 0
        self.first: Item | None = None
        self.wiring = object()
        self.derived = 0

    def called(self) -> None: ...

    def restored(self) -> None:
        self.derived = self.due


class Derived(Owner):
    STATE = State("more")

    def __init__(self) -> None:
        super().__init__()
        self.more = 0


class Silent:
    """Declares no state."""


def taken(owner: object, **more: object) -> Snapshot:
    modules = {"one": Module(owner, 70), **{name: Module(other, 70) for name, other in more.items()}}
    return take_snapshot(modules, 1000, 50, ())


def moved(snapshot: Snapshot, target: object, **more: object) -> None:
    modules = {"one": Module(target, 0), **{name: Module(other) for name, other in more.items()}}
    restore(snapshot, modules)


def through(held: object) -> tuple[object, Any]:
    """Return a held value as stored in a snapshot, and the value that another owner has after restoring it."""
    owner, other = Owner(), Owner()
    owner.held = held
    snapshot = taken(owner)
    moved(snapshot, other)
    return snapshot.values["one.held"], other.held


def test_the_state_of_a_class_includes_that_of_its_bases():
    state = state_of(Derived)
    assert state is not None and not state.made
    assert state.times["due"] is Time.TICKS and state.times["more"] is Time.NONE and state.chains == {"first"}
    assert state_of(Silent) is None


def test_instants_are_stored_relative_to_now():
    owner = Owner()
    owner.due, owner.since, owner.cause = 1010, [65, 90], 48
    values = taken(owner).values
    assert (values["one.due"], values["one.since"], values["one.cause"]) == (10, PlainContainer("list", (-5, 20)), -2)


def test_values_that_stand_for_no_instant_are_stored_unchanged():
    for due in (NEVER, -NEVER, -1, None):
        owner = Owner()
        owner.due = due
        assert taken(owner).values["one.due"] == Fixed(due)
    assert taken(Owner()).values["one.cause"] == Fixed(0)
    assert taken(Owner()).values["one.due"] == -1000


def test_the_first_integer_of_a_tuple_is_its_instant():
    owner, other = Owner(), Owner()
    owner.due = [("A", 1200, 7), ("B", NEVER, 8)]
    snapshot = taken(owner)
    assert snapshot.values["one.due"] == PlainContainer("list", (("A", 200, 7), ("B", Fixed(NEVER), 8)))
    moved(snapshot._replace(tick=3000), other)
    assert other.due == [("A", 3200, 7), ("B", NEVER, 8)]


def test_instants_are_restored_for_another_time():
    owner, other = Owner(), Owner()
    owner.due, owner.since, owner.cause = 1010, 65, 48
    moved(taken(owner)._replace(tick=5000, number=0, cycles={"one": 700}), other)
    assert (other.due, other.since, other.cause, other.derived) == (5010, 695, -2, 5010)


@pytest.mark.parametrize(
    "held",
    [
        [1, 2], (3, "x"), deque([1]), {2, 1}, frozenset({5}), {"a": 1}, bytearray(b"x"), b"y", array("h", [4]), 2.5,
        Time.TICKS, Pair(1, 2), {(1, 2): [3]}, [[], [1]],
    ],
)  # fmt: skip
def test_containers_of_values_are_restored(held: object):
    _, came = through(held)
    assert came == held and type(came) is type(held)


def test_a_random_generator_continues_its_sequence():
    held = Random(3)
    held.random()
    _, came = through(held)
    assert came is not held and came.random() == held.random()


def test_an_object_with_a_complete_state_is_created_again():
    value, came = through(Item([1], 1500))
    assert value == Made(f"{HERE}.Item") and (came.value, came.at) == ([1], 1500)


def test_restoring_an_existing_object_keeps_its_undeclared_attributes():
    owner, other = Owner(), Owner()
    owner.held, other.held = Owner(), Owner()
    owner.held.due = 7
    kept, wiring = other.held, other.held.wiring
    moved(taken(owner), other)
    assert other.held is kept and kept.wiring is wiring and kept.due == 7


def test_one_object_in_two_places_is_restored_as_one_object():
    shared = Item(1)
    value, came = through(Pair(shared, [shared]))
    assert came.first is came.second[0] and came.first is not shared and isinstance(value, Made)


def test_an_object_of_a_module_is_a_reference_to_it():
    owner, other, part, its_part = Owner(), Owner(), Owner(), Owner()
    owner.held = part
    snapshot = taken(owner, part=part)
    assert snapshot.values["one.held"] == Ref("part")
    moved(snapshot, other, part=its_part)
    assert other.held is its_part


def test_methods_and_functions_are_restored_by_name():
    owner, other = Owner(), Owner()
    owner.held = partial(owner.called, 1, word=2)
    snapshot = taken(owner)
    assert snapshot.values["one.held['func']"] == Ref("one", "called")
    assert snapshot.values["one.call"] == FunctionRef("print")
    moved(snapshot, other)
    assert (other.held.func, other.held.args, other.held.keywords) == (other.called, (1,), {"word": 2})


def test_the_owner_of_a_method_is_stored_under_the_name_of_the_method():
    owner, other, part, its_part = Owner(), Owner(), Owner(), Owner()
    owner.call, other.call = part.called, its_part.called
    part.due = 1234
    snapshot = taken(owner)
    assert snapshot.values["one.call.owner.due"] == 234
    moved(snapshot, other)
    assert other.call == its_part.called and its_part.due == 1234


def test_a_chain_is_restored_in_its_order():
    owner, other = Owner(), Owner()
    owner.first, owner.first.following = Item("a"), Item("b")  # type: ignore[union-attr]
    other.first = Item("c")
    snapshot = taken(owner)
    assert snapshot.values["one.first"] == Made("chain", (0, 1)) and snapshot.values["one.first[1].value"] == "b"
    moved(snapshot, other)
    assert other.first.value == "a" and other.first.following is not None
    assert other.first.following.value == "b" and other.first.following.following is None


def test_an_object_with_state_inside_a_chain_is_stored_as_foreign():
    owner = Owner()
    owner.first = Item(Owner())
    assert taken(owner).values["one.first[0].value"] == Foreign(f"{HERE}.Owner")
    owner.first = Item(Owner().called)
    assert taken(owner).values["one.first[0].value"] == Foreign("Owner.called")


def test_an_object_of_a_keyed_class_is_restored_by_its_key():
    owner, other, silent = Owner(), Owner(), Silent()
    owner.held = silent
    keys = {Silent: Keyed(lambda found: (1, "x"), lambda number, text: (text, number))}
    snapshot = take_snapshot({"one": Module(owner, keys=keys)}, 0, 0, ())
    assert snapshot.values["one.held"] == Found(f"{HERE}.Silent", (1, "x"))
    restore(snapshot, {"one": Module(other, keys=keys)})
    assert other.held == ("x", 1)


@pytest.mark.parametrize("held", [Silent(), {Silent(): 1}, [Silent()], (lambda x: lambda: x)(1)])
def test_an_object_without_declared_state_is_refused_with_its_name(held: object):
    owner, other = Owner(), Owner()
    owner.held, owner.due, other.held = held, 5, "as it was"
    with pytest.raises(NotRestorable, match=r"^one\.held.* declares no state, so it cannot be restored$"):
        moved(taken(owner), other)
    assert (other.held, other.due, other.derived) == ("as it was", 0, 0)


def test_an_object_that_cannot_be_created_is_refused_and_nothing_is_restored():
    owner, other = Owner(), Owner()
    owner.held, owner.due = Owner(), 5
    with pytest.raises(NotRestorable, match=f"one.held is a {HERE}.Owner in the snapshot, and the scene has none"):
        moved(taken(owner), other)
    assert other.due == 0


def test_other_modules_and_other_classes_are_refused():
    snapshot = taken(Owner(), part=Owner())
    with pytest.raises(NotRestorable, match="only one of the snapshot and the scene has part"):
        moved(snapshot, Owner())
    with pytest.raises(NotRestorable, match=r"one is a .*Owner in the snapshot and a .*Derived in the scene"):
        moved(taken(Owner()), Derived())
    other = Owner()
    other.call = len
    with pytest.raises(NotRestorable, match=r"one\.call is the function print, which the scene does not have"):
        moved(taken(Owner()), other)


def test_differences_name_the_values_that_differ():
    one, other = Owner(), Owner()
    one.held, other.held = [1, 2, 3], [1, 5, 3]
    one.due = 9
    del other.since
    assert taken(one).differences(taken(other)) == {
        "one.held[1]": (2, 5),
        "one.due": (-991, -1000),
        "one.since": (-70, Absent()),
    }
    other.held = [1]
    assert taken(one).differences(taken(other))["one.held"] == (
        PlainContainer("list", (1, 2, 3)),
        PlainContainer("list", (1,)),
    )
    assert taken(one).differences(taken(one)) == {}


def tree_of(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def literals(values: Iterable[ast.expr]) -> list[Any]:
    return [ast.literal_eval(value) for value in values]


def declared() -> list[tuple[str, ast.ClassDef, frozenset[str]]]:
    """Return each class of the package that declares a state: its file, source, and the names it lists."""
    found = []
    for path in sorted(PACKAGE.rglob("*.py")):
        for node in tree_of(path).body if "STATE = " in path.read_text(encoding="utf-8") else ():
            if not isinstance(node, ast.ClassDef):
                continue
            for one in node.body:
                if not isinstance(one, ast.Assign) or ast.unparse(one.targets[0]) != "STATE":
                    continue
                if isinstance(one.value, ast.Call):
                    values = [*one.value.args, *(word.value for word in one.value.keywords if word.arg != "made")]
                    texts = [
                        " ".join([*one, *one.values()]) if isinstance(one, dict) else one for one in literals(values)
                    ]
                    names = frozenset(name for text in texts for name in text.split())
                    found.append((str(path.relative_to(PACKAGE)), node, names))
    return found


def test_each_declared_attribute_is_one_of_its_class():
    """A declared name that no object has would silently be missing from every snapshot."""
    classes = declared()
    assert len(classes) > 120
    wrong: list[str] = []
    for file, node, names in classes:
        module = import_module(f"periph_sim.{file.removesuffix('.py').removesuffix('/__init__').replace('/', '.')}")
        kind = getattr(module, node.name)
        whole = state_of(kind)
        assert whole is not None
        wrong += [
            f"{file}: {node.name}: {name} is no state" for name in {*whole.results, *whole.expires} - {*whole.times}
        ]
        if not kind.__dictoffset__:  # compiled, or with slots: attributes that Python cannot reach are missing
            wrong += [f"{file}: {node.name} declares {name}" for name in names if not hasattr(kind, name)]
        bases = {base.__module__ for base in kind.__mro__ if base.__module__.partition(".")[0] == PACKAGE.name}
        files = {*(PACKAGE / file).parent.glob("*.py"), *map(file_of, bases)}
        known = set().union(*map(assigned_names, files))
        wrong += [f"{file}: {node.name} declares {name}" for name in sorted(names - known)]
    assert wrong == []


def file_of(module: str) -> Path:
    path = PACKAGE.joinpath(*module.split(".")[1:])
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


@cache
def assigned_names(path: Path) -> set[str]:
    """Return the names that a module assigns to `self`, or annotates in a class."""
    found = set()
    for node in ast.walk(tree_of(path)):
        if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            found.add(node.attr)
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            found.add(node.target.id)
    return found
