from .cpu cimport Cpu


cdef class ModulePort:
    cdef Cpu _cpu
    cdef object _place
    cdef dict _made
    cdef dict __dict__
