cimport cython

from ..core.kernel cimport Agent, Kernel
from ..core.records cimport Recorder
from .bus cimport Bus
from .cpu_time cimport CpuTime
from .firmware_notes cimport FirmwareNotes
from .interrupts cimport Interrupts
from .program cimport Program


@cython.final
cdef class Processor(Agent):
    cdef public str name
    cdef public Kernel kernel
    cdef public object stopped
    cdef public CpuTime time
    cdef public FirmwareNotes notes
    cdef public Bus bus
    cdef public Interrupts interrupts
    cdef Recorder _recorder
    cdef Program _program
    cdef long long _cause, _goal, _outer, _under_way, _vector
    cpdef void start(self, Program program, long long delay=*)
    cpdef void kill(self, object how)
    cdef void _forget(self)
    cpdef object stands_at(self)
    cpdef object _place(self)
    cpdef void stops(self, object why)
    cpdef bint reach(self, long long cycle)
    cpdef bint rest(self, long long cycle)
    cpdef long long next_output(self, long long cycle)
    cpdef bint take(self, long long number)
    cpdef bint iret(self)
    cdef bint _go_on(self)
