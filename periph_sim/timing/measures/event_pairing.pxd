cimport cython

from .groups cimport Groups
from .measure cimport Measure


cdef class _Seen:
    cdef public long long place, tick, value, counts


cdef class ValueTest:
    cdef public long long mask, want
    cdef public ValueTest others
    @cython.locals(test=ValueTest)
    cpdef bint fits(self, long long value)


cdef class Hearing:
    cdef public long long place
    cdef public ValueTest test, begins, ends
    cdef public Groups groups


cdef class EventMeasure(Measure):
    cdef public object kinds, matchers, spans
    cdef public list seen, _plans, _names
    cdef object _order, _needed, _queue
    cdef set _wanted
    cdef list _groups
    cdef dict _newest
    cdef bint _queued
    cpdef long long tag_of(self, object kind, str where, str what)
    @cython.locals(one=Hearing, plan=list)
    cpdef void hear(self, long long tag, long long tick, long long value)
    cdef void _counts(self, long long place, long long tick, long long value)
    @cython.locals(groups=Groups)
    cdef void _hear_of_group(self, Hearing one, long long tick, long long value)
    @cython.locals(newest=_Seen)
    cdef void _settle(self, long long place, long long counts)
    @cython.locals(seen=_Seen)
    cdef void _drain(self)
    cpdef void happened(self, long long place, long long tick, long long value)
