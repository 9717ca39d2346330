cimport cython

from .kernel cimport Agent, Kernel, Samples, Settles
from .records cimport Recorder, Topic


@cython.final
cdef class _Told(Agent):
    cdef object _watcher


cdef class Wire(Settles):
    cdef public str name
    cdef public long long level, cause, pulling, attached, version
    cdef public Recorder recorder
    cdef public bint recorded
    cdef public Kernel kernel
    cdef bint _records_holds, _queued, _moved, _pulled
    cdef long long _pulling, _pulling_recorded, _pulled_under, _released_under
    cdef list _parties
    cdef _Watch _watches
    cdef PullWatch _pull_watches
    cdef dict _names_of
    cdef long long _named
    cdef str _names
    cdef public Tape tape
    cpdef void tell_pulls(self, Sampler sampler)
    @cython.locals(last=PullWatch)
    cdef void _add_pull_watch(self, PullWatch watch)
    cpdef void pull(self, long long mask, long long level)
    cdef void _under(self, long long level)
    @cython.locals(look=_Watch, level=cython.longlong, moved=cython.bint)
    cpdef void settle(self)
    @cython.locals(look=_Watch, watch=PullWatch, sampler=Sampler)
    cpdef void hand_on(self, long long now)
    @cython.locals(watch=PullWatch)
    cdef void _tell_pulled(self, PullWatch first)
    cdef void _record_settled(self, bint moved)
    @cython.locals(look=_Watch)
    cpdef void jump(self, long long pulling)
    cpdef bint quiet(self)
    @cython.locals(look=_Watch, watch=PullWatch)
    cpdef list ears(self)
    @cython.locals(last=_Watch)
    cpdef void add(self, Sampler sampler, long long bit)
    @cython.locals(before=_Watch, watch=_Watch)
    cpdef void remove(self, Sampler sampler, long long bit)
    cdef void _changed(self)
    cdef Topic _edges, _holds
    @cython.locals(tape=Tape)
    cdef long long _record(self, Topic topic, long long level, long long cause)
    cdef str _names_for(self, long long pulling)


@cython.final
cdef class Tape:
    cdef public list numbers, again


@cython.final
cdef class PullWatch:
    cdef public Agent agent
    cdef Sampler sampler
    cdef long long line
    cdef public PullWatch following


@cython.final
cdef class _Watch:
    cdef Sampler sampler
    cdef long long bit
    cdef public _Watch following


@cython.final
cdef class Pin:
    cdef public Wire wire
    cdef public long long mask
    cpdef void drive(self, long long level)


@cython.final
cdef class _Line:
    cdef public long long bit
    cdef Wire wire


@cython.final
cdef class Sampler(Samples):
    cdef Kernel _kernel
    cdef Recorder _recorder
    cdef list _lines
    cdef long long _put_under, _seen
    cpdef void listen(self, long long line, Wire wire)
    cpdef void put(self, long long line, long long level)
    cpdef void jump(self, long long bits)
    cpdef void ask(self)
    cdef void hear(self, long long now)
    @cython.locals(moved=cython.longlong)
    cdef void _tell_under_record(self, long long now)
    cdef void _set(self, long long line, long long level)
    @cython.locals(line=_Line)
    cdef long long _moved_under(self, long long moved)
    @cython.locals(line=_Line, wire=Wire)
    cdef _Line _leave(self, long long number)
