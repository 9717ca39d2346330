cimport cython

from ...core.kernel cimport Kernel
from ..processor cimport Processor
from ..program cimport Program
from ..source_location cimport SourceLocator


@cython.final
cdef class PythonProgram(Program):
    cdef public object name, entered, placed
    cdef public dict handlers
    cdef public double stall_limit
    cdef public object thread
    cdef Kernel _kernel
    cdef Processor _processor
    cdef dict _code
    cdef SourceLocator _places
    cdef object _greenlet, _watched
    cdef list _leftovers
    cdef list _stops
    cdef object __weakref__
    cdef object _switch(self)
    @cython.locals(goes_on=cython.bint)
    cpdef object give_way(self, object why=*)
    cdef object _home(self)
    cdef object _goes_on(self)
    cdef object _waits(self)
    cdef object _end(self)
    cpdef tuple instant(self)
    cpdef void _land(self)
    cpdef void handle(self, object vector, object routine)
    cpdef void routine(self, long long address, object routine)
