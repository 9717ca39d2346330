cimport cython

from ..core.kernel cimport Agent, Event, Kernel
from ..core.socket cimport Socket
from ..core.time cimport Clock
from ..core.wire cimport Wire
from ..f28335.i2c.module cimport I2c
from ..processor.processor cimport Processor


@cython.final
cdef class Reaction(Agent):
    cdef bint _others, _at_once, _fresh
    cdef Kernel _kernel
    cdef Event _mark
    cdef list _wires, _direct, _routers, _listening, _modules, _pins, _widest_of, _hz
    cdef public list _put
    cdef long long _version, _now, _due, _silent, _widest, _scl_moved, _scl_done
    cdef dict _clocks, _cpu_clocks, _chips, _levels, _seen
    cdef object _scl, _sda
    cpdef void put(self, long long tick, object line, long long level)
    cpdef void advanced(self, long long now)
    cpdef long long due(self)
    cdef void _look(self)
    @cython.locals(done=cython.longlong, tick=cython.longlong, level=cython.longlong)
    cdef void _pass(self, long long most)
    @cython.locals(tick=cython.longlong, level=cython.longlong)
    cdef void _weigh_all(self)
    @cython.locals(version=cython.longlong, wire=Wire)
    cdef void _listeners(self)
    cdef void _lines(self)
    @cython.locals(event=Event, due=cython.longlong)
    cdef long long _first_event(self)
    cdef Event _events(self)
    @cython.locals(event=Event)
    cdef bint _routes(self)
    @cython.locals(agent=Agent, socket=Socket, processor=Processor, chips=list, chip=I2c, clock=Clock)
    cdef long long _effect(self, Event event)
    @cython.locals(before=cython.longlong)
    cdef void _weigh(self, long long tick, object line, long long level)
    @cython.locals(first=cython.longlong, socket=Socket, chip=I2c, clock=Clock)
    cdef long long _answer(self, long long tick)
