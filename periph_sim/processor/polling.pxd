cimport cython

from ..core.socket cimport Onlooker, Socket
from .cpu_time cimport CpuTime
from .operand cimport Operand


cdef class Spin:
    cdef public long long since, ends, start, held_up, replayed, live_from
    cdef public object pass_cycles
    cdef public list polls, values, replay
    cdef public bint bare, pure
    cpdef void begin_pass(self, long long cycle)
    @cython.locals(operand=Operand)
    cpdef void take_length(self, long long cycle)
    cpdef void answer_before(self, long long cycle)
    cpdef void hold_up(self, long long cycles)
    cpdef long long rest(self, long long cycle, long long branch)
    cpdef str waits_for(self)


cdef class Lease(Onlooker):
    cdef CpuTime _time
    cdef long long _first
    cdef list _polls, _values, _sockets
    @cython.locals(operand=Operand)
    cpdef void take(self, Spin spin)
    @cython.locals(operand=Operand, place=cython.Py_ssize_t, seen=cython.longlong, value=cython.longlong)
    cpdef bint broken(self, long long cycle)
    @cython.locals(socket=Socket)
    cpdef void begin(self)
    @cython.locals(socket=Socket)
    cpdef void end(self)
    cpdef void look(self, long long cycle)
