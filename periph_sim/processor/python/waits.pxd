from ...f28335.cpu.interrupts cimport CpuInterrupts
from ..cpu_time cimport CpuTime
from ..polling cimport Lease, Spin
from .code_records cimport CodeRecords
from .instructions cimport Instructions
from .program cimport PythonProgram


cdef class Waits:
    cdef long long _branch
    cdef CpuInterrupts _core
    cdef Instructions _instructions
    cdef PythonProgram _program
    cdef CodeRecords _records
    cdef bint _skip_polls
    cdef CpuTime _time
    cpdef bint spin(self, object condition, object pass_cycles=*, object timeout=*)
    cdef void _skip(self, Spin spin)
