cimport cython

from ..core.records cimport Recorder
from ..core.time cimport Clock
from ..f28335.cpu.interrupts cimport CpuInterrupts
from ..f28335.cpu.pie cimport Pie
from ..f28335.system.ram cimport Ram
from .cpu_time cimport CpuTime
from .firmware_notes cimport FirmwareNotes


@cython.final
cdef class Interrupts:
    cdef public CpuInterrupts core
    cdef public str taken
    cdef list _causes
    cdef Clock _clock
    cdef object _name
    cdef FirmwareNotes _notes
    cdef long long _number
    cdef Pie _pie
    cdef Ram _ram
    cdef Recorder _recorder
    cdef bint _records_irq
    cdef CpuTime _time
    cpdef void request(self, long long cycle, long long number)
    cpdef long long due(self, long long cycle)
    cpdef void take(self, long long cycle, long long number, object context)
    cpdef long long fetch(self, long long cycle)
    cpdef void entered(self, long long cycle, object where)
    cpdef list iret(self, long long cycle)
    cpdef void returned(self, long long cycle)
    cpdef void forget(self)
    cpdef void take_notes(self, long long cycle)
    cdef long long _frame(self, long long cycle, long long sp)
