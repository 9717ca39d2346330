cimport cython

from ..core.kernel cimport Agent, Kernel
from ..core.records cimport Recorder
from ..core.socket cimport Socket
from ..core.time cimport Clock
from ..core.wire cimport Pin, Sampler, Wire
from ..f28335.gpio.module cimport Gpio


cdef class Router(Agent):
    cdef Kernel _kernel
    cdef Clock _clock
    cdef Recorder _recorder
    cdef Gpio _gpio
    cdef Socket _gpio_socket, _xint
    cdef Sampler _pads
    cdef dict _wires, _undriven, _inputs, _outputs, _pins, _let_go, _feeds, _line
    cdef set _straight, _heard
    cdef object _unheard, _xint_chip
    cdef long long _between_at, _routes, _outs, _lines
    @cython.locals(begin=cython.longlong)
    cpdef void sampled(self, long long tick, long long levels)
    @cython.locals(socket=Socket, index=cython.longlong)
    cdef void _reroute(self, long long cycle)
    @cython.locals(socket=Socket, index=cython.longlong)
    cdef void _reconnect(self)
    @cython.locals(socket=Socket, index=cython.longlong)
    cpdef object _between(self)
    cdef void _plan_between(self, long long begin)
    @cython.locals(levels=object, n=object)
    cdef object _levels_of(self, long long lines)
    cdef object _tell(self, long long cycle, object levels, bint exact=*)
    @cython.locals(levels=object, n=object, wire=Wire)
    cdef object _levels_on_wires(self)
    @cython.locals(n=object, pin=Pin)
    cdef void _drive(self)
    @cython.locals(n=object)
    cpdef bint only_shows(self, object pads)
    cpdef void moved(self, long long tick, object pads, long long level)
