cimport cython

from .registers cimport I2cRegisters


@cython.final
cdef class I2cAddress:
    cdef public bint read, selected
    cdef I2cRegisters _state
    cdef long long _latched
    cpdef void latch(self)
    cpdef void start(self)
    cpdef bint is_ours(self, long long byte, bint second)
    cpdef bint is_answered_by_master(self, long long byte, bint second)
    cpdef bint is_whole(self, long long byte, bint second)
