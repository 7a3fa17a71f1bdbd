// Arguments of all kernels.
#pragma once

// State of an iteration of conjugate gradients: products of residual and preconditioned residual, and whether the
// iteration goes on, each after the last step and after the one before it; the square of the tolerance, and the number
// of steps. It goes on until the error is within the tolerance, or no step can reduce it.
struct PairState {
    double products[2], goes_on[2], square, steps;
};

// State of the solve with near pairs. The host sets what comes before the sums: the part of the last direction in the
// next one, the product of residual and preconditioned residual before a step, and that of an iteration within it.
struct SolveState {
    double turn, product;
    PairState pairs;
    double sums[5];
};

// Vectors of the basis of Lanczos' iteration at most.
static constexpr int MOST_VECTORS = 100;

// State of Lanczos' iteration: the last vector of the basis, the product of its image with it, and the square of the
// norm of the remainder; products of the remainder with all vectors, or coordinates of the result; the vectors.
struct KrylovState {
    long long last;
    double diagonal, square, products[MOST_VECTORS];
    double *vectors[MOST_VECTORS];
};

// Numbers that change from step to step or from solve to solve. They are in the memory of the device, so commands that
// were recorded use the present ones. gpu/src/numbers.rs has the same fields in the same order.
struct Numbers {
    double edges[3];
    double inverse_spacing[3];
    // Strain s and tilts t and r of the lattice, and t - s r.
    double strain, tilt_x, tilt_y, tilt_across;
    // Axes of the box by rows.
    double axes[9];
    double solve_factor;
    // Rate of strain of the background at z = 0, and derivatives of its components xz and yz with respect to z; z of the
    // first point of the grid.
    double background[5], slope[2], lowest;
    // From the units of a solve to those of the far field: of forces, and of torques and stresslets; and back: of
    // velocities, and of gradients.
    double force, torque, velocity, rate;
    // Seed of random numbers of modes or particles.
    unsigned long long noise_seed;
    // Numbers of stiff and of soft pairs of all rows, and of those that the host gives.
    long long near_entries[2], given_entries;
    // Unit of length of the host over that of the far field.
    double length;
};

// A sphere of a block of threads that preconditions: its row, or -1; the place of the first sphere of its group in the
// block, and the number of spheres of the group.
struct GroupMember {
    int row;
    short first, count;
};

// Largest number of spheres of a group, as in gpu/src/groups.rs.
static constexpr int GROUP = 8;

// Groups while they are formed, one for each row: the first row of the group that the row is in; if that is the row
// itself, the number of spheres of the group, and otherwise 0; the group that it chooses to join, or -1; its rows.
struct SphereGroup {
    int root, count, choice, rows[GROUP];
};

// Sets of near pairs.
static constexpr int STIFF = 0, SOFT = 1;

struct NearKind;
struct SurfacePair;
struct History;
struct Displacement;
struct DrawnMotion;
struct KnownColumns;
struct StepMotion;
struct Contacts;
struct PredictedMotion;

