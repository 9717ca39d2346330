cimport cython

from ..operand cimport Operand
from .accesses cimport Accesses


@cython.final
cdef class Condition:
    cdef Accesses _accesses
    cdef Operand _operand
    cdef long long _mask, _value, _test
    cdef object _where
    cpdef bint holds(self)
