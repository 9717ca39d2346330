"""Scenes of cases: a case file is loaded and checked, and its scene is built, run and judged.

    case file --case.load--> Case --> ScenePlan --> Scene --run--> Result

Terms of this package:

case: the description of the parts of a scene, of its run and of its budgets, in a TOML file.
scene: the simulated wires of a case with all parties that are connected to them.
unit: one F28335 with its program.
party: a unit, chip, device, controller, host or other object that drives or reads wires.
outside party: another program that drives wires of a scene, or the log of such a program.
round: one execution of the requests that a controller repeats periodically.
plan: everything about a part of the scene that depends only on the case, computed once for all scenes of the case.
"""
