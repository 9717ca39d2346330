cimport cython

from ...core.records cimport Recorder, Topic
from ...core.time cimport Clock
from ..polling cimport Poll, Spin
from .program cimport PythonProgram


@cython.final
cdef class Waited:
    cdef list polls
    cdef Topic topic
    cdef public Waited following
    @cython.locals(place=cython.Py_ssize_t, read=Poll)
    cdef bint polled_by(self, Spin spin)


@cython.final
cdef class CodeRecords:
    cdef public bint kept, spans, waits
    cdef Clock _clock
    cdef object _name
    cdef PythonProgram _program
    cdef Recorder _recorder
    cdef Waited _waited
    cpdef void span(self, long long cycle, object name, long long begins)
    cpdef void wait(self, long long cycle, object what, long long begins)
    @cython.locals(waited=Waited)
    cpdef Topic waited_for(self, Spin spin)
    cpdef void tell(self, Topic topic, long long cycle, long long begins)
