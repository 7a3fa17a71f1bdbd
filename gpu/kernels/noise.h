// Random fields whose covariance is the far field on the grid.
#pragma once
#include "solve.h"

static constexpr unsigned long long STRIDE = 0x9e3779b97f4a7c15ull;

static __device__ unsigned long long mixed(unsigned long long z)
{
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
}

// Stream of random numbers by a seed and a name, the same as that of domain/src/random.rs.
struct Random {
    unsigned long long state;

    __device__ Random(unsigned long long seed, unsigned long long name) : state(mixed(mixed(seed + STRIDE) ^ name * STRIDE))
    {
    }

    __device__ unsigned long long next_bits()
    {
        state += STRIDE;
        return mixed(state);
    }

    // The next number in [0, 1).
    __device__ double next_uniform() { return (double)(next_bits() >> 11) / 9007199254740992.0; }

    // The next number of a uniform distribution with mean 0 and variance 1.
    __device__ double next() { return sqrt(12.0) * (next_uniform() - 0.5); }

    // The next two numbers of a normal distribution with mean 0 and variance 1.
    __device__ void next_normal(double pair[2])
    {
        double radius = sqrt(-2 * log(1 - next_uniform())), turn = 6.283185307179586 * next_uniform();
        pair[0] = radius * cos(turn), pair[1] = radius * sin(turn);
    }
};

// Modes of a random field, `sqrt(m(k)) (I - k k/k^2) c` with the multiplier m of the solve and complex numbers c of
// variance 1, the same as those of the host: only one of a mode and its opposite has numbers of its own.
template <typename T> __device__ void random_modes(const Task &task)
{
    int at = thread_index();
    if (at >= modes_of(task)) return;
    int order[3];
    for (int axis = 0; axis < 3; axis++) order[axis] = signed_mode(task, at, axis);
    // In the plane of modes that do not vary along x both a mode and its opposite are kept.
    bool is_opposite = order[0] == 0 && (order[1] < 0 || (order[1] == 0 && order[2] < 0));
    unsigned long long name = 0;
    for (int axis = 0; axis < 3; axis++)
        name = name << 21 | (unsigned long long)((is_opposite ? -order[axis] : order[axis]) + (1 << 20));
    Random random(task.numbers->noise_seed, name);
    Complex<T> numbers[3];
    for (int c = 0; c < 3; c++) {
        double re = sqrt(0.5) * random.next(), im = sqrt(0.5) * random.next();
        numbers[c] = {(T)re, (T)(is_opposite ? -im : im)};
    }
    Mode<T> mode = mode_at<T>(task, at);
    store_across<T>(task, at, mode, sqrt(mode.factor), numbers);
}
