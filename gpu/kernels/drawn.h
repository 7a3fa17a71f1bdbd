// Random motions of the fluid at particles that move on the device. Lists are in the order of the particles' ids, and in
// the units of the host.
#pragma once
#include "near.h"

// gpu/src/drawn.rs has the same fields in the same order.
struct DrawnMotion {
    // Velocities, angular velocities and rates of strain; and these velocities with those of the background flow.
    double *ambient, *velocities;
    const double *positions;
    // Factors of velocities and of gradients from the units of the far field.
    double velocity, rate;
    // Velocity gradient of the background by rows.
    double gradient[9];
};

// Stores the motions of an evaluation.
template <typename T> __device__ void store_drawn(const Task &task)
{
    int row = thread_index();
    if (row >= task.particles) return;
    const DrawnMotion &drawn = *task.drawn;
    long long place = task.places[row];
    double *motion = drawn.ambient + (SIX + COMPONENTS) * place;
    const double *x = drawn.positions + 3 * place;
    for (int axis = 0; axis < 3; axis++) {
        const double *slope = drawn.gradient + 3 * axis;
        motion[axis] = drawn.velocity * (double)((const T *)task.velocities)[3 * row + axis];
        motion[3 + axis] = drawn.rate * (double)((const T *)task.angular_velocities)[3 * row + axis];
        double flow = slope[0] * x[0] + slope[1] * x[1] + slope[2] * x[2];
        drawn.velocities[3 * place + axis] = motion[axis] + flow;
    }
    for (int k = 0; k < COMPONENTS; k++)
        motion[SIX + k] = drawn.rate * (double)((const T *)task.strain_rates)[COMPONENTS * row + k];
}
