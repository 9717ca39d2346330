cimport cython

from ..bus cimport Bus
from ..operand cimport Operand
from .accesses cimport Accesses


cdef class Registers:
    pass


cdef class Port:
    cdef Accesses _accesses
    cdef Bus _bus
    cdef object _place
    cdef dict _fields
    cdef list _operands
    cdef Port _half
    @cython.locals(field=PortField)
    cdef object _assign(self, object name, object value)


@cython.final
cdef class PortField:
    cdef public Py_ssize_t number
    cdef long long _lsb, _mask, _words
    cdef object _most, _register, _field
    cdef str _where
    @cython.locals(operand=Operand)
    cdef long long _read(self, Port port)
    @cython.locals(operand=Operand)
    cpdef void assign(self, Port port, object value)
    cpdef object condition(self, Port port, object number)
    cpdef object in_place(self, object number)
    @cython.locals(operand=Operand)
    cpdef object asked(self, Port port, object number, long long test, object where)
    cpdef object masked(self, Port port, object mask, object value)
    cdef object _whole(self, object what, object value, object most)
    cdef Operand _operand(self, Port port)
    cdef object _fitting(self, object value)
