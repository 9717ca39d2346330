from .registers cimport Cpu, Operation


cdef class Engine(Cpu):
    cdef public long long left
    cdef list _decoded
    cpdef long long step(self)
    cpdef Operation fetch(self)
    cpdef void begin(self, Operation f)
    cpdef long long finish(self, Operation f)
    cdef long long _pass_done(self, Operation f)
    cpdef void _repeat(self)
    cdef void _at_end_of_block(self, Operation f)
    cpdef Operation _decode(self)
    cpdef void written(self, long long address)
