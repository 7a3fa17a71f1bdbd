// Kernels of the far field by the split method, and of the solve with near pairs. Each takes all arguments as a Task.
#ifndef SHARED
#define SHARED(type, name, count) __shared__ type name[count]
#endif
#include "assembly.h"
#include "channel.h"
#include "contacts.h"
#include "coupled.h"
#include "displace.h"
#include "drawn.h"
#include "exchange.h"
#include "grouping.h"
#include "history.h"
#include "images.h"
#include "known.h"
#include "krylov.h"
#include "loads.h"
#include "noise.h"
#include "overlaps.h"
#include "pair_noise.h"
#include "pair_steps.h"
#include "pairs.h"
#include "spread.h"
#include "steps.h"
#include "strain.h"
#include "surface.h"
#include "vectors.h"

#ifndef KERNEL
#define KERNEL(name, ...) \
    extern "C" __global__ void name(const Task task) { __VA_ARGS__(task); }
#endif

#define KERNELS(T, suffix)                                \
    KERNEL(bin_particles_##suffix, bin_particles<T>)      \
    KERNEL(order_particles_##suffix, order_particles<T>)  \
    KERNEL(find_neighbours_##suffix, find_neighbours<T>)  \
    KERNEL(gather_loads_##suffix, gather_loads<T>)        \
    KERNEL(spread_0_##suffix, spread<T, 0>)               \
    KERNEL(spread_1_##suffix, spread<T, 1>)               \
    KERNEL(spread_2_##suffix, spread<T, 2>)               \
    KERNEL(spread_3_##suffix, spread<T, 3>)               \
    KERNEL(solve_##suffix, solve<T>)                      \
    KERNEL(solve_open_##suffix, solve_open<T>)            \
    KERNEL(channel_mean_##suffix, channel_mean<T>)        \
    KERNEL(channel_moments_##suffix, channel_moments<T>)  \
    KERNEL(channel_flow_##suffix, channel_flow<T>)        \
    KERNEL(random_modes_##suffix, random_modes<T>)        \
    KERNEL(pack_planes_##suffix, pack<T, PLANE>)          \
    KERNEL(unpack_planes_##suffix, unpack<T, PLANE>)      \
    KERNEL(pack_columns_##suffix, pack<T, COLUMN>)        \
    KERNEL(unpack_columns_##suffix, unpack<T, COLUMN>)    \
    KERNEL(interpolate_0_##suffix, interpolate<T, 0>)     \
    KERNEL(interpolate_1_##suffix, interpolate<T, 1>)     \
    KERNEL(interpolate_2_##suffix, interpolate<T, 2>)     \
    KERNEL(interpolate_3_##suffix, interpolate<T, 3>)     \
    KERNEL(pair_motions_##suffix, pair_motions<T>)        \
    KERNEL(image_motions_##suffix, image_motions<T>)      \
    KERNEL(strain_turn_##suffix, turn_strain<T>)          \
    KERNEL(strain_product_##suffix, bend_strain<T>)       \
    KERNEL(strain_step_##suffix, measure_strain<T>)       \
    KERNEL(row_loads_##suffix, row_loads<T>)              \
    KERNEL(turn_pairs_##suffix, turn_rows<T>)             \
    KERNEL(find_near_##suffix, find_near<T>)              \
    KERNEL(find_contacts_##suffix, find_contacts<T>)      \
    KERNEL(assemble_soft_##suffix, assemble<T, SOFT>)     \
    KERNEL(surface_forces_##suffix, surface_forces<T>)    \
    KERNEL(random_loads_##suffix, random_loads<T>)        \
    KERNEL(drawn_motions_##suffix, store_drawn<T>)        \
    KERNEL(overlapping_pairs_##suffix, count_overlaps<T>) \
    KERNEL(gap_changes_2_##suffix, change_gaps<T, 2>)     \
    KERNEL(gap_changes_4_##suffix, change_gaps<T, 4>)     \
    KERNEL(nearest_pairs_##suffix, find_nearest<T>)       \
    KERNEL(pushed_apart_##suffix, push_apart<T>)          \
    KERNEL(coupled_loads_##suffix, coupled_loads<T>)      \
    KERNEL(coupled_image_##suffix, coupled_image<T>)      \
    KERNEL(krylov_loads_##suffix, loads_of_vector<T>)     \
    KERNEL(krylov_image_##suffix, image_of_vector<T>)     \
    KERNEL(krylov_motions_##suffix, add_motions<T>)

KERNEL(scatter_particles, scatter)
KERNEL(scan_blocks, sum_blocks)
KERNEL(scan_add, add_totals)
KERNEL(sum_up, add_sums)
KERNEL(assemble_stiff, assemble<double, STIFF>)
KERNEL(begin_groups, start_groups)
KERNEL(choose_groups, choose_group)
KERNEL(join_groups, join_group)
KERNEL(count_groups, count_group)
KERNEL(place_groups, place_group)
KERNEL(invert_groups, invert_group)
KERNEL(moments_stiff, near_moments<STIFF>)
KERNEL(moments_soft, near_moments<SOFT>)
KERNEL(step_pairs, step_rows)
KERNEL(remainder_pairs, remainder_of_rows)
KERNEL(step_all, step_coupled)
KERNEL(measure_all, measure_coupled)
KERNEL(start_all, start_coupled)
KERNEL(gather_all, gather_result)
KERNEL(gather_all_changed, gather_changed)
KERNEL(krylov_draw, draw_numbers)
KERNEL(krylov_products_of_image, sum_products_with_basis<true>)
KERNEL(krylov_products, sum_products_with_basis<false>)
KERNEL(krylov_project, project<false>)
KERNEL(krylov_project_again, project<true>)
KERNEL(krylov_norm, sum_square)
KERNEL(guess_all, guess_solution)
KERNEL(store_all, store_solution)
KERNEL(compare_all, compare_with_guess)
KERNEL(load_known_all, load_known)
KERNEL(store_residual_all, store_residual)
KERNEL(store_change_all, store_change)
KERNEL(displace_all, displace)
KERNEL(place_all, place_particles)
KERNEL(combine_all, combine_columns)
KERNEL(add_flow, add_flow_to_velocities)
KERNEL(limit_all, limit_vectors)
KERNEL(displacement_error_2, measure_displacements<2>)
KERNEL(displacement_error_4, measure_displacements<4>)
KERNEL(load_contacts, contact_loads)
KERNEL(end_contacts_all, end_contacts)
KERNELS(float, f32)
KERNELS(double, f64)
