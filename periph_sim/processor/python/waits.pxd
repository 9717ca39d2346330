cimport cython

from ...core.options cimport IntOption
from ...core.records cimport Topic
from ...f28335.cpu.interrupts cimport CpuInterrupts
from ..bus cimport Bus
from ..cpu_time cimport CpuTime
from ..operand cimport Operand
from ..polling cimport Lease, Poll, Spin
from .code_records cimport CodeRecords
from .conditions cimport Condition
from .instructions cimport Instructions
from .program cimport PythonProgram
from .recognised cimport Recogniser


@cython.final
cdef class Waits:
    cdef long long _branch
    cdef IntOption _pf2_read_ws
    cdef Bus _bus
    cdef CpuInterrupts _core
    cdef Instructions _instructions
    cdef PythonProgram _program
    cdef Lease _lease
    cdef CodeRecords _records
    cdef bint _branch_listed, _skip_polls
    cdef Recogniser _recogniser
    cdef Spin _spare
    cdef CpuTime _time
    cpdef bint spin(self, object condition, object pass_cycles=*, object timeout=*)
    cpdef bint spin_either(self, object ready, object over, object pass_cycles=*)
    @cython.locals(asked=Condition, asked_else=Condition, waited=Topic)
    cdef long long _wait(self, object ready, object over, object pass_cycles, object timeout)
    @cython.locals(spin=Spin)
    cdef Spin _begun(self, object pass_cycles, long long ends)
    cdef bint _skip(self, Spin spin)
    @cython.locals(place=cython.Py_ssize_t, read=Poll, operand=Operand, start=cython.longlong, cycle=cython.longlong, value=cython.longlong)
    cdef bint _repeats(self, Spin spin)
    cdef bint _passes(self, long long cycle)
