"""Reports of runs: baselines, JUnit XML, annotations, HTML pages, sweeps, profiles, and speed against accuracy."""

from ...core.kernel import SimulationStuck
from ...f28335.memory.memory_map import NoSuchAddress
from ...processor.user_code import FirmwareError
from ...scene.case.model import BadCase

REFUSED = (BadCase, SimulationStuck, NoSuchAddress, FirmwareError)  # errors that are raised if a case cannot be run
