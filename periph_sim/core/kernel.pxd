cimport cython


cdef class Agent:
    cpdef void act(self, long long tag)
    cpdef void sampled(self, long long now, long long levels)
    cpdef void pulled(self, long long line, long long now, long long pulling)


@cython.final
cdef class Call(Agent):
    cdef public object action


@cython.final
@cython.freelist(16)
cdef class Event:
    cdef public long long time, phase, rank, tag
    cdef public bint queued, plain
    cdef public Agent agent
    cdef public Event following


cdef class Settles:
    cdef public long long rank
    cdef public Settles following, then
    cpdef void settle(self)
    cpdef void hand_on(self, long long now)


cdef class Samples:
    cdef public long long rank
    cdef public bint plain
    cdef public Agent agent
    cdef public long long due, levels
    cdef public Samples following
    cpdef void tell(self, long long now)


cdef class Shortcut:
    cpdef void catch_up(self)


@cython.final
cdef class Kernel:
    cdef public long long now, events
    cdef public Shortcut shortcut
    cdef public object fault, helper, home
    cdef public bint released
    cdef Event _first, _latest
    cdef Settles _unsettled, _handing_on
    cdef Samples _sampling
    cdef long long _at, _bound, _bound_rank, _horizon, _in_this_tick, _number, _phase, _ranks
    cdef bint _stop, _settling
    cpdef long long rank(self)
    @cython.locals(event=Event)
    cpdef Event at(self, long long time, object action, long long phase=*)
    @cython.locals(event=Event)
    cpdef Event ask(self, long long time, Agent agent, long long tag=*, long long phase=*)
    @cython.locals(event=Event)
    cpdef Event event(self, Agent agent, long long phase=*)
    @cython.locals(first=Event, before=Event, after=Event)
    cpdef void renew(self, Event event, long long time, long long tag)
    cdef void _refuse(self, Event event, long long time)
    @cython.locals(before=Event)
    cpdef void cancel(self, Event event)
    cpdef long long next_time(self)
    @cython.locals(event=Event)
    cpdef long long quiet_until(self)
    cpdef void stop(self)
    @cython.locals(before=Settles, after=Settles)
    cpdef void moved(self, Settles wire)
    @cython.locals(before=Samples, after=Samples)
    cpdef void tell(self, Samples party)
    @cython.locals(wire=Settles, next_wire=Settles, party=Samples, next_party=Samples)
    cpdef void settle(self)
    @cython.locals(wire=Settles)
    cdef void _hand_on(self)
    cdef void _stuck(self, str why)
    cpdef void run_until(self, long long time)
    cpdef bint help(self, object helper)
    @cython.locals(bound=cython.longlong, rank=cython.longlong, at=cython.longlong, in_this_tick=cython.longlong)
    cdef void _do(self, long long time, long long before)
    @cython.locals(event=Event)
    cdef bint _next(self, bint at_home)
    cpdef void catch_up(self)
    @cython.locals(event=Event)
    cpdef void replay(self, long long since, Agent agent, long long tag)
    @cython.locals(event=Event)
    cdef list _taken_out(self)
