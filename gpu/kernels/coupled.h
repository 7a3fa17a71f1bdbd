// Vectors of the coupled solve of near pairs and far field. Unknowns are minus the motions in the loads of stiff pairs,
// these loads, the same of soft pairs, and minus the stresslets; a residual has motions for stiff and for soft pairs,
// and rates of strain. All are lists of six or five numbers of each particle, one after the other.
#pragma once
#include "near.h"

// Parts of unknowns and of a residual that belong to a particle.
template <typename N> struct UnknownsOf {
    N *stiff, *stiff_loads, *soft, *soft_loads, *moments;
};
template <typename N> struct ResidualOf {
    N *stiff, *soft, *strain;
};

template <typename N> __device__ UnknownsOf<N> unknowns_of(const Task &task, N *list, int row)
{
    long long part = (long long)SIX * task.particles, at = (long long)SIX * row;
    N *moments = list + 4 * part + COMPONENTS * row;
    return {list + at, list + part + at, list + 2 * part + at, list + 3 * part + at, moments};
}

template <typename N> __device__ ResidualOf<N> residual_of(const Task &task, N *list, int row)
{
    long long part = (long long)SIX * task.particles, at = (long long)SIX * row;
    return {list + at, list + part + at, list + 2 * part + COMPONENTS * row};
}

// Product of a residual and unknowns.
static __device__ double product_of(const ResidualOf<const double> &r, const UnknownsOf<const double> &x)
{
    double sum = contracted(r.strain, x.moments);
    for (int k = 0; k < SIX; k++) sum += r.stiff[k] * x.stiff_loads[k] + r.soft[k] * x.soft_loads[k];
    return sum;
}

// The next direction in place of the last one, `p = z + turn p`; with a turn of 0 the last one may be undefined.
static __device__ void turn_direction(const Task &task, int row)
{
    UnknownsOf<const double> z = unknowns_of<const double>(task, task.preconditioned, row);
    UnknownsOf<double> p = unknowns_of(task, task.next_direction, row);
    double turn = task.state->turn;
    auto turned = [turn](double of_z, double of_p) { return turn == 0 ? of_z : of_z + turn * of_p; };
    for (int k = 0; k < SIX; k++) {
        p.stiff[k] = turned(z.stiff[k], p.stiff[k]);
        p.stiff_loads[k] = turned(z.stiff_loads[k], p.stiff_loads[k]);
        p.soft[k] = turned(z.soft[k], p.soft[k]);
        p.soft_loads[k] = turned(z.soft_loads[k], p.soft_loads[k]);
    }
    for (int k = 0; k < COMPONENTS; k++) p.moments[k] = turned(z.moments[k], p.moments[k]);
}

// Loads on the far field of a direction, which is turned first if there is a place for the next one, or of unknowns,
// with known loads if there are any.
template <typename T> __device__ void coupled_loads(const Task &task)
{
    int row = thread_index();
    if (row >= task.particles) return;
    if (task.next_direction) turn_direction(task, row);
    double of_force = task.numbers->force, of_torque = task.numbers->torque;
    UnknownsOf<const double> x = unknowns_of(task, task.direction, row);
    for (int k = 0; k < SIX; k++) {
        double load = x.stiff_loads[k] + x.soft_loads[k];
        if (task.ambient) load += task.ambient[SIX * row + k];
        if (k < 3) ((T *)task.forces)[3 * row + k] = (T)(of_force * load);
        else ((T *)task.torques)[3 * row + k - 3] = (T)(of_torque * load);
    }
    for (int k = 0; k < COMPONENTS; k++)
        ((T *)task.stresslets)[COMPONENTS * row + k] = (T)(-of_torque * x.moments[k]);
}

