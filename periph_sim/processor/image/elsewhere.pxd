cimport cython

from ...f28335.cpu.interrupts cimport CpuInterrupts
from ..firmware_notes cimport FirmwareNotes


cdef class Elsewhere:
    cdef public object changed
    cdef CpuInterrupts _core
    cdef FirmwareNotes _notes
    cdef unsigned short _frames[32768]
    cdef unsigned char _states[32768]
    cdef dict _stored, _stubs
    cdef set _noted
    cdef list _to_come
    cdef tuple _flash
    cpdef void fill(self, long long address, long long value)
    cpdef void answer(self, long long address, long long value)
    cpdef void expect(self, long long address)
    cpdef bint will_answer(self, long long address)
    cpdef object answer_of(self, long long address)
    cpdef long long read(self, long long cycle, long long address)
    cpdef long long peek(self, long long address)
    @cython.locals(known=cython.longlong)
    cpdef bint write(self, long long cycle, long long address, long long value)
    cpdef long long read_waits(self, long long address)
    cpdef tuple fetches(self, long long address)
    cdef tuple _fetches(self, object content)
    cdef tuple _waits(self, object content)
    cdef object _area(self, long long address, str how)
    cdef void _mark(self, long long address, object area)
    cdef void _note(self, long long cycle, long long address, object area)
