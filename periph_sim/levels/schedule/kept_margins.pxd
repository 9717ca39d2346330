cimport cython

from .one_lane cimport Lane
from .value_range cimport ValueRange


@cython.final
cdef class KeptMargins:
    cdef public long long most, least
    cdef public bint alone
    cdef long long _den, _most_let_go, _most_landed, _least_let_go, _least_landed
    cpdef void clear(self, long long den)
    @cython.locals(near=cython.bint)
    cpdef void add(self, long long part, long long let_go, long long landed)
    @cython.locals(most=cython.longlong, least=cython.longlong)
    cpdef void take(self, ValueRange margins, Lane lane, long long start, long long cycle)
