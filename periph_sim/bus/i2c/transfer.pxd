cimport cython


@cython.final
cdef class Phase:
    cdef public long long address, count, start_at, answer_from, answer_at, stretch
    cdef public bint read, acked
    cdef public bytes data
    cdef public object expect, address_byte
    cdef public bytearray got
    cdef public list acks


@cython.final
cdef class Transfer:
    cdef public str name
    cdef public list phases
    cdef public long long stop_at
    cdef public bint lost
    @cython.locals(phase=Phase)
    cpdef bint all_acked(self)
