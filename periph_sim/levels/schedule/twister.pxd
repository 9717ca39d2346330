cimport cython


@cython.final
cdef class Twister:
    cdef unsigned int[19968] _state
    cdef unsigned int[2048] _added
    cdef unsigned int[32] _last, _word
    cdef long long[32] _drawn
    cdef unsigned int[624] _basic
    @cython.locals(
        keys=cython.longlong, bits=cython.longlong, first=cython.longlong, lanes=cython.longlong, lane=cython.longlong,
        key=cython.longlong, place=cython.longlong)
    cpdef void draw(self, unsigned int[::1] words, long long length, long long below, long long count, long long[::1] found)
    @cython.locals(lane=cython.longlong, key=cython.longlong, place=cython.longlong, mixed=cython.uint)
    cdef void _seed(self, long long length)  # vectors
    @cython.locals(lane=cython.int, mixed=cython.uint)
    cdef void _mix(self, long long place, long long key, unsigned int basic)
    @cython.locals(lane=cython.int, mixed=cython.uint)
    cdef void _mix_again(self, long long at, unsigned int place)
    @cython.locals(
        lane=cython.longlong, place=cython.longlong, drawing=cython.longlong, drawn=cython.longlong,
        number=cython.longlong)
    cdef void _numbers(self, long long lanes, long long below, long long shift, long long count, long long[::1] found, long long first)
    @cython.locals(at=cython.longlong, after=cython.longlong, middle=cython.longlong, lane=cython.int, y=cython.uint)
    cdef void _words(self, long long place, unsigned int shift)  # vectors
