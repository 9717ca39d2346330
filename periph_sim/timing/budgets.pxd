cimport cython

from .measures.measure cimport Measure


@cython.final
cdef class BudgetJudge:
    cdef public object budget
    cdef public Measure measure
    cdef public BudgetJudge same_as
    cdef public list parts, own_measures
    cdef public str _found
    cdef public dict _given, _limits
    cdef object _timebase, _coverage_of
