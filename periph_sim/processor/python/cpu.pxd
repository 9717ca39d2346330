from ...f28335.cpu.interrupts cimport CpuInterrupts
from ..cpu_time cimport CpuTime
from ..processor cimport Processor
from .accesses cimport Accesses
from .code_records cimport CodeRecords
from .instructions cimport Instructions
from .program cimport PythonProgram
from .waits cimport Waits


cdef class Cpu:
    cdef public Accesses accesses
    cdef public Processor processor
    cdef public PythonProgram program
    cdef public CpuTime time
    cdef CpuInterrupts _core
    cdef Instructions _instructions
    cdef CodeRecords _records
    cdef Waits _waits
    cpdef bint spin(self, object condition, object pass_cycles=*, object timeout=*)
    cpdef bint spin_either(self, object ready, object over, object pass_cycles=*)
    cpdef void compute(self, long long cycles, object name=*)
    cpdef void mark_span(self, str name, long long begins)
    cdef void _tell_and_pass(self, long long cycles)
