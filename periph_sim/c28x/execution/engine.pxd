cimport cython

from .registers cimport Cpu, Operation


cdef class Engine(Cpu):
    cdef public long long left
    cdef list _decoded
    cdef unsigned char _code[16384]
    cpdef long long step(self)
    cpdef Operation fetch(self)
    @cython.locals(found=Operation)
    cpdef Operation after(self, Operation f)
    cpdef void begin(self, Operation f)
    cpdef long long finish(self, Operation f)
    cdef long long _pass_done(self, Operation f)
    cpdef void _repeat(self)
    cdef void _at_end_of_block(self, Operation f)
    cpdef Operation _decode(self)
    cpdef void written(self, long long address)
    @cython.locals(found=Operation)
    cdef void _forget(self, long long address)
