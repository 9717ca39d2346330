cimport cython

from ...c28x.execution.registers cimport Cpu, Operation
from ...c28x.fetch_queue cimport FetchQueue
from ...c28x.pipeline cimport Pipeline
from ...core.options cimport BoolOption
from ...f28335.cpu.interrupts cimport CpuInterrupts
from .elsewhere cimport Elsewhere


@cython.final
cdef class InstructionTiming:
    cdef public Pipeline pipeline
    cdef public long long late
    cdef CpuInterrupts _core
    cdef public FetchQueue queue
    cdef object _options
    cdef Elsewhere _elsewhere
    cdef public bint conflicts
    cdef BoolOption _shared
    cdef long long _ahead
    cpdef void drain(self)
    cpdef void prepare(self, Operation f)
    @cython.locals(waits=cython.longlong, more=cython.longlong)
    cpdef long long stall(self, Operation f, Cpu cpu, long long cycle)
    @cython.locals(waits=cython.longlong)
    cpdef void wait_for_word(self, long long address, long long words)
    cpdef void conflict(self)
    cpdef long long landing(self, Operation f)
    cpdef long long read(self, long long code, long long address, long long cycle, long long waits)
    cpdef long long repeats(self, long long count)
    @cython.locals(bits=cython.longlong, first=cython.longlong, later=cython.longlong)
    cdef long long _fetch(self, Operation f, long long cycle)