// gpu/src/task.rs has the same fields in the same order. Lists without a type hold values of the precision of the
// grid, sorted positions unsigned integers of the same size.
struct Task {
    // Particles in the order of the host: lattice coordinates as fractions of 2^64, classes of radius, loads. A load may
    // be absent.
    const unsigned long long *positions;
    const int *classes;
    void *forces, *torques, *stresslets;
    // Particles in the order of bins: their rows in the order of the host, coordinates, classes, and loads as a force
    // and a dipole.
    int *keys, *unsorted, *rows, *bin_starts, *bin_cursors;
    void *sorted_positions;
    int *sorted_classes;
    void *records;
    // Neighbours of each particle: place and packed steps to the periodic image.
    int *neighbour_starts, *neighbours;
    // Numbers of neighbours, of stiff and of soft pairs.
    int *counts;
    // Polynomials of the window, coefficients of the Laplacian by class, logarithms of the multiplier by axis.
    const void *window, *smoothing, *levels;
    // Kernel of unbounded fluid by modes.
    const void *free_kernel;
    // Walls and open faces: numbers of the columns of modes, weights of the planes and matrix of the mean, amplitudes.
    const double *channel_columns, *channel_planes, *channel_mean;
    double *channel_amplitudes;
    // Images in walls: where those of a particle begin, source and twice the block, plus one if the block is for the two
    // in this order; blocks.
    const int *image_starts, *images;
    const void *image_blocks;
    // Pair functions: all tables, and for each pair of classes where its table begins, its intervals per square of
    // the distance, and its number of intervals; functions at distance 0 by class.
    const void *tables, *isolated;
    const double *intervals_per_square;
    const int *table_starts, *table_sizes;
    // Values on the grid, [component][z][y][x], their transform, and sums of the interpolation by particle.
    void *field, *spectrum, *interpolated;
    // Where the part of each line of the grid along y, and along z, begins that a device has, and its lines.
    const int *parts[2];
    // Motions in the order of the host.
    void *velocities, *angular_velocities, *strain_rates;
    // Random numbers: ids of particles, the iteration that takes the square root of a mobility, and the steps that
    // particles have made across the faces of the box.
    const unsigned long long *ids;
    KrylovState *krylov;
    int *periods;
    // List that is summed up, and sums of its blocks.
    int *scanned, *scan_totals;
    // Vectors that are combined, weights of the classes of radius, and sums of blocks.
    const void *list_x;
    void *list_y;
    const void *list_weights;
    double *list_sums;
    // Sums of all blocks.
    double *totals;
    // Sums of the blocks of the kernel before.
    const double *block_sums;
    // Groups of spheres that precondition: as they are formed, lists of their numbers of spheres, and members of blocks;
    // the inverses of their matrices; resistances of single spheres by class of radius.
    SphereGroup *groups;
    int *group_places;
    GroupMember *members;
    double *inverses;
    const double *resistances;
    // Lubrication: pairs of classes, and their tables. Stiff and soft pairs by rows: where the pairs of a row begin,
    // their other spheres, packed steps to the periodic image, nine lists of numbers, and of each row its own resistance.
    const NearKind *near_kinds;
    const double *near_series;
    int *near_starts[2], *near_others[2], *near_steps[2];
    void *near_numbers[2];
    double *near_own[2];
    // Rows of other stiff pairs that the host gives, if there are any.
    const int *given_starts, *given_others;
    const double *given_numbers, *given_own;
    // First moments of spheres at walls by their own motions, three numbers each, if there are any.
    const double *given_at_walls;
    // Laws of forces between surfaces by pairs of classes, as many for each pair as there are forces.
    const SurfacePair *surface_laws;
    // Loads and first moments of spheres at rest in the background, six and five numbers each.
    double *in_flow;
    // Vectors of the solve with near pairs; those of stiff pairs alone; known loads or motions of the fluid.
    double *unknowns, *residual, *preconditioned;
    const double *direction;
    double *image, *stiff_loads, *stiff_residual;
    // The direction of an iteration after the one that is given.
    double *next_direction;
    const double *ambient;
    SolveState *state;
    const Numbers *numbers;
    // Columns of solutions, and the places of rows in them.
    const History *history;
    const int *places;
    // Particles that move, random motions of the fluid at them, solutions with these, and displacements that are measured.
    Displacement *displacement;
    const DrawnMotion *drawn;
    const KnownColumns *known;
    const StepMotion *step;
    // Contacts and predicted motions whose springs near pairs have, if there are any.
    Contacts *contacts;
    const PredictedMotion *predicted;

    double cutoff_square, inverse_viscosity;
    // Multiplier of the solve: square of the Gaussian's width, coefficient of k^2 in the bracket.
    double gaussian, widening;
    // Factor of random loads.
    double factor;
    long long list_size;
    // Number of sums of blocks of the kernel before.
    long long block_count;

    // Particles; the first of them in the order of the host have motions, the others are those of other devices.
    int particles, owned, class_count;
    int grid[3], bins[3], tiles[3];
    // Planes along z of the values that this device has, and modes along y of columns along z: the first, and how many.
    int first_plane, planes, first_mode, modes;
    // Bins in which neighbours of a bin's particles are, to either side.
    int reach[3];
    // The same of near pairs.
    int near_reach[3];
    // The same of forces between surfaces, and the number of these forces.
    int surface_reach[3], surface_count;
    // Points of the window; of its derivatives, coefficients per point and their place in the list.
    int points, window_rows[4], window_starts[4];
    // Threads of a particle in the interpolation.
    int lanes;
    int is_rotated, scan_count;
    // Axes along which the box does not repeat, a bit each.
    int bounded_axes;
    // Sets of near pairs, a bit each, and whether the loads of single spheres are added to theirs.
    int pair_sets, adds_single;
    // 0 and 1 in turn for the steps of an iteration.
    int parity;
    // Whether an image is that of known loads and motions, of which minus the residual is asked for.
    int is_residual;
    // Whether spheres that overlap are lubricated as at a gap equal to the overlap.
    int separates_overlaps;
};
