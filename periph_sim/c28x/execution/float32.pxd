cpdef bint is_zero(long long bits) noexcept
cpdef bint is_infinite(long long bits) noexcept
cpdef long long mantissa_of(long long bits) noexcept
cpdef long long exponent_of(long long bits) noexcept
cdef long long width(long long value) noexcept
cpdef long long rounded(long long mantissa, long long exponent, bint to_nearest, long long sign_of_zero=*)
cpdef long long sum_of(long long a, long long b, bint to_nearest)
cpdef long long difference_of(long long a, long long b, bint to_nearest)
cpdef long long product_of(long long a, long long b, bint to_nearest)
cpdef long long from_integer(long long value, bint to_nearest)
cpdef long long to_integer(long long bits, long long least, long long most, bint nearest=*)
cpdef long long fraction(long long bits)
cpdef long long order(long long bits) noexcept
cpdef long long estimate_of_inverse(long long bits)
cpdef long long estimate_of_inverse_root(long long bits)
cdef long long whole_root(long long value)