// Image of a direction from the motions of the far field, and its products with the direction. For unknowns, with
// ambient motions and those of the background, it is minus the residual, which is stored.
template <typename T> __device__ void coupled_image(const Task &task)
{
    int row = thread_index();
    double product = 0, sign = task.is_residual ? -1 : 1;
    double of_velocity = task.numbers->velocity, of_rate = task.numbers->rate;
    if (row < task.particles) {
        UnknownsOf<const double> x = unknowns_of(task, task.direction, row);
        ResidualOf<double> image = residual_of(task, task.image, row);
        for (int k = 0; k < SIX; k++) {
            double moved = k < 3 ? of_velocity * (double)((const T *)task.velocities)[3 * row + k]
                                 : of_rate * (double)((const T *)task.angular_velocities)[3 * row + k - 3];
            if (task.ambient) moved += task.ambient[SIX * row + k];
            image.stiff[k] = sign * (x.stiff[k] + moved);
            image.soft[k] = sign * (x.soft[k] + moved);
        }
        for (int k = 0; k < COMPONENTS; k++) {
            double strain = of_rate * (double)((const T *)task.strain_rates)[COMPONENTS * row + k];
            if (task.ambient) strain += task.ambient[(long long)SIX * task.particles + COMPONENTS * row + k];
            image.strain[k] = sign * (strain + (task.is_residual ? task.numbers->background[k] : 0));
        }
        product = product_of({image.stiff, image.soft, image.strain}, x);
    }
    store_sum(product, task.list_sums + blockIdx.x);
}

// Unknowns and residual of a row after a step along a direction.
static __device__ void step_along(const Task &task, int row, double length)
{
    UnknownsOf<double> x = unknowns_of(task, task.unknowns, row);
    UnknownsOf<const double> p = unknowns_of(task, task.direction, row);
    ResidualOf<double> r = residual_of(task, task.residual, row), q = residual_of(task, task.image, row);
    for (int k = 0; k < SIX; k++) {
        x.stiff[k] += length * p.stiff[k];
        x.stiff_loads[k] += length * p.stiff_loads[k];
        x.soft[k] += length * p.soft[k];
        x.soft_loads[k] += length * p.soft_loads[k];
        r.stiff[k] -= length * q.stiff[k];
        r.soft[k] -= length * q.soft[k];
    }
    for (int k = 0; k < COMPONENTS; k++) {
        x.moments[k] += length * p.moments[k];
        r.strain[k] -= length * q.strain[k];
    }
}

// A step to the minimum along a direction, if there is one, with the product of the new residual and the former
// preconditioned one, and the residual of soft pairs and rates of strain, preconditioned: motions as they are, and
// moments of single spheres. That of stiff pairs becomes the loads of single spheres, from which an iteration starts at
// rest.
static __device__ void step_coupled(const Task &task)
{
    int row = thread_index();
    double former = 0, length = task.direction ? task.state->product / sum_of_list(task, 0) : 0;
    if (row < task.particles) {
        ResidualOf<double> r = residual_of(task, task.residual, row);
        UnknownsOf<double> z = unknowns_of(task, task.preconditioned, row);
        if (task.direction) {
            step_along(task, row, length);
            former = product_of({r.stiff, r.soft, r.strain}, {z.stiff, z.stiff_loads, z.soft, z.soft_loads, z.moments});
        }
        for (int k = 0; k < SIX; k++) {
            double load = resistances_of(task, row)[k < 3 ? 0 : 1] * r.stiff[k];
            task.stiff_loads[SIX * row + k] = task.stiff_residual[SIX * row + k] = load;
            z.stiff[k] = 0;
            z.soft[k] = r.soft[k];
        }
        for (int k = 0; k < COMPONENTS; k++) z.moments[k] = resistances_of(task, row)[2] * r.strain[k];
    }
    store_sum(former, task.list_sums + task.list_size + blockIdx.x);
}

