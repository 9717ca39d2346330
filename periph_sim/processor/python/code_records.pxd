cimport cython

from ...core.records cimport Recorder, Topic
from ...core.time cimport Clock
from .program cimport PythonProgram


cdef class CodeRecords:
    cdef public bint spans, waits
    cdef Clock _clock
    cdef object _name
    cdef PythonProgram _program
    cdef Recorder _recorder
    cpdef void span(self, long long cycle, object name, long long begins)
    cpdef void wait(self, long long cycle, object what, long long begins)
    @cython.locals(topic=Topic)
    cdef void _emit(self, object kind, long long cycle, object what, long long begins)
