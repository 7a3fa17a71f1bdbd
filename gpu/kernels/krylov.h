// Square root of a mobility times random numbers of the particles, by Lanczos' iteration as in fcm/src/lanczos.rs.
// Vectors are in f64: the first components of all particles, then the second ones, and so on. Components are three of
// a force, and with dipoles three of a torque and five of a stresslet in an orthonormal basis.
#pragma once
#include "noise.h"
#include "vectors.h"

static constexpr int LOAD_COMPONENTS = 11;

static __device__ int components_of(const Task &task) { return task.strain_rates ? LOAD_COMPONENTS : 3; }

static __device__ long long component_at(const Task &task, int row, int component)
{
    return (long long)component * task.particles + row;
}

// Square root of the mobility of a single sphere for a component.
static __device__ double scale_of(const Task &task, int row, int component)
{
    const double *scales = (const double *)task.list_weights + 3 * task.classes[row];
    return scales[component < 3 ? 0 : component < 6 ? 1 : 2];
}

// Components of a symmetric matrix without a trace in an orthonormal basis, and the matrix by its components.
static __device__ void orthonormal(const double e[5], double to[5])
{
    to[0] = -sqrt(1.5) * (e[0] + e[3]);
    to[1] = (e[0] - e[3]) / sqrt(2.0);
    to[2] = sqrt(2.0) * e[1], to[3] = sqrt(2.0) * e[2], to[4] = sqrt(2.0) * e[4];
}

static __device__ void matrix_of(const double from[5], double e[5])
{
    double half = sqrt(0.5), mean = -0.5 * from[0] / sqrt(1.5);
    e[0] = mean + half * from[1], e[3] = mean - half * from[1];
    e[1] = half * from[2], e[2] = half * from[3], e[4] = half * from[4];
}

// Normal numbers of each particle as the remainder, and their squares summed up by blocks.
static __device__ void draw_numbers(const Task &task)
{
    int row = thread_index(), components = components_of(task);
    double own = 0;
    if (row < task.particles) {
        Random random(task.numbers->noise_seed, task.ids[row]);
        for (int first = 0; first < components; first += 2) {
            double pair[2];
            random.next_normal(pair);
            for (int i = 0; i < 2 && first + i < components; i++) {
                task.residual[component_at(task, row, first + i)] = pair[i];
                own += pair[i] * pair[i];
            }
        }
    }
    store_sum(own, task.list_sums + blockIdx.x);
}

// The remainder over its norm as a vector of the basis, and its loads.
template <typename T> __device__ void loads_of_vector(const Task &task)
{
    int row = thread_index(), components = components_of(task);
    if (row >= task.particles) return;
    double *vector = task.krylov->vectors[task.krylov->last], inverse = 1 / sqrt(task.krylov->square);
    double load[LOAD_COMPONENTS], moment[5];
    for (int k = 0; k < components; k++) {
        long long at = component_at(task, row, k);
        vector[at] = inverse * task.residual[at];
        load[k] = vector[at] / scale_of(task, row, k);
    }
    for (int k = 0; k < 3; k++) ((T *)task.forces)[3 * row + k] = (T)load[k];
    if (components < LOAD_COMPONENTS) return;
    matrix_of(load + 6, moment);
    for (int k = 0; k < 3; k++) ((T *)task.torques)[3 * row + k] = (T)load[3 + k];
    for (int k = 0; k < 5; k++) ((T *)task.stresslets)[5 * row + k] = (T)-moment[k];
}

// Products of numbers of a particle with those in the vectors of the basis, summed up by blocks.
static __device__ void store_products(const Task &task, int row, const double numbers[LOAD_COMPONENTS])
{
    int components = row < task.particles ? components_of(task) : 0;
    for (long long vector = 0; vector <= task.krylov->last; vector++) {
        double own = 0;
        for (int k = 0; k < components; k++)
            own += numbers[k] * task.krylov->vectors[vector][component_at(task, row, k)];
        store_sum(own, task.list_sums + vector * task.list_size + blockIdx.x);
    }
}