// Residual times the preconditioned residual, and the squares of the error and of the sizes of the unknowns and of the
// preconditioned residual.
static __device__ void measure_coupled(const Task &task)
{
    int row = thread_index();
    double product = 0, error = 0, size = 0, correction = 0;
    if (row < task.particles) {
        ResidualOf<const double> r = residual_of<const double>(task, task.residual, row);
        UnknownsOf<const double> z = unknowns_of<const double>(task, task.preconditioned, row);
        UnknownsOf<const double> x = unknowns_of<const double>(task, task.unknowns, row);
        const double *single = resistances_of(task, row);
        product = product_of(r, z);
        error = correction = contracted(z.moments, z.moments) / single[2];
        size = contracted(x.moments, x.moments) / single[2];
        for (int k = 0; k < SIX; k++) {
            double of_kind = single[k < 3 ? 0 : 1], stiff = z.stiff_loads[k], soft = z.soft_loads[k];
            error += (stiff * stiff + soft * soft) / of_kind;
            size += of_kind * x.stiff[k] * x.stiff[k];
            correction += of_kind * z.stiff[k] * z.stiff[k];
        }
    }
    store_sum(product, task.list_sums + blockIdx.x);
    store_sum(error, task.list_sums + 2 * task.list_size + blockIdx.x);
    store_sum(size, task.list_sums + 3 * task.list_size + blockIdx.x);
    store_sum(correction, task.list_sums + 4 * task.list_size + blockIdx.x);
}

// Unknowns of motions, of the loads of all near pairs in them, and of a list of minus the stresslets.
static __device__ void start_coupled(const Task &task)
{
    int row = thread_index();
    if (row >= task.particles) return;
    UnknownsOf<double> x = unknowns_of(task, task.unknowns, row);
    for (int k = 0; k < SIX; k++) {
        x.stiff[k] = x.soft[k] = -task.direction[SIX * row + k];
        x.stiff_loads[k] = -task.image[SIX * row + k];
        x.soft_loads[k] = 0;
    }
    for (int k = 0; k < COMPONENTS; k++) x.moments[k] = ((const double *)task.list_x)[COMPONENTS * row + k];
}

// Result for the host, after the preconditioned residual as a last correction: motions, loads on the far field, minus
// the stresslets, and rates of strain besides those of the background, of which the residual is what is left.
static __device__ void gather_result(const Task &task)
{
    int row = thread_index();
    if (row >= task.particles) return;
    UnknownsOf<double> x = unknowns_of(task, task.unknowns, row), z = unknowns_of(task, task.preconditioned, row);
    ResidualOf<double> r = residual_of(task, task.residual, row);
    long long motions = (long long)SIX * task.particles;
    double *motion = task.image + SIX * row, *load = motion + motions;
    double *moment = task.image + 2 * motions + COMPONENTS * row;
    double *strain = moment + (long long)COMPONENTS * task.particles;
    for (int k = 0; k < SIX; k++) {
        motion[k] = -(x.stiff[k] + z.stiff[k]);
        load[k] = (x.stiff_loads[k] + z.stiff_loads[k]) + (x.soft_loads[k] + z.soft_loads[k]);
    }
    for (int k = 0; k < COMPONENTS; k++) {
        moment[k] = x.moments[k] + z.moments[k];
        strain[k] = -r.strain[k] - task.numbers->background[k];
    }
}

// Solution after a change of unknowns, with the preconditioned residual as a last correction of the change: motions, and
// minus the stresslets, from those of the start in a direction and a list.
static __device__ void gather_changed(const Task &task)
{
    int row = thread_index();
    if (row >= task.particles) return;
    UnknownsOf<double> x = unknowns_of(task, task.unknowns, row), z = unknowns_of(task, task.preconditioned, row);
    const double *start = task.direction + SIX * row, *start_moment = (const double *)task.list_x + COMPONENTS * row;
    double *motion = task.image + SIX * row, *moment = task.image + (long long)SIX * task.particles + COMPONENTS * row;
    for (int k = 0; k < SIX; k++) motion[k] = start[k] - (x.stiff[k] + z.stiff[k]);
    for (int k = 0; k < COMPONENTS; k++) moment[k] = start_moment[k] + (x.moments[k] + z.moments[k]);
}
