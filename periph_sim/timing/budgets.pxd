cimport cython

from .measures.measure cimport Measure


@cython.final
cdef class BudgetJudge:
    cdef public object budget
    cdef public Measure measure
    cdef public BudgetJudge same_as
    cdef public list joined, own_measures
    cdef public str _found
    cdef public dict _given, _limits
    cdef object _timebase, _coverage_of
    @cython.locals(measure=Measure)
    cpdef object _judge(self, object start)
    cdef bint _can_judge(self, str which, object limit)
    cdef bint _measured_enough(self)
    cdef object _beside(self, str which, object limit)
    cpdef object show(self, object value)
