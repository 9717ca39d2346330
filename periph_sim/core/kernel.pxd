cimport cython


cdef class Agent:
    cpdef void act(self, long long tag)
    cpdef void sampled(self, long long now, long long levels)
    cpdef void pulled(self, long long line, long long now, long long pulling)


cdef class Call(Agent):
    cdef public object action


@cython.freelist(64)
cdef class Event:
    cdef public long long time, rank, tag
    cdef public Agent agent


cdef class Settles:
    cdef public long long rank
    cpdef void settle(self)


cdef class Samples:
    cdef public long long rank
    cdef public bint due
    cpdef void tell(self, long long now)


cdef class Shortcut:
    cpdef void catch_up(self)


cdef class Kernel:
    cdef public long long now, events
    cdef public Shortcut shortcut
    cdef list _unsettled, _sampling, _queue
    cdef long long _horizon, _number, _ranks
    cdef bint _stop
    cpdef long long rank(self)
    cpdef Event at(self, long long time, object action, long long phase=*)
    @cython.locals(event=Event, other=Event)
    cpdef Event ask(self, long long time, Agent agent, long long tag=*, long long phase=*)
    @cython.locals(other=Event)
    cdef Py_ssize_t _place(self, long long time, long long rank)
    cpdef void cancel(self, Event event)
    @cython.locals(event=Event)
    cpdef long long next_time(self)
    cpdef long long quiet_until(self)
    cpdef void stop(self)
    cpdef void moved(self, Settles wire)
    cpdef void tell(self, Samples party)
    @cython.locals(wire=Settles, party=Samples)
    cpdef void settle(self)
    cpdef void run_until(self, long long time)
    @cython.locals(event=Event)
    cdef void _do(self, long long time)
    cpdef void catch_up(self)
    cpdef void replay(self, long long since, Agent agent, long long tag)