// Image of the last vector from its motions, as the remainder, and its products with the basis.
template <typename T> __device__ void image_of_vector(const Task &task)
{
    int row = thread_index(), components = components_of(task);
    double image[LOAD_COMPONENTS], strain[5];
    if (row < task.particles) {
        for (int k = 0; k < 3; k++) image[k] = ((const T *)task.velocities)[3 * row + k];
        if (components == LOAD_COMPONENTS) {
            for (int k = 0; k < 3; k++) image[3 + k] = ((const T *)task.angular_velocities)[3 * row + k];
            for (int k = 0; k < 5; k++) strain[k] = ((const T *)task.strain_rates)[5 * row + k];
            orthonormal(strain, image + 6);
        }
        for (int k = 0; k < components; k++) {
            image[k] /= scale_of(task, row, k);
            task.residual[component_at(task, row, k)] = image[k];
        }
    }
    store_products(task, row, image);
}

// Sums of the sums of all blocks in a list.
static __device__ void store_total(const Task &task, long long list, double *total)
{
    double own = 0;
    for (long long block = threadIdx.x; block < task.list_size; block += SUM_THREADS)
        own += task.list_sums[list * task.list_size + block];
    store_sum(own, total);
}

// Products of the remainder with the vectors of the basis, a block each, and that of the image with the last vector.
template <bool IS_IMAGE> __device__ void sum_products_with_basis(const Task &task)
{
    KrylovState &krylov = *task.krylov;
    int vector = (int)blockIdx.x;
    if (vector > krylov.last) return;
    store_total(task, vector, krylov.products + vector);
    if (IS_IMAGE && vector == krylov.last && threadIdx.x == 0) krylov.diagonal = krylov.products[vector];
}

// The square of the remainder's norm, by one block. The next vector becomes the last one.
static __device__ void sum_square(const Task &task)
{
    store_total(task, 0, &task.krylov->square);
    if (threadIdx.x == 0) task.krylov->last++;
}

// Subtracts from the remainder its parts along the basis; and its products with the basis after that, or its square.
template <bool IS_LAST> __device__ void project(const Task &task)
{
    const KrylovState &krylov = *task.krylov;
    int row = thread_index(), components = row < task.particles ? components_of(task) : 0;
    double rest[LOAD_COMPONENTS], square = 0;
    for (int k = 0; k < components; k++) {
        long long at = component_at(task, row, k);
        rest[k] = task.residual[at];
        for (long long vector = 0; vector <= krylov.last; vector++)
            rest[k] -= krylov.products[vector] * krylov.vectors[vector][at];
        task.residual[at] = rest[k];
        square += rest[k] * rest[k];
    }
    if (IS_LAST) store_sum(square, task.list_sums + blockIdx.x);
    else store_products(task, row, rest);
}

// Adds to the motions those with the given coordinates, which are in the place of the products, in the basis.
template <typename T> __device__ void add_motions(const Task &task)
{
    const KrylovState &krylov = *task.krylov;
    int row = thread_index(), components = components_of(task);
    if (row >= task.particles) return;
    double motion[LOAD_COMPONENTS], strain[5];
    for (int k = 0; k < components; k++) {
        double sum = 0;
        for (long long vector = 0; vector < krylov.last; vector++)
            sum += krylov.products[vector] * krylov.vectors[vector][component_at(task, row, k)];
        motion[k] = sum * scale_of(task, row, k);
    }
    for (int k = 0; k < 3; k++) ((T *)task.velocities)[3 * row + k] += (T)motion[k];
    if (components < LOAD_COMPONENTS) return;
    matrix_of(motion + 6, strain);
    for (int k = 0; k < 3; k++) ((T *)task.angular_velocities)[3 * row + k] += (T)motion[3 + k];
    for (int k = 0; k < 5; k++) ((T *)task.strain_rates)[5 * row + k] += (T)strain[k];
}
