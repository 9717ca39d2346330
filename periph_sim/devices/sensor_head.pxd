from ..bus.i2c.controller cimport I2cController
from ..core.kernel cimport Agent, Kernel


cdef class SensorHead(Agent):
    cdef public str who
    cdef public I2cController controller
    cdef public long long missed, rounds
    cdef public list on_transfer, on_round, on_due, on_missed
    cdef public object schedule
    cdef Kernel _kernel
    cdef object _requests, _startup, _random, _period, _round
    cdef list _left
    cdef bint _by_stop
    cdef long long _first, _number, _due
    cdef void _plan(self)
    cdef void _set_up(self)
    cdef void _begin(self, long long due)
    cdef void _next(self)
