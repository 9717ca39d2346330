cimport cython

from ...f28335.cpu.interrupts cimport CpuInterrupts
from ..cpu_time cimport CpuTime
from ..processor cimport Processor
from .program cimport PythonProgram


@cython.final
cdef class Instructions:
    cdef public long long busy_cycles
    cdef long long _prologue, _epilogue
    cdef CpuInterrupts _core
    cdef Processor _processor
    cdef PythonProgram _program
    cdef CpuTime _time
    cpdef void instruction(self, long long cycles)
    cpdef void go_to(self, long long cycle)
    cpdef void run(self, long long cycles)
    cpdef void idle(self)
    cpdef void after_main(self)
    cdef void _rest_until(self, long long cycle)
    cpdef void serve(self)
    cdef void _call_routine(self, long long number)
