cimport cython

from ..bus.receiver_listener cimport ReceiverListener
from ..core.socket cimport Onlooker, Socket
from ..core.time cimport Clock


cdef class SciMonitor(Onlooker):
    cdef public list listeners
    cdef Socket _socket
    cdef Clock _clock
    cdef long long _words, _waiting
    cdef bint _overrun
    @cython.locals(
        fifo=cython.longlong,
        status=cython.longlong,
        words=cython.longlong,
        waiting=cython.longlong,
        overrun=cython.bint,
        lost=cython.bint,
        tick=cython.longlong,
        came=cython.longlong,
        listener=ReceiverListener,
    )
    cpdef void look(self, long long cycle)
