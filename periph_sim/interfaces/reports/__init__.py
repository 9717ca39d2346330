"""Reports of runs: baselines with JUnit XML and annotations, HTML pages, sweeps, profiles and trades."""

from ...core.kernel import SimulationStuck
from ...f28335.memory.memory_map import NoSuchAddress
from ...processor.user_code import FirmwareError
from ...scene.case.model import BadCase

REFUSED = (BadCase, SimulationStuck, NoSuchAddress, FirmwareError)  # errors that are raised if a case cannot be run
