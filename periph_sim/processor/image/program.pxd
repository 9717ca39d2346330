cimport cython

from ...c28x.execution.registers cimport Operation
from ...f28335.cpu.interrupts cimport CpuInterrupts
from ...c28x.pipeline cimport Pipeline
from ..cpu_time cimport CpuTime
from ..processor cimport Processor
from ..program cimport Program
from .cpu cimport ImageCpu
from .instruction_timing cimport InstructionTiming
from .polls cimport Polls


cdef class ImageProgram(Program):
    cdef public ImageCpu cpu
    cdef public object image
    cdef public long long instructions
    cdef Processor _processor
    cdef Operation _ready
    cdef bint _executed, _idle_began, _looks
    cdef long long _back, _counted, _pass
    cdef long long _jumps[8]
    cdef long long _jumped
    cdef object _clock, _functions, _calls, _waits, _watch, _counting, _unmodelled
    cdef bint _sleeps(self)
    cdef void _keep_unmodelled(self, long long since)
    cdef object _sleeps_counting(self)
    cdef void _follow_wait(self)
    cdef void _woken(self, long long cycle)
    cdef dict _places
    cdef long long _at, _entry, _asleep_at, _stack_begin, _stack_end, _sp
    cdef set _unwritten
    cpdef void load(self)
    cpdef void begin(self)
    @cython.locals(cpu=ImageCpu, time=CpuTime, processor=Processor, core=CpuInterrupts, f=Operation, cycle=cython.longlong,
                   cycles=cython.longlong, at=cython.longlong, timing=InstructionTiming, pipeline=Pipeline, polls=Polls)
    cdef object _run(self)
    cdef bint _slept(self)
    cdef void _left_stack(self, Operation f)
    cdef object _ended(self)
