cimport cython


cdef class Option:
    cdef public str name
    cdef object _answer


@cython.final
cdef class TextOption(Option):
    cpdef str assume(self, set touched)
    cpdef str unrecorded(self)


@cython.final
cdef class IntOption(Option):
    cpdef long long assume(self, set touched)
    cpdef long long unrecorded(self)


@cython.final
cdef class BoolOption(Option):
    cpdef bint assume(self, set touched)
    cpdef bint unrecorded(self)
