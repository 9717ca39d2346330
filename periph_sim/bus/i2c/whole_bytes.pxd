cimport cython

from ...core.kernel cimport Agent, Event, Kernel, Shortcut
from ...core.records cimport Recorder
from ...core.shortcuts cimport Shortcuts
from ...core.wire cimport PullWatch, Sampler, Tape, Wire
from .bit_times cimport BitTimes
from .edge_play cimport Deaf, EdgePlay, SdaFollows


cdef class ByteParty(Agent):
    cpdef long long pulls(self, long long line)
    cpdef bint ready(self, long long low, long long high, long long hold, bint each)
    cpdef long long follow_at(self, long long fall)
    cpdef bint apart(self, long long fall, long long moved)
    cpdef bint steps(self)
    cpdef long long byte(self)
    cpdef bint goes_on(self, long long shown)
    cpdef void stand(self, long long shown, long long bit, long long fell)
    cpdef SdaFollows meanwhile(self)
    cpdef void edge(self, long long tick, long long levels)
    cpdef bint pulls_sda(self)
    cpdef bint holds(self)
    cpdef void heard(self, long long shown, BitTimes times)


cdef class WholeBytes(Shortcut):
    cdef public long long passed
    cdef Kernel _kernel
    cdef Shortcuts _shortcuts
    cdef Wire _scl, _sda
    cdef ByteParty _controller
    cdef dict _stand_in
    cdef list _parties
    cdef bint _known
    cdef long long _versions, _since, _fell, _shown, _tag, _ends
    cdef BitTimes _times, _steady
    cdef Event _eighth
    cdef EdgePlay _play
    cdef Tape _tape
    cdef Deaf _deaf
    cdef list _movers, _samplers, _pull_watches, _told
    @cython.locals(now=cython.longlong, shown=cython.longlong, controller=ByteParty, times=BitTimes)
    cpdef bint passes(self, long long low, long long high, long long hold, long long tag)
    @cython.locals(low=cython.longlong, high=cython.longlong, shown=cython.longlong)
    cdef bint pass_of(self, ByteParty party, BitTimes times, long long fell, long long ends, EdgePlay play)
    cdef void _begin(self, BitTimes times, long long shown, long long fell, long long tag)
    @cython.locals(sampler=Sampler, watch=PullWatch)
    cdef void _deafen(self)
    @cython.locals(party=ByteParty, shown=cython.longlong)
    cdef long long _showing(self, ByteParty controller, long long low, long long high, long long hold, bint each)
    @cython.locals(sender=ByteParty, party=ByteParty, byte=cython.longlong, number=cython.longlong, fall=cython.longlong, moved=cython.longlong)
    cdef bint _apart(self, BitTimes times)
    @cython.locals(party=ByteParty)
    cpdef void over(self)
    @cython.locals(sampler=Sampler, watch=PullWatch)
    cdef void _end_play(self)
    cdef ByteParty _party(self, Agent agent)
    @cython.locals(mover=SdaFollows, controller=ByteParty)
    cpdef void catch_up(self)
    @cython.locals(party=ByteParty, pulling=cython.longlong)
    cdef void _stand(self, long long bit, long long fell)
    @cython.locals(recorder=Recorder, outer=cython.longlong)
    cdef void _replay(self, ByteParty controller)
    cdef bint _takes(self, ByteParty party)
    cdef void _look(self)
