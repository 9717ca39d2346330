"""Scenes of cases: a case file is loaded and checked, and its scene is built, run and judged.

    case file --case.load--> Case --> ScenePlan --> Scene --run--> Result

Terms of this package:

case: the description of the parts of a scene, of its run and of its budgets, in a TOML file. [name] is a table in the
    file.
scene: the simulated wires of a case with all parties that are connected to them.
unit: one F28335 with its program: Python firmware, C sources or an image.
image: a program that TI's tools have built for the F28335; the simulator executes its instructions.
party: a unit, chip, device, controller, host or other object that drives or reads wires.
chip: a sensor chip on the I2C bus, from a table [chip.NAME]; in `Socket.chip`, a simulated module of the F28335.
device: a target on the I2C bus that is not a sensor chip, such as an EEPROM, from a table [device.NAME].
controller, sensor head: the simulated I2C controller of the table [controller], which makes requests.
master: the party that controls the I2C bus: the [controller], a unit, or an outside party.
request: a write, a read, or both, that a master makes to one chip or device.
phase: the part of an I2C transfer from a START or repeated START to the next one, or to the STOP.
known chip: a sensor chip whose address and data registers the simulator knows: gyroscope, accelerometer, magnetometer,
    or a sensor of a plugin.
host: the simulated PC of the table [host], which sends frames with sensor values to the line RX.
agent: a party that the simulator itself calls at scheduled times, such as the controller and the host.
outside party: another program that drives wires of a scene, or the log of such a program.
session: the run of a scene that an outside party steps and drives (`periph_sim.outside`). Its log can be replayed.
option, open question: a behaviour that the manuals do not define. A case can choose one of its possible answers.
note: an observation for the user, for example that firmware does what a manual forbids, or that data was lost.
model: the type of a chip or device; or, in firmware that emulates sensor chips, the computation of their values.
round: one execution of the requests that a master repeats periodically.
plan: everything about a part of the scene that depends only on the case, computed once for all scenes of the case.
record: a recorded event of a run, with its tick.
budget: a limit on a measured value. `timing` defines further terms of measuring.
span: a part of the firmware with a name, such as a function, whose start and end are recorded.
tick: the unit of simulated time of a scene.
"""
