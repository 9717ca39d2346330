cimport cython

from .registers cimport I2cRegisters


@cython.final
cdef class I2cLimits:
    cdef public object sysclk_hz
    cdef I2cRegisters _state
    cdef long long _clock_within_tm
    cdef object _clock_within_hz
    cdef tuple _within
    cpdef void enabled(self)
    @cython.locals(tm=cython.longlong)
    cpdef void module_clock(self)
    cpdef void own_address(self)
    cpdef void sent_address(self)
    cdef void _address(self, str name, long long value)
    cpdef void scl(self, long long low, long long high)
    cpdef void start_commanded(self, bint bus_busy)
    cpdef bint written_while_enabled(self, str name)
    cpdef void divisor(self, str name, long long value)
    cpdef void fifo_enables(self)
    cpdef void loopback(self, bint begins)
