cimport cython

from ..bus cimport Bus
from ..cpu_time cimport CpuTime
from ..firmware_notes cimport FirmwareNotes
from ..operand cimport Operand
from ..polling cimport Spin
from .instructions cimport Instructions
from .program cimport PythonProgram


@cython.final
cdef class Accesses:
    cdef long long _between
    cdef Bus _bus
    cdef Instructions _instructions
    cdef PythonProgram _program
    cdef CpuTime _time
    cdef FirmwareNotes _notes
    cdef long long _reads, _reads_from
    cdef set _polling_places
    cpdef long long read(self, Operand operand, object where=*)
    cpdef void write(self, Operand operand, long long value)
    cpdef void modify(self, Operand operand, long long number)
    cpdef long long load(self, long long address, long long width=*)
    cpdef void store(self, long long address, long long value, long long width=*)
    cdef void _refuse(self, Operand operand)
    cdef void _look_for_polling(self)
    cdef long long _fetch(self, Operand operand)
    cdef void _wait_for_writes(self, Operand operand, Spin spin)
    cdef void _before_write(self)
