cimport cython

from .kernel cimport Shortcut


cdef class Shortcuts(Shortcut):
    cdef public list under_way
    @cython.locals(shortcut=Shortcut)
    cpdef void catch_up(self)


cdef class Untold(Shortcut):
    cpdef void settle(self)
