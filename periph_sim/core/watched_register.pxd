cimport cython

from .records cimport Topic


@cython.final
cdef class WatchedField:
    cdef public long long mask, lsb
    cdef public Topic topic


@cython.final
cdef class WatchedRegister:
    cdef public long long offset, upper, value, was, data
    cdef public list fields
