cimport cython

from ...core.records cimport Recorder, Topic
from ...core.time cimport Clock
from ..polling cimport Spin
from .program cimport PythonProgram


cdef class CodeRecords:
    cdef public bint kept, spans, waits
    cdef Clock _clock
    cdef object _name
    cdef PythonProgram _program
    cdef Recorder _recorder
    cdef dict _waited_for
    cpdef void span(self, long long cycle, object name, long long begins)
    cpdef void wait(self, long long cycle, object what, long long begins)
    @cython.locals(topic=Topic, polls=tuple)
    cpdef Topic waited_for(self, Spin spin)
    cpdef void tell(self, Topic topic, long long cycle, long long begins)
