// Lists of the pairs within the cutoff, periodic images included.
#pragma once
#include "bins.h"

// Steps to a periodic image along the three axes, ten bits each.
static __device__ int packed_steps(const int steps[3])
{
    return (steps[0] + 512) | (steps[1] + 512) << 10 | (steps[2] + 512) << 20;
}

static __device__ int steps_along(int packed, int axis)
{
    return ((packed >> 10 * axis) & 1023) - 512;
}

// Difference of a lattice coordinate from a periodic image of another particle, in box edges. Near coordinates have a
// difference without round-off.
template <typename T>
__device__ T difference(typename Precision<T>::Fixed own, typename Precision<T>::Fixed other, int steps)
{
    typename Precision<T>::Signed nearest = (typename Precision<T>::Signed)(own - other);
    int turns = own >= other ? (nearest < 0 ? 1 : 0) : (nearest >= 0 ? -1 : 0);
    return (T)nearest * (T)Precision<T>::UNIT + (T)(turns - steps);
}

// Components along the axes of space of a vector along the axes of the box.
static __device__ void turn_to_space(const Task &task, const double x[3], double turned[3])
{
    for (int a = 0; a < 3; a++) {
        const double *row = task.numbers->axes + 3 * a;
        turned[a] = task.is_rotated ? row[0] * x[0] + row[1] * x[1] + row[2] * x[2] : x[a];
    }
}

// Vector from a periodic image of one position to another along the axes of the box.
template <typename T, typename Fixed>
__device__ void separation_of(const Task &task, const Fixed *own, const Fixed *other, const int steps[3], T x[3])
{
    const Numbers &box = *task.numbers;
    T along[3];
    for (int axis = 0; axis < 3; axis++)
        along[axis] = difference<T>(own[axis], other[axis], steps[axis]) * (T)box.edges[axis];
    x[0] = along[0] + (T)box.strain * along[1] + (T)box.tilt_x * along[2];
    x[1] = along[1] + (T)box.tilt_y * along[2];
    x[2] = along[2];
}

// The same of two particles in the order of bins.
template <typename T>
__device__ void separation(const Task &task, int target, int source, const int steps[3], T x[3])
{
    const typename Precision<T>::Fixed *sorted = (const typename Precision<T>::Fixed *)task.sorted_positions;
    separation_of<T>(task, sorted + 3 * target, sorted + 3 * source, steps, x);
}

// Whether a periodic image that is some steps away exists.
static __device__ bool has_image(const Task &task, const int steps[3])
{
    for (int axis = 0; axis < 3; axis++)
        if (steps[axis] != 0 && (task.bounded_axes >> axis & 1)) return false;
    return true;
}

// Calls a function with each particle in the bins around one, periodic images included, and the steps to the image.
template <typename T, typename Visit>
__device__ void visit_around(const Task &task, int target, const int reach[3], const Visit &visit)
{
    typedef typename Precision<T>::Fixed Fixed;
    int home[3], at[3], steps[3], bin[3];
    for (int axis = 0; axis < 3; axis++) {
        Fixed rest;
        home[axis] = cell_of(((const Fixed *)task.sorted_positions)[3 * target + axis], task.grid[axis], &rest) / BIN;
    }
    for (at[2] = -reach[2]; at[2] <= reach[2]; at[2]++)
        for (at[1] = -reach[1]; at[1] <= reach[1]; at[1]++)
            for (at[0] = -reach[0]; at[0] <= reach[0]; at[0]++) {
                for (int axis = 0; axis < 3; axis++) {
                    bin[axis] = wrapped(home[axis] + at[axis], task.bins[axis]);
                    steps[axis] = (home[axis] + at[axis] - bin[axis]) / task.bins[axis];
                }
                if (!has_image(task, steps)) continue;
                int key = (bin[2] * task.bins[1] + bin[1]) * task.bins[0] + bin[0];
                for (int source = task.bin_starts[key]; source < task.bin_starts[key + 1]; source++)
                    if (source != target || steps[0] != 0 || steps[1] != 0 || steps[2] != 0) visit(source, steps);
            }
}

// Whether a particle in the order of bins is one whose motion is wanted.
static __device__ bool is_owned(const Task &task, int place)
{
    return place < task.particles && (task.owned == task.particles || task.rows[place] < task.owned);
}

// Finds the neighbours of each particle in the order of bins: first, without a list, their numbers; then the list. Both
// are one kernel, so that the same pairs are within the cutoff whatever the compiler makes of the arithmetic.
template <typename T> __device__ void find_neighbours(const Task &task)
{
    int target = thread_index(), found = 0;
    if (!is_owned(task, target)) return;
    int *list = task.neighbours ? task.neighbours + 2 * task.neighbour_starts[target] : nullptr;
    auto visit = [&](int source, const int steps[3]) {
        T x[3];
        separation<T>(task, target, source, steps, x);
        if (x[0] * x[0] + x[1] * x[1] + x[2] * x[2] >= (T)task.cutoff_square) return;
        if (list) {
            list[2 * found] = source;
            list[2 * found + 1] = packed_steps(steps);
        }
        found++;
    };
    visit_around<T>(task, target, task.reach, visit);
    if (!list) task.neighbour_starts[target] = found;
}
