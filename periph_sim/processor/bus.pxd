cimport cython

from ..core.options cimport IntOption
from ..core.records cimport Recorder
from ..core.time cimport Clock
from ..f28335.cpu.interrupts cimport CpuInterrupts
from ..f28335.system.ram cimport Ram
from .cpu_time cimport CpuTime
from .firmware_notes cimport FirmwareNotes
from .operand cimport Operand


@cython.final
@cython.freelist(4)
cdef class Posted:
    cdef long long lands, value, cause
    cdef Operand operand
    cdef object where
    cdef public Posted following


@cython.final
cdef class Bus:
    cdef public long long free_from
    cdef public dict free_of
    cdef public object issued_at, map
    cdef public Ram ram
    cdef Clock _clock
    cdef CpuInterrupts _core
    cdef FirmwareNotes _notes
    cdef Recorder _recorder
    cdef CpuTime _time
    cdef object _name, _place, _subjects, _waits
    cdef bint _read_listed, _records_access, _write_listed
    cdef dict _named
    cdef list _words, _pairs
    cdef Operand _nothing
    cdef Posted _posted, _posted_last
    cdef IntOption _write_lands, _pf1_back_to_back_write, _pf2_read_ws, _pf2_write_ws
    cdef long long _last_pf1_write
    cpdef Operand operand(self, object place, object register, long long words, object field=*)
    @cython.locals(found=Operand)
    cpdef Operand find(self, long long address, long long width)
    @cython.locals(found=Operand)
    cdef Operand _looked_up(self, long long address, long long width)
    cpdef Operand at(self, long long address, long long width)
    cpdef Operand naming(self, Operand operand, long long mask)
    cdef bint _wanted(self, object register)
    cpdef long long reads_at(self, long long cycle, long long address, long long width=*)
    cpdef long long writes_at(self, long long cycle, long long address, long long width=*)
    cpdef long long read(self, long long at, long long address, long long width=*)
    cpdef void write(self, long long at, long long address, long long value, long long width=*)
    cpdef long long load(self, long long at, Operand operand, long long width)
    cpdef void save(self, long long at, Operand operand, long long value, long long width)
    cpdef void note_width(self, long long cycle, Operand operand)
    cpdef long long read_waits(self, Operand operand)
    cpdef long long free(self, Operand operand)
    cpdef long long fetches_at(self, long long cycle, Operand operand)
    cpdef long long fetch(self, long long at, Operand operand)
    cpdef void tell_look(self, long long at, Operand operand, long long value, object where)
    cdef long long _recorded(self, long long at, Operand operand, object where)
    cdef long long _read(self, long long at, Operand operand)
    cpdef long long posts_at(self, long long cycle, Operand operand)
    cpdef void store(self, long long at, Operand operand, long long value)
    cpdef void modify(self, long long at, Operand operand, long long number)
    cdef bint _wants_place(self, Operand operand)
    @cython.locals(posted=Posted)
    cdef void _post(self, long long at, Operand operand, long long value, object where)
    cdef void _ignored(self, long long cycle, str what)
    @cython.locals(first=Posted, after=Posted)
    cpdef void land(self)
    cpdef void forget(self)
    cdef void _met(self, long long at)
