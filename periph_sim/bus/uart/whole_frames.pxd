cimport cython

from ...core.kernel cimport Agent, Kernel
from ...core.records cimport Recorder
from ...core.shortcuts cimport Shortcuts, Untold
from ...core.wire cimport Sampler, Wire


cdef class FrameParty(Agent):
    cpdef bint hears_whole(self, long long first, long long second, long long last)
    cpdef void hears(self, long long tick, long long level)
    cpdef void untold(self, object frames)


cdef class FrameSender(Agent):
    cpdef void take_back(self, list edges)


cdef class WholeFrames(Untold):
    cdef public long long frames, passed
    cdef Kernel _kernel
    cdef Shortcuts _shortcuts
    cdef Wire _wire
    cdef object _may_be, _stand_in
    cdef list _parties, _between
    cdef bint _known
    cdef long long _version, _mask, _phase, _told
    cdef FrameSender _sender
    @cython.locals(party=FrameParty, now=cython.longlong, second=cython.longlong, wire=Wire)
    cpdef bint passes(self, FrameSender sender, long long mask, list between, long long last, long long phase=*)
    cpdef void over(self)
    @cython.locals(party=FrameParty, recorder=Recorder, outer=cython.longlong, count=cython.longlong, now=cython.longlong, tick=cython.longlong)
    cpdef void settle(self)
    @cython.locals(sender=FrameSender)
    cpdef void catch_up(self)
    @cython.locals(party=FrameParty)
    cdef void _end(self)
    cdef void _look(self, long long mask)
    cdef object _party(self, Agent agent)
