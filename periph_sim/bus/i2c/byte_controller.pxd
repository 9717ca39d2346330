from .byte_level cimport ByteLevel
from .controller cimport I2cController
from .whole_bytes cimport WholeBytes


cdef class ByteController(I2cController):
    cdef public WholeBytes whole_bytes
    cdef ByteLevel _steps
    cdef bint _in_steps
    cpdef object let_pass(self, WholeBytes whole_bytes)
    cdef void _eighth_over(self)
    cdef void _ninth_over(self)
    cpdef void act(self, long long tag)
    cdef void _release(self)
    cdef void _low(self, long long sda)
    cpdef long long pulls(self, long long line)
    cpdef bint ready(self, long long low, long long high, long long hold, bint each)
    cpdef long long byte(self)
    cpdef bint goes_on(self, long long shown)
    cpdef void stand(self, long long shown, long long bit, long long fell)
    cpdef void edge(self, long long tick, long long levels)
