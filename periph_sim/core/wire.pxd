cimport cython

from .kernel cimport Agent, Kernel, Samples, Settles
from .records cimport Recorder, Topic


cdef class _Told(Agent):
    cdef object _watcher


cdef class Wire(Settles):
    cdef public str name
    cdef public long long level, cause, pulling, attached, version
    cdef public Recorder recorder
    cdef public bint recorded
    cdef public Kernel kernel
    cdef bint _records_holds, _queued
    cdef long long _pulling, _pulling_recorded, _pulled_under, _released_under
    cdef list _parties, _watches, _pull_watches
    cdef dict _names_of
    cdef public Tape tape
    cpdef void pull(self, long long mask, long long level)
    @cython.locals(watch=PullWatch, look=_Watch)
    cpdef void settle(self)
    @cython.locals(watch=_Watch)
    cpdef void jump(self, long long pulling)
    cpdef bint quiet(self)
    cdef void _changed(self)
    cdef Topic _edges, _holds
    @cython.locals(tape=Tape)
    cdef long long _record(self, Topic topic, long long level, long long cause)


cdef class Tape:
    cdef public list numbers, again


cdef class PullWatch:
    cdef public Agent agent
    cdef public long long line


cdef class _Watch:
    cdef public Sampler sampler
    cdef public long long bit


cdef class Pin:
    cdef public Wire wire
    cdef public long long mask
    cpdef void drive(self, long long level)


cdef class Sampler(Samples):
    cdef public long long levels
    cdef Kernel _kernel
    cdef Recorder _recorder
    cdef public Agent agent
    cdef bint _under
    cdef dict _wires
    cdef long long _put_under, _seen
    cpdef void listen(self, long long line, Wire wire)
    cpdef void put(self, long long line, long long level)
    cpdef void jump(self, long long bits)
    cpdef void ask(self)
    @cython.locals(wire=Wire, moved=cython.longlong)
    cpdef void tell(self, long long now)
    cdef void _set(self, long long line, long long level)
    cdef void _leave(self, long long line)
