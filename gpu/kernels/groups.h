// Groups of spheres whose stiff pairs the preconditioner couples, and the inverses of their matrices. A group is within
// one block of threads of the preconditioner, with six threads a sphere.
#pragma once
#include "near.h"

// Spheres of a block, as in gpu/src/groups.rs.
static constexpr int BLOCK_MEMBERS = 42;
static constexpr int INVERT_THREADS = 64;

// The inverse of the matrix of the group whose first member has a place in the list of all.
static __device__ double *inverse_at(const Task &task, long long place)
{
    return task.inverses + SIX * SIX * GROUP * place;
}

// A row's resistance to its own motion by stiff pairs, with that of the single sphere, as six rows of a matrix.
static __device__ void store_own(const Task &task, int row, double *matrix, int width)
{
    const double *own = task.near_own[STIFF] + OWN_NUMBERS * row, *c = own + 12;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int low = i < j ? i : j, high = i < j ? j : i, k = low == 0 ? high : low + high + 1;
            double coupling = i == j ? 0 : (j == (i + 1) % 3 ? 1 : -1) * c[3 - i - j];
            matrix[i * width + j] = own[k] + (i == j ? resistances_of(task, row)[0] : 0);
            matrix[(3 + i) * width + 3 + j] = own[6 + k] + (i == j ? resistances_of(task, row)[1] : 0);
            matrix[i * width + 3 + j] = coupling;
            matrix[(3 + i) * width + j] = -coupling;
        }
}

// Adds the resistance of a stiff pair to the motion of the other sphere.
static __device__ void add_block(const Task &task, long long entry, double *matrix, int width)
{
    for (int j = 0; j < SIX; j++) {
        double motion[SIX] = {0, 0, 0, 0, 0, 0}, load[SIX] = {0, 0, 0, 0, 0, 0};
        motion[j] = 1;
        add_load<double>(task, STIFF, entry, motion, load);
        for (int i = 0; i < SIX; i++) matrix[i * width + j] += load[i];
    }
}

// Matrix of a group, `M_0^-1 + R` without the coupling to other groups: the rows of one of its spheres.
static __device__ void store_rows(const Task &task, const GroupMember *group, int member, double *matrix)
{
    int row = group[member].row, count = group->count, width = SIX * count;
    double *rows = matrix + member * SIX * width;
    for (int k = 0; k < SIX * width; k++) rows[k] = 0;
    store_own(task, row, rows + SIX * member, width);
    for (int entry = task.near_starts[STIFF][row]; entry < task.near_starts[STIFF][row + 1]; entry++)
        for (int other = 0; other < count; other++)
            if (group[other].row == task.near_others[STIFF][entry]) add_block(task, entry, rows + SIX * other, width);
}

// Replaces a matrix by its inverse, by elimination without pivoting, for it is positive. All threads of a block.
static __device__ void invert(double *matrix, int width, double *column)
{
    int thread = (int)threadIdx.x;
    for (int pivot = 0; pivot < width; pivot++) {
        double scale = 1 / matrix[pivot * width + pivot];
        for (int i = thread; i < width; i += INVERT_THREADS) column[i] = matrix[i * width + pivot];
        __syncthreads();
        for (int j = thread; j < width; j += INVERT_THREADS) {
            double *at = matrix + pivot * width + j;
            *at = j == pivot ? scale : *at * scale;
        }
        __syncthreads();
        for (int k = thread; k < width * width; k += INVERT_THREADS) {
            int i = k / width, j = k % width;
            if (i == pivot) continue;
            matrix[k] = (j == pivot ? 0 : matrix[k]) - column[i] * matrix[pivot * width + j];
        }
        __syncthreads();
    }
}

// Inverses of the matrices of groups, by a block for each member, of which those of first members work.
static __device__ void invert_group(const Task &task)
{
    SHARED(double, matrix, SIX *SIX *GROUP *GROUP);
    SHARED(double, column, SIX *GROUP);
    const GroupMember *group = task.members + blockIdx.x;
    if (group->row < 0 || group->first != (int)(blockIdx.x % BLOCK_MEMBERS)) return;
    int width = SIX * group->count, thread = (int)threadIdx.x;
    if (thread < group->count) store_rows(task, group, thread, matrix);
    __syncthreads();
    invert(matrix, width, column);
    for (int k = thread; k < width * width; k += INVERT_THREADS) inverse_at(task, blockIdx.x)[k] = matrix[k];
}
