// Iteration for the stresslets of rigid spheres by conjugate gradients. Unknowns, residual, preconditioned residual and
// direction have five numbers of each particle in the order of the host, in the precision of the grid.
#pragma once
#include "vectors.h"

// Five numbers of a particle in a list.
template <typename T> static __device__ T *tensor_of(const void *list, int row)
{
    return (T *)list + (long long)COMPONENTS * row;
}

template <typename T> static __device__ double contracted_as(const T *x, const T *y)
{
    double left[COMPONENTS], right[COMPONENTS];
    for (int k = 0; k < COMPONENTS; k++) left[k] = x[k], right[k] = y[k];
    return contracted(left, right);
}

// The next direction in place of the last one, `p = z + turn p`; with a turn of 0 the last one may be undefined.
template <typename T> __device__ void turn_strain(const Task &task)
{
    int row = thread_index();
    if (row >= task.particles) return;
    const T *z = tensor_of<T>(task.preconditioned, row);
    T *p = tensor_of<T>(task.next_direction, row), turn = (T)task.state->turn;
    for (int k = 0; k < COMPONENTS; k++) p[k] = turn == 0 ? z[k] : z[k] + turn * p[k];
}

// Products of a direction, as stresslets, with its image: minus the rates of strain.
template <typename T> __device__ void bend_strain(const Task &task)
{
    int row = thread_index();
    double product = 0;
    if (row < task.particles)
        product = -contracted_as(tensor_of<T>(task.direction, row), tensor_of<T>(task.strain_rates, row));
    store_sum(product, task.list_sums + blockIdx.x);
}

// A step of some length along a direction, which motions follow: three lists, one after the other.
template <typename T> static __device__ void step_along_strain(const Task &task, int row, T length)
{
    T *x = tensor_of<T>(task.unknowns, row), *r = tensor_of<T>(task.residual, row);
    const T *p = tensor_of<T>(task.direction, row), *strain = tensor_of<T>(task.strain_rates, row);
    T *motion = (T *)task.image, *of_strain = tensor_of<T>(motion + 6ll * task.particles, row);
    for (int k = 0; k < COMPONENTS; k++) {
        x[k] += length * p[k];
        r[k] += length * strain[k];
        of_strain[k] -= length * strain[k];
    }
    for (int k = 0; k < 3; k++) {
        long long at = 3ll * row + k;
        motion[at] -= length * ((const T *)task.velocities)[at];
        motion[3ll * task.particles + at] -= length * ((const T *)task.angular_velocities)[at];
    }
}

// A step to the minimum along a direction, if there is one, and the residual times the resistances of single spheres:
// its product with the former one and with the new residual, and the square of the size of the unknowns.
template <typename T> __device__ void measure_strain(const Task &task)
{
    int row = thread_index();
    double former = 0, product = 0, size = 0, length = task.direction ? task.state->product / sum_of_list(task, 0) : 0;
    if (row < task.particles) {
        const T *x = tensor_of<T>(task.unknowns, row), *r = tensor_of<T>(task.residual, row);
        T *z = tensor_of<T>(task.preconditioned, row), resistance = ((const T *)task.list_weights)[task.classes[row]];
        if (task.direction) {
            step_along_strain(task, row, (T)length);
            former = contracted_as<T>(r, z);
        }
        for (int k = 0; k < COMPONENTS; k++) z[k] = resistance * r[k];
        product = contracted_as<T>(r, z);
        size = contracted_as(x, x) / (double)resistance;
    }
    store_sum(former, task.list_sums + task.list_size + blockIdx.x);
    store_sum(product, task.list_sums + 2 * task.list_size + blockIdx.x);
    store_sum(size, task.list_sums + 3 * task.list_size + blockIdx.x);
}
