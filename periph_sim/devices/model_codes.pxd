cimport cython


@cython.final
cdef class Shown:
    cdef public object state
    cdef ModelCodes _codes
    cdef tuple _inputs
    cdef dict _data
    cpdef bytes data(self, long long address)
    cdef bytes _made(self, long long address)


@cython.final
cdef class ModelCodes:
    cdef public Shown at_rest
    cdef object _model, _a, _noise
    cdef bint _warns
    cpdef Shown run(self, long long number, tuple values, Shown before)
    cdef object of_chip(self, str name, tuple inputs)
    cdef object _quietly(self, object computed, tuple inputs)


cpdef bytes register_bytes(object chip, tuple xyz)
