// Predicted motions of particles that move on the device, for implicit forces at the end of a time.
#pragma once
#include "neighbours.h"

// gpu/src/predicted.rs has the same fields in the same order.
struct PredictedMotion {
    // Positions, and velocities with that of a flow, in the order of ids and in the units of the host.
    const double *positions, *velocities;
    // Gradient by rows of the flow that velocities contain, in the units of the host; the factor of velocities from these
    // units to those of the solve, and the time in the latter.
    double gradient[9], velocity, time;
};

// Velocity relative to a flow of a particle with a place, from one with that of the flow.
static __device__ void relative_to_flow(
    const double *positions, const double *velocities, const double gradient[9], long long place, double v[3])
{
    const double *x = positions + 3 * place;
    for (int axis = 0; axis < 3; axis++) {
        const double *slope = gradient + 3 * axis;
        v[axis] = velocities[3 * place + axis] - (slope[0] * x[0] + slope[1] * x[1] + slope[2] * x[2]);
    }
}

// Rate at which a sphere and another are predicted to separate, with `x` from the other to the sphere along the axes of
// the box, and its length.
static __device__ double predicted_separation(const Task &task, int row, int other, const double x[3], double distance)
{
    const PredictedMotion &motion = *task.predicted;
    double own[3], others[3], along[3], rate = 0;
    turn_to_space(task, x, along);
    relative_to_flow(motion.positions, motion.velocities, motion.gradient, task.places[row], own);
    relative_to_flow(motion.positions, motion.velocities, motion.gradient, task.places[other], others);
    for (int axis = 0; axis < 3; axis++) rate += along[axis] * (own[axis] - others[axis]);
    return rate * motion.velocity / distance;
}
