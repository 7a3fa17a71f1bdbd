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

// A position of 64 bits as one of the precision of the grid.
template <typename T> __device__ typename Precision<T>::Fixed narrowed(unsigned long long position);
template <> __device__ inline unsigned long long narrowed<double>(unsigned long long position) { return position; }
template <> __device__ inline unsigned narrowed<float>(unsigned long long position)
{
    return (unsigned)((position + (1ull << 31)) >> 32);
}

// An index wrapped into 0..period, from at most some periods away.
static __device__ int wrapped(int index, int period)
{
    while (index < 0) index += period;
    while (index >= period) index -= period;
    return index;
}
