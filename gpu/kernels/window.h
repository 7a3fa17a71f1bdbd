// The window of a particle on the grid.
#pragma once
#include "bins.h"

// Stencil of a particle along an axis: first grid point, not wrapped, and the argument of the window's polynomials.
template <typename T> struct AxisStencil {
    int first;
    T argument;
};

template <typename T> __device__ AxisStencil<T> axis_stencil(const Task &task, int place, int axis)
{
    typedef typename Precision<T>::Fixed Fixed;
    Fixed rest, half = (Fixed)1 << (8 * sizeof(Fixed) - 1);
    int cell = cell_of(((const Fixed *)task.sorted_positions)[3 * place + axis], task.grid[axis], &rest);
    if (task.points % 2 == 1) {
        // Half a spacing back.
        if (rest < half) cell--;
        rest -= half;
    }
    AxisStencil<T> stencil;
    stencil.first = cell + (rest > 0 ? 1 : 0) - task.points / 2;
    T beyond = rest > 0 ? (T)(Fixed)(0 - rest) * (T)Precision<T>::UNIT : (T)0;
    stencil.argument = 2 * beyond - 1;
    return stencil;
}

// A derivative of the window at a point of a stencil.
template <typename T> __device__ T window_value(const Task &task, int derivative, int point, T argument)
{
    const T *coefficients = (const T *)task.window + task.window_starts[derivative] + point;
    T sum = *coefficients;
    for (int row = 1; row < task.window_rows[derivative]; row++) {
        coefficients += task.points;
        sum = sum * argument + *coefficients;
    }
    return sum;
}

// Number of products of derivatives up to an order, and of pairs of orders whose sum is at most that.
static __device__ constexpr int terms_of(int order) { return (order + 1) * (order + 2) * (order + 3) / 6; }
static __device__ constexpr int pairs_of(int order) { return (order + 1) * (order + 2) / 2; }

// Index of the product of derivatives of orders n, m and l along the three axes, in the order of nested loops.
template <int ORDER> __device__ constexpr int term_index(int n, int m, int l)
{
    return terms_of(ORDER) - terms_of(ORDER - n) + pairs_of(ORDER - n) - pairs_of(ORDER - n - m) + l;
}

// Second derivatives of the Laplacian in lattice coordinates; the same as in fcm/src/grid/window/lattice.rs.
static constexpr int SECONDS = 6;
static __device__ int second_order(int second, int axis)
{
    const int orders[SECONDS] = {2, 1 | 1 << 4, 2 << 4, 2 << 8, 1 | 1 << 8, 1 << 4 | 1 << 8};
    return orders[second] >> 4 * axis & 15;
}

// Coefficients of the Laplacian of a class of particles, of monopoles (0) or dipoles (1).
template <typename T> __device__ const T *smoothing_of(const Task &task, int place, int multipole)
{
    return (const T *)task.smoothing + (2 * task.sorted_classes[place] + multipole) * SECONDS;
}
