cimport cython

from ...bus.receiver_listener cimport ReceiverListener
from .measure cimport Measure


cdef class OfCharacters(Measure):
    cdef long long _received
    cpdef void received(self, long long tick)
    cpdef void changed(self, long long tick, long long words, bint overrun)


@cython.final
cdef class _ReceiverForwarder(ReceiverListener):
    cdef OfCharacters _measure
    cdef bint _only_losses


cdef class FifoHighWater(OfCharacters):
    cpdef void changed(self, long long tick, long long words, bint overrun)
