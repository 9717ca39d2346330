cimport cython


@cython.final
cdef class SciAutobaud:
    cdef public bint armed
    cdef public long long due, character, nine_bits
    cdef list _edges
    cpdef void arm(self, bint on)
    cpdef void edge(self, long long now, long long level)
    cpdef long long brr(self, long long divider, long long phase, bint nearest)
    cdef void _compare(self, list edges)
