cimport cython

from ..core.socket cimport Onlooker, Socket
from .cpu_time cimport CpuTime
from .operand cimport Operand


@cython.final
cdef class Poll:
    cdef public Operand operand
    cdef public long long value, before
    cdef public object where


@cython.final
cdef class Spin:
    cdef public long long since, ends, start, held_up, made, live_from
    cdef public object pass_cycles
    cdef public list last, reads
    cdef public bint bare, pure
    cpdef void begin_pass(self, long long cycle)
    @cython.locals(place=cython.Py_ssize_t, read=Poll)
    cpdef void take_length(self, long long cycle)
    @cython.locals(read=Poll)
    cpdef void note(self, Operand operand, long long value, object where)
    @cython.locals(read=Poll)
    cpdef long long answer(self)
    @cython.locals(read=Poll)
    cpdef void answer_before(self, long long cycle)
    cpdef void hold_up(self, long long cycles)
    cpdef long long rest(self, long long cycle, long long branch)
    cpdef void executes_next(self)
    @cython.locals(operand=Operand, value=cython.longlong)
    cpdef bint unchanged(self, long long cycle)
    cpdef str waits_for(self)


@cython.final
cdef class Lease(Onlooker):
    cdef CpuTime _time
    cdef long long _first
    cdef Spin _spin
    cdef list _sockets
    cpdef void take(self, Spin spin)
    @cython.locals(place=cython.Py_ssize_t, read=Poll, operand=Operand, value=cython.longlong)
    cpdef bint broken(self, long long cycle)
    @cython.locals(place=cython.Py_ssize_t, read=Poll, socket=Socket)
    cpdef void begin(self)
    @cython.locals(socket=Socket)
    cpdef void end(self)
