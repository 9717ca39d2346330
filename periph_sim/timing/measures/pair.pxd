cimport cython

from .event_pairing cimport EventMeasure
from .groups cimport Groups


@cython.final
cdef class Open:
    cdef public long long at, since
    cdef public Open following


cdef class Between(EventMeasure):
    cdef public str asked, pairing
    cdef Groups _rule
    cdef str _rule_text
    cdef object _again
    cdef Open _waiting, _last, _spare
    cdef bint _stopped, _begun, _paired, _unsaid, _only_last, _in_order
    cdef long long _extra, _begun_at, _groups_paired, _began_at, _per_second, _now
    cpdef long long clock(self, long long tick)
    cpdef void happened(self, long long place, long long tick, long long value)
    cpdef void between(self)
    cdef void _started(self, long long tick)
    cdef void _group_over(self)
    @cython.locals(one=Open)
    cdef void _first(self, long long tick)
    @cython.locals(one=Open, now=cython.longlong)
    cdef void _second(self, long long tick)
    @cython.locals(following=Open)
    cdef Open _ended(self, Open one)
    @cython.locals(one=Open)
    cdef void _clear(self)


cdef class CountBetween(Between):
    cdef long long _counted
    cpdef long long clock(self, long long tick)
    cpdef void between(self)
