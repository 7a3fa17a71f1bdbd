// Known solutions in columns: their residual, and their change where spheres have moved. Columns are in the order of the
// particles' ids, and in the units of the host.
#pragma once
#include "coupled.h"

// gpu/src/known.rs has the same fields in the same order.
struct KnownColumns {
    // Velocities and angular velocities relative to the background, and stresslets of the far field.
    const double *motions[2], *far_stresslets;
    // Forces and torques; total stresslets; motions of the fluid for which the solution is exact: velocities, angular
    // velocities and rates of strain.
    double *loads[2], *stresslets, *ambient;
    // Changes of velocities and of total stresslets over a divisor.
    double *velocity_changes, *stresslet_changes, divisor;
    // Units of the host over those of the solve.
    double velocity, rate, torque;
    // Whether loads and motions of the fluid are known.
    long long is_complete;
};

// Vectors of a known solution: its motions, loads, minus the stresslets, and motions of the fluid. Unless loads are known
// they are those that are given, if there are any, and those of near pairs in the background, and are stored; then there
// are no motions of the fluid.
static __device__ void load_known(const Task &task)
{
    int row = thread_index();
    if (row >= task.particles) return;
    const KnownColumns &known = *task.known;
    long long place = task.places[row];
    const double *in_flow = task.in_flow + (SIX + COMPONENTS) * (long long)row;
    const double *ambient = known.ambient + (SIX + COMPONENTS) * place;
    for (int k = 0; k < SIX; k++) {
        long long at = (long long)SIX * row + k, from = 3 * place + k % 3;
        int of_kind = k / 3;
        double unit = of_kind == 0 ? known.velocity : known.rate, of_load = of_kind == 0 ? 1 : known.torque;
        task.unknowns[at] = known.motions[of_kind][from] / unit;
        if (known.is_complete) {
            task.image[at] = known.loads[of_kind][from] / of_load;
            task.residual[at] = ambient[k] / unit;
        } else {
            task.image[at] = in_flow[k] + (task.ambient ? task.ambient[at] : 0);
            known.loads[of_kind][from] = task.image[at] * of_load;
        }
    }
    for (int k = 0; k < COMPONENTS; k++) {
        long long at = COMPONENTS * (long long)row + k;
        ((double *)task.list_y)[at] = -(known.far_stresslets[COMPONENTS * place + k] / known.torque);
        if (known.is_complete) task.residual[(long long)SIX * task.particles + at] = ambient[SIX + k] / known.rate;
    }
}

// Total stresslet of a row from minus that of the far field and first moments of near pairs by motions.
static __device__ double
total_stresslet(const KnownColumns &known, const double *moments, const double *by_motions, int k)
{
    return -(moments[k] + by_motions[k]) * known.torque;
}

// Motions of the fluid for which a solution is exact, from its residual, and its total stresslets, from lists of minus
// those of the far field and of first moments of near pairs.
static __device__ void store_residual(const Task &task)
{
    int row = thread_index();
    if (row >= task.particles) return;
    const KnownColumns &known = *task.known;
    long long place = task.places[row], at = COMPONENTS * (long long)row;
    ResidualOf<const double> r = residual_of<const double>(task, task.residual, row);
    double *ambient = known.ambient + (SIX + COMPONENTS) * place;
    for (int k = 0; k < SIX; k++) ambient[k] = r.stiff[k] * (k < 3 ? known.velocity : known.rate);
    for (int k = 0; k < COMPONENTS; k++) {
        ambient[SIX + k] = r.strain[k] * known.rate;
        known.stresslets[COMPONENTS * place + k] =
            total_stresslet(known, (const double *)task.list_x + at, (const double *)task.list_y + at, k);
    }
}

// Changes over the divisor, from motions and minus the stresslets of the far field after the change, and first moments of
// near pairs by these motions.
static __device__ void store_change(const Task &task)
{
    int row = thread_index();
    if (row >= task.particles) return;
    const KnownColumns &known = *task.known;
    long long place = task.places[row], at = COMPONENTS * (long long)row;
    const double *motion = task.direction + SIX * (long long)row;
    const double *moments = task.direction + SIX * (long long)task.particles + at;
    for (int axis = 0; axis < 3; axis++) {
        long long to = 3 * place + axis;
        known.velocity_changes[to] = (motion[axis] * known.velocity - known.motions[0][to]) / known.divisor;
    }
    for (int k = 0; k < COMPONENTS; k++) {
        long long to = COMPONENTS * place + k;
        double total = total_stresslet(known, moments, (const double *)task.list_x + at, k);
        known.stresslet_changes[to] = (total - known.stresslets[to]) / known.divisor;
    }
}
