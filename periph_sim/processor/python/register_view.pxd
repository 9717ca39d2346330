cimport cython

from .cpu cimport Cpu
from .port_fields cimport Registers


@cython.final
cdef class ModulePort(Registers):
    cdef Cpu _cpu
    cdef object _place
    cdef dict _made
    cdef dict __dict__
