cimport cython

from .whole_bytes cimport ByteParty, WholeBytes


cdef class ByteLevel(WholeBytes):
    cdef long long _acks
    cdef bint _takes(self, ByteParty party)
    @cython.locals(shown=cython.longlong, now=cython.longlong)
    cpdef bint passes(self, long long low, long long high, long long hold, long long tag)
    @cython.locals(party=ByteParty, shown=cython.longlong, now=cython.longlong, last=cython.longlong, clock=cython.longlong)
    cpdef long long eighth(self, long long ack)
    @cython.locals(now=cython.longlong, clock=cython.longlong, pulls=cython.longlong)
    cpdef long long ninth(self)
    cpdef void follows(self, long long level)
    @cython.locals(party=ByteParty, pulling=cython.longlong)
    cdef long long _sda_pulls(self, long long controller)
    @cython.locals(party=ByteParty, levels=cython.longlong)
    cdef void _edge(self, long long tick, long long scl, long long sda)
