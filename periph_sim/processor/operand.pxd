cimport cython

from ..core.chip cimport Chip
from ..core.records cimport Topic
from ..core.socket cimport Socket


@cython.final
cdef class Operand:
    cdef public object field, place, register
    cdef public Socket socket
    cdef public Chip chip
    cdef public str name, named
    cdef public Topic reads, writes
    cdef public long long address, lsb, mask, offset, read_waits, shift, words, write_waits
    cdef public bint block, frame1, frame2, harmless, looks, meets, pieack, placed, protected, recorded, steady
    cpdef void record(self, Topic reads, Topic writes)
    cpdef bint tells_place(self)
    cpdef long long see(self, long long cycle)
