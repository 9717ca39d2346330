from .cpu cimport Cpu


cdef class FirmwareView:
    cdef public object name, memory, control
    cdef public Cpu cpu
    cdef public dict _sockets
    cdef object _end, _random
    cdef dict _ports
    cpdef object _drawn(self, object spread)
    cpdef object _cycles(self, object cost)
    cpdef object _fitting(self, object cycles, object what)
    cpdef object _pass(self, object what, object cycles)
