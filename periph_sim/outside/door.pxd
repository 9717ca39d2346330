cimport cython

from ..core.kernel cimport Agent, Event, Kernel
from ..core.wire cimport Pin, Wire


@cython.final
cdef class Door(Agent):
    cdef Kernel _kernel
    cdef dict _wires, _pins, _put, _levels
    cdef list _names, _changes
    cdef object _told
    cdef Event _event
    cpdef void put(self, long long at, object name, long long level)
    cpdef long long first(self)
    cpdef void plan(self)
    cpdef void withdraw(self)
    @cython.locals(pin=Pin)
    cdef void _drive(self, object name, long long level)
    @cython.locals(wire=Wire, pin=Pin)
    cpdef long long held(self, object name)
    cpdef list changes(self)
