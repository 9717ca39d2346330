cimport cython

from .kept cimport Kept, Memory
from .one_lane cimport Lane, Piece
from .one_read cimport OneRead
from .value_range cimport ValueRange


@cython.final
cdef class OneScenario:
    cdef Lane _lane
    cdef Piece _start
    cdef list _ranges, _reads
    cdef ValueRange _response, _round, _slack, _age, _margin, _model, _asked, _cleared
    cdef object _late
    cdef long long[::1] _costs, _begins
    cdef bint _drawn_costs, _drawn_begins, _refused, _unheard
    cdef Memory _memory
    cdef long long _poll, _length, _low, _first_again, _last_again, _bytes
    cdef long long _chips, _free, _gap, _seen, _margin_cycles, _first_model, _line_end, _clocks, _as_before
    cdef Kept _nothing
    cdef long long _first, _off, _ready, _shown, _cost, _cost_at, _served, _chip, _stop, _end, _end_cycle
    cdef long long _missed, _nacked, _nacked_rounds, _over, _due, _held, _phases, _hung_at
    @cython.locals(row=cython.longlong)
    cpdef void run(self, long long[::1] given, long long[::1] found, long long count, long long jitter, bint pause, long long length)
    @cython.locals(
        at=cython.longlong, lane=Lane, range_=ValueRange, due=cython.longlong, num=cython.longlong, den=cython.longlong,
        whole=cython.longlong, part=cython.longlong, rest=cython.longlong, lates=cython.longlong, number=cython.longlong,
        begin=cython.longlong)
    cdef void _one(self, long long[::1] given, long long[::1] found, long long row, long long count, long long jitter)
    @cython.locals(lane=Lane, read=OneRead, range_=ValueRange, takes=cython.longlong)
    cdef void _of_clock(self, long long num, long long den)
    @cython.locals(
        lane=Lane, kept=Kept, start=cython.longlong, cycle=cython.longlong, rest=cython.longlong, flag=cython.longlong,
        asked=cython.longlong, lasted=cython.longlong, slack=cython.longlong)
    cdef void _make(self, long long begin, long long latest, long long next_due)
    @cython.locals(
        lane=Lane, end=cython.longlong, stop=cython.longlong, since=cython.longlong, again=cython.longlong)
    cdef bint _as_kept(self, Kept kept, long long start, long long cycle, long long rest)
    @cython.locals(
        lane=Lane, read=OneRead, number=cython.longlong, chips=cython.longlong, begun=cython.longlong,
        first_rest=cython.longlong, plain=cython.bint, chip=cython.longlong, asked=cython.longlong,
        first_start=cython.longlong, cleared_most=cython.longlong, cleared_least=cython.longlong,
        asked_most=cython.longlong, asked_least=cython.longlong)
    cdef void _by_reads(self, Kept kept, long long start, long long cycle, long long rest)
    @cython.locals(seen=cython.longlong)
    cdef void _refuse(self, OneRead read, long long chip, long long start)
    @cython.locals(lane=Lane, end=cython.longlong, since=cython.longlong)
    cdef void _serve(self, OneRead read, long long chip, long long start, long long cycle, long long rest)
    @cython.locals(lane=Lane, cost=cython.longlong, end=cython.longlong, part=cython.longlong)
    cdef void _models(self, long long begin)
    @cython.locals(chips=cython.longlong)
    cdef void _count_kept(self)
    @cython.locals(lasted=cython.longlong)
    cdef void _hang_on(self)
    @cython.locals(place=cython.longlong, range_=ValueRange)
    cdef void _tell(self, long long[::1] found, long long at)
