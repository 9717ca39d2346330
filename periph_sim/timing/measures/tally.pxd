cimport cython


@cython.final
cdef class Cell:
    cdef public long long count, value, at


@cython.final
cdef class Tally:
    cdef dict _cells
    cdef long long _most, _shift
    @cython.locals(cell=Cell)
    cpdef void add(self, long long value, long long at)
