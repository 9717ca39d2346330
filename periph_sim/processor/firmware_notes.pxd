cimport cython

from ..core.kernel cimport Kernel
from ..core.records cimport Recorder
from ..core.time cimport Clock


@cython.final
cdef class FirmwareNotes:
    cdef public dict counts, first_at, places
    cdef public bint strict, placed
    cdef Clock _clock
    cdef Kernel _kernel
    cdef object _name, _place
    cdef Recorder _recorder
    cpdef void take(self, long long cycle, list notes)
    cpdef void note(self, long long cycle, object note)
    cpdef void insist(self, object note, object who)
    cdef void _insist(self, object note, object who, long long tick)
