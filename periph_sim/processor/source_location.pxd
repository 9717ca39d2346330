cimport cython


@cython.final
cdef class SourceLocator:
    cdef dict _known, _places
    cdef list _codes
    cpdef object of_frame(self, object frame)
    cdef dict _of_code(self, object code)
