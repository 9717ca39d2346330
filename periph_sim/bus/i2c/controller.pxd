cimport cython

from ...core.kernel cimport Event, Kernel
from ...core.records cimport Recorder, Topic
from ...core.wire cimport Sampler, Wire
from .transfer cimport Phase, Transfer
from .whole_bytes cimport ByteParty


cdef class I2cController(ByteParty):
    cdef public str who
    cdef public object timing
    cdef public bint busy
    cdef Kernel _kernel
    cdef Recorder _recorder
    cdef public bint beside_others
    cdef Wire _scl_wire, _sda_wire
    cdef Sampler _sampler
    cdef Event _next, _guard
    cdef object _on_stuck, _done, _clear
    cdef Transfer _transfer
    cdef Phase _phase
    cdef list _acks
    cdef dict _topics
    cdef bytearray _got
    cdef long long _low_time, _hold, _filter, _scl_mask, _sda_mask, _stuck_after, _sda_level, _high, _high_end
    cdef long long _let_go_at, _last_stop, _phase_index, _byte, _bit, _in, _index, _scl_moved, _clear_after
    cdef long long _refused_since, _lines, _scl_seen, _sda_moved, _sda_event, _sda_seen, _stretch, _wanted
    cdef bint _rising, _receiving, _bus_busy, _gives_up
    cpdef object begin(self, object transfer, object done)
    cpdef long long bytes_under_way(self)
    cdef void _start(self)
    cdef bint _may_start(self, long long now)
    cdef bint _may_clear(self, long long now)
    @cython.locals(event=cython.longlong, before=cython.longlong, stretch=cython.longlong)
    cpdef void sampled(self, long long now, long long levels)
    cdef long long _unspoilt(self, long long now, long long event)
    cdef void _settle(self, long long now)
    cdef long long _sda(self)
    cdef void _then(self, long long time, long long tag)
    cdef void _load(self, long long byte, long long index, bint receiving)
    cdef void _low(self, long long sda)
    cdef void _set_sda(self, long long level)
    cdef void _release(self)
    cdef void _rose(self, long long now)
    cdef void _bit_end(self)
    cdef long long _ack_level(self)
    cdef void _byte_end(self, bint ack)
    cdef void _stop(self)
    cdef void _lose(self)
    cdef void _finish(self)
    cdef void _watch_stuck(self)
    cdef void _calm(self)
    cdef void _stuck(self)
    @cython.locals(topic=Topic)
    cdef void _mark(self, str what, long long value)
