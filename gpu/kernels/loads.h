// Loads of the particles.
#pragma once
#include "bins.h"

// Force and dipole of a particle in the order of the host, the dipole by rows.
template <typename T> __device__ void load_of(const Task &task, int row, T load[12])
{
    for (int i = 0; i < 12; i++) load[i] = 0;
    T *dipole = load + 3;
    if (task.forces)
        for (int c = 0; c < 3; c++) load[c] = ((const T *)task.forces)[3 * row + c];
    if (task.stresslets) {
        const T *s = (const T *)task.stresslets + 5 * row;
        dipole[0] = s[0], dipole[1] = dipole[3] = s[1], dipole[2] = dipole[6] = s[2];
        dipole[4] = s[3], dipole[5] = dipole[7] = s[4], dipole[8] = -s[0] - s[3];
    }
    if (task.torques) {
        const T *torque = (const T *)task.torques + 3 * row;
        T x = torque[0] / 2, y = torque[1] / 2, z = torque[2] / 2;
        dipole[1] += z, dipole[2] -= y, dipole[5] += x;
        dipole[3] -= z, dipole[6] += y, dipole[7] -= x;
    }
}

// Force and dipole of each particle along the axes of the box.
template <typename T> __device__ void gather_loads(const Task &task)
{
    int place = thread_index();
    if (place >= task.particles) return;
    const double *axes = task.numbers->axes;
    T load[12];
    load_of<T>(task, task.rows[place], load);
    const T *force = load, *dipole = load + 3;
    T *record = (T *)task.records + 12 * place;
    for (int a = 0; a < 3; a++) {
        if (!task.is_rotated) {
            record[a] = force[a];
            for (int b = 0; b < 3; b++) record[3 + 3 * a + b] = dipole[3 * a + b];
            continue;
        }
        record[a] = 0;
        for (int c = 0; c < 3; c++) record[a] += (T)axes[3 * c + a] * force[c];
        for (int b = 0; b < 3; b++) {
            T sum = 0;
            for (int c = 0; c < 3; c++)
                for (int d = 0; d < 3; d++)
                    sum += (T)axes[3 * c + a] * dipole[3 * c + d] * (T)axes[3 * d + b];
            record[3 + 3 * a + b] = sum;
        }
    }
}
