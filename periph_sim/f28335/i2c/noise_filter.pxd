cimport cython

from ...core.options cimport BoolOption


@cython.final
cdef class I2cNoiseFilter:
    cdef public long long levels, due
    cdef BoolOption unequal_arrival
    cdef set _touched
    cdef long long _scl_due, _sda_due, _cycle, _scl_was, _sda_was
    cpdef void sample(self, long long now, long long pins, long long width, long long module_clock)
    cdef void _arrive_apart(self, long long later)
    cpdef long long take(self, long long now)
    cpdef bint scl_moves(self)
    cpdef long long sign_due(self, long long silent)
    cpdef void settle(self, long long pins)
