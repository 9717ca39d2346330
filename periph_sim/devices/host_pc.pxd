from ..bus.uart.sender cimport UartSender
from ..core.kernel cimport Agent, Kernel


cdef class Host(Agent):
    cdef public str who
    cdef public long long frames, bytes, late
    cdef public list sent
    cdef Kernel _kernel
    cdef UartSender _peer
    cdef object _schedule, _values, _byte_order, _random, _period, _due
    cdef long long _first, _pause, _number, _due_next
    cdef bint _by_schedule, _again
    cdef tuple _sending, _once_more
    cdef void _plan(self, long long due)
    cdef void _begin(self, long long due)
    cdef void _send(self, long long number, tuple values, object data, bint again)
