cimport cython


@cython.final
cdef class Input:
    cdef public long long cycle, cause
    cdef public Input following
    cdef bint comes_before(self, Input other)
