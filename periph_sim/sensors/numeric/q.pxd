cimport cython

from .iqmath cimport atan2_of, sine_and_cosine


cpdef object nearest_in(object value, object bits)


cdef class Q:
    cdef public object name
    cdef public long long bits, overflows
    cdef bint _saturates
    cdef dict _factors
    cdef long long _one, _half
    cpdef object constant(self, object value)
    cpdef object nearest(self, object value)
    cpdef object value(self, long long x)
    @cython.locals(factor=cython.longlong, shift=cython.longlong, product=cython.longlong)
    cpdef long long scaled(self, long long count, object lsb)
    @cython.locals(total=cython.longlong)
    cpdef long long add(self, long long x, long long y)
    @cython.locals(rest=cython.longlong)
    cpdef long long sub(self, long long x, long long y)
    @cython.locals(product=cython.longlong)
    cpdef long long mul(self, long long x, long long y)
    cpdef long long div(self, long long x, long long y)
    cpdef long long neg(self, long long x)
    cpdef long long sqrt(self, long long x)
    cpdef long long mag(self, long long x, long long y)
    cpdef tuple sincos(self, long long x)
    cpdef long long atan(self, long long x)
    cpdef long long atan2(self, long long y, long long x)
    cpdef long long select_greater(self, long long x, long long y, long long yes, long long no)
    cpdef long long clamp(self, long long x, long long low, long long high)
    cpdef long long to_integer(self, long long x, object rounding)
    cpdef tuple plus(self, tuple u, tuple v)
    cpdef tuple minus(self, tuple u, tuple v)
    cpdef tuple times(self, tuple u, long long k)
    @cython.locals(first=tuple, second=tuple, third=tuple)
    cpdef tuple transformed(self, tuple rows, tuple u)
    cdef long long _dot(self, tuple u, tuple v)
    @cython.locals(
        x=cython.longlong, y=cython.longlong, z=cython.longlong, p=cython.longlong, q=cython.longlong, r=cython.longlong
    )
    cpdef tuple cross(self, tuple u, tuple v)
    cpdef tuple turned(self, long long c, long long s, long long x, long long y)
    @cython.locals(x=cython.longlong, y=cython.longlong, z=cython.longlong)
    cpdef tuple whole(self, tuple u, long long low, long long high, object rounding)
    cdef long long _saturated(self, long long x)
    cdef long long _overflow(self, long long x)


cdef class RoundedQ(Q):
    @cython.locals(product=cython.longlong)
    cpdef long long mul(self, long long x, long long y)
