cimport cython

from ...core.kernel cimport Agent, Event, Kernel, Shortcut
from ...core.wire cimport PullWatch, Sampler, Tape, Wire
from .edge_play cimport Deaf, EdgePlay, SdaFollows


cdef class ByteParty(Agent):
    cpdef long long pulls(self, long long line)
    cpdef bint ready(self, long long low, long long high, long long hold)
    cpdef bint steps(self)
    cpdef long long byte(self)
    cpdef bint goes_on(self, long long shown)
    cpdef void stand(self, long long shown, long long bit, long long fell)
    cpdef SdaFollows meanwhile(self)
    cpdef void edge(self, long long tick, long long levels)
    cpdef bint pulls_sda(self)
    cpdef bint holds(self)
    cpdef void heard(self, long long shown, long long rise, long long low, long long high)


cdef class WholeBytes(Shortcut):
    cdef public long long passed
    cdef Kernel _kernel
    cdef Wire _scl, _sda
    cdef ByteParty _controller
    cdef dict _stand_in
    cdef list _parties
    cdef bint _known
    cdef long long _versions, _since, _fell, _shown, _tag, _low, _high
    cdef Event _eighth
    cdef EdgePlay _play
    cdef Tape _tape
    cdef Deaf _deaf
    cdef list _movers, _samplers, _pull_watches, _told
    cpdef bint passes(self, long long low, long long high, long long hold, long long tag)
    @cython.locals(party=ByteParty, shown=cython.longlong)
    cdef long long _showing(self, long long low, long long high, long long hold)
    @cython.locals(party=ByteParty)
    cpdef void over(self)
    @cython.locals(sampler=Sampler, watch=PullWatch)
    cdef void _begin_play(self, EdgePlay play, long long hold)
    @cython.locals(sampler=Sampler, watch=PullWatch)
    cdef void _end_play(self)
    cdef ByteParty _party(self, Agent agent)
    @cython.locals(mover=SdaFollows)
    cpdef void catch_up(self)
    @cython.locals(party=ByteParty, pulling=cython.longlong)
    cdef void _stand(self, long long bit, long long fell)
    cdef bint _takes(self, ByteParty party)
    cdef void _look(self)
