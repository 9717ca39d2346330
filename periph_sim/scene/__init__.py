"""Scenes of cases: a case file is loaded and checked, and its scene is built, run and judged.

    case file --case.load--> Case --> ScenePlan --> Scene --run--> Result

Terms of this package:

case: the description of the parts of a scene, of its run and of its budgets, in a TOML file. [name] is a table in it.
scene: the simulated wires of a case with all parties that are connected to them.
unit: one F28335 with its program.
party: a unit, chip, device, controller, host or other object that drives or reads wires.
chip, device: a sensor chip or another I2C target on the bus.
controller, sensor head: the simulated I2C controller of the table [controller], which makes requests.
host: the simulated PC of the table [host], which sends frames with sensor values to the line RX.
agent: a party that the simulator itself calls at scheduled times, such as the controller and the host.
outside party: another program that drives wires of a scene, or the log of such a program.
option, open question: a behaviour that the manuals leave open, with the answer that a case may choose.
note: an observation for the user, for example that firmware does what a manual forbids, or that data was lost.
model: the sensor models with which some firmware computes the values of chips; or the type of a chip or device.
round: one execution of the requests that a controller repeats periodically.
plan: everything about a part of the scene that depends only on the case, computed once for all scenes of the case.
"""
