cimport cython

from .conditions cimport Condition
from .program cimport PythonProgram


@cython.final
cdef class Question:
    cdef object code, field, number, register, where
    cdef bint known
    cdef Py_ssize_t place
    cdef long long test
    cdef object module
    cdef Condition condition
    cdef object take_apart(self, PythonProgram program)
    cdef Condition about(self, object module)


@cython.final
cdef class Recogniser:
    cdef dict _questions
    cdef PythonProgram _program
    cdef Question _latest, _earlier
    @cython.locals(question=Question)
    cpdef Condition condition(self, object function)
