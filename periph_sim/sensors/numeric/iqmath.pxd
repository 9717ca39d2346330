cimport cython

ctypedef fused Raw:
    long long
    object


@cython.locals(exact=Raw, k=Raw, x=Raw, s=Raw, c=Raw, up=Raw, along=Raw, sign=Raw)
cpdef tuple sine_and_cosine(Raw angle, long long bits, object sines, object cosines)
@cython.locals(start=Raw, slope=Raw, bend=Raw)
cpdef Raw arctangent(Raw ratio, Raw index, long long bits, object a0, object a1, object a2)
@cython.locals(
    wide=cython.longlong,
    high=cython.longlong,
    steep=cython.bint,
    over=cython.longlong,
    under=cython.longlong,
    ratio=cython.longlong,
    index=cython.longlong,
    angle=cython.longlong,
)
cpdef long long atan2_of(long long y, long long x, long long bits)
