cimport cython

from .kernel cimport Shortcut


cdef class Shortcuts(Shortcut):
    cdef Shortcut _first
    cdef list _others
    cpdef void begin(self, Shortcut shortcut)
    cpdef bint passes(self, Shortcut shortcut)
    cpdef void end(self, Shortcut shortcut)
    @cython.locals(shortcut=Shortcut)
    cpdef void catch_up(self)


cdef class Untold(Shortcut):
    cpdef void settle(self)
