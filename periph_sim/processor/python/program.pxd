from ..processor cimport Processor
from ..program cimport Program


cdef class PythonProgram(Program):
    cdef public object name, entered
    cdef public dict handlers
    cdef public double stall_limit
    cdef public object thread
    cdef Processor _processor
    cdef dict _code
    cdef object _places, _greenlet, _hub
    cdef object __weakref__
    cpdef object run(self, long long until)
    cpdef object give_way(self, object why=*)
    cpdef void kill(self, object how)
    cpdef tuple instant(self)
    cpdef void _land(self)
    cpdef object place(self)
    cpdef void handle(self, object vector, object routine)
    cpdef object enter(self, long long vector)
