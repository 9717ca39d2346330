cimport cython


@cython.final
cdef class I2cNoiseFilter:
    cdef public long long levels, due
    cdef bint together
    cdef set _touched
    cdef long long _scl_due, _sda_due, _cycle, _scl_was, _sda_was
    cpdef void sample(self, long long now, long long pins, long long width, long long module_clock)
    cpdef long long take(self, long long now)
    cpdef bint scl_moves(self)
    cpdef long long sign_due(self, long long silent)
    cpdef void settle(self, long long pins)
