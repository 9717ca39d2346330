cimport cython


@cython.final
cdef class ValueRange:
    cdef public long long worst, least, count, den, takes_least, takes_most, above, below
    cpdef void clear(self)
    cpdef void take(self, long long value)
    cdef void take_part(self, long long part)
    cdef void take_worst(self, long long value)
    cdef void take_least(self, long long value)
    cdef void take_parts(self, long long most, long long least, long long count)
    cdef void take_all(self, long long most, long long least, long long count)
    cdef bint moved_by(self, long long most, long long least)
    cpdef void take_unfinished(self, long long value)
