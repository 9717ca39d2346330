cimport cython

from ...c28x.execution.engine cimport Engine
from ...c28x.execution.fpu_pipeline cimport arrive, delay
from ...c28x.execution.registers cimport Cpu, Operation
from ...f28335.cpu.interrupts cimport CpuInterrupts
from ...f28335.system.ram cimport Ram
from ...c28x.fetch_queue cimport FetchQueue
from ...c28x.pipeline cimport Pipeline
from ..bus cimport Bus
from ..cpu_time cimport CpuTime
from ..operand cimport Operand
from ..processor cimport Processor
from .elsewhere cimport Elsewhere
from .instruction_timing cimport InstructionTiming
from .polls cimport Polls

cdef bint in_plain_ram(long long address) noexcept


@cython.final
cdef class ImageCpu(Engine):
    cdef public bint ended, returning, idling
    cdef CpuInterrupts _core
    cdef Processor _processor
    cdef CpuTime _time
    cdef Bus _bus
    cdef Ram _ram
    cdef public Elsewhere elsewhere
    cdef public object watched, reads_unwritten
    cdef unsigned char _written[65536]
    cdef long long _packed[61]
    cdef long long _kept[61]
    cdef public InstructionTiming timing
    cdef public Polls polls
    cdef Pipeline _pipeline
    cdef bint _decoding, _delays
    cdef object _options
    cdef long long _tested
    @cython.locals(place=cython.longlong, same=cython.bint)
    cpdef bint is_as_before(self)
    @cython.locals(n=cython.longlong, place=cython.longlong, pipeline=Pipeline, queue=FetchQueue)
    cdef void _pack(self)
    cpdef void reset(self)
    cpdef void fill(self, long long address, long long value)
    @cython.locals(bus=Bus, operand=Operand, cycle=cython.longlong, polls=Polls, value=cython.longlong)
    cdef long long _load(self, long long address, long long width)
    @cython.locals(value=cython.longlong)
    cdef long long _load_elsewhere(self, long long address, long long width)
    cdef void _store(self, long long address, long long value, long long width)
    cdef long long _even(self, long long address, str how)
    cdef void _unwritten(self, long long address)
    cdef void _keep(self, long long address, long long value)
    cpdef long long access_at(self, Operation f, long long cycle)
    cdef long long _access_at(self, long long cycle, long long address, bint reads, bint wide)
    cpdef void hand_over(self)
    cpdef list context(self)
    cpdef void begin_routine(self, long long address)
    cpdef void restore(self, list words)
