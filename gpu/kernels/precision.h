// Numbers of the two precisions.
#pragma once

template <typename T> struct Precision;

template <> struct Precision<float> {
    typedef unsigned Fixed;
    typedef int Signed;
    static constexpr double UNIT = 1.0 / 4294967296.0;
};

template <> struct Precision<double> {
    typedef unsigned long long Fixed;
    typedef long long Signed;
    static constexpr double UNIT = 1.0 / 18446744073709551616.0;
};

template <typename T> struct Complex {
    T re, im;
};

// Integer part of a coordinate in grid spacings; `rest` becomes its fraction.
static __device__ int cell_of(unsigned position, int points, unsigned *rest)
{
    unsigned long long product = (unsigned long long)position * (unsigned)points;
    *rest = (unsigned)product;
    return (int)(product >> 32);
}

static __device__ int cell_of(unsigned long long position, int points, unsigned long long *rest)
{
    *rest = position * (unsigned long long)points;
    return (int)__umul64hi(position, (unsigned long long)points);
}

// An index wrapped into 0..period, from at most some periods away.
static __device__ int wrapped(int index, int period)
{
    while (index < 0) index += period;
    while (index >= period) index -= period;
    return index;
}
