// Resistance coefficients of one sphere of a near pair, from the tables of the host; lubrication/src/coefficients.rs has
// the equations.
#pragma once
#include "task.h"

// Functions in the tables of stiff and of soft pairs, and coefficients of the power series of each.
static constexpr int FACTORS = 40, SIDES = 23;
static constexpr int NODES = 8;

// Two classes of radius, that of a row's sphere first. gpu/src/near_tables.rs has the same fields in the same order.
struct NearKind {
    // Sum of the radii, the smaller one, whether the row's sphere is the larger one, and the viscosity times the smaller
    // radius.
    double sum, small, is_larger, drag;
    // Gaps: beyond which there is no lubrication, below which it is constant, and below which a pair is stiff.
    double cutoff, minimum_gap, stiff_gap;
    // Ratio of the radii, at least 1.
    double ratio;
    // Of the stiff and of the soft pairs: where the series of the first piece begin in the list of all, that piece, and
    // the number of pieces.
    long long first[2], first_piece[2], pieces[2];
};

// Coefficients of the loads on a sphere, in the order of lubrication/src/sphere_row.rs; of two values, the first is by
// its own motion and the second by that of the other sphere.
struct SphereRow {
    double xa[2], ya[2], xc[2], yc[2], yb[2], xg[2], yg[2], yh[2];
    double yb_other, xg_strain, yg_strain, yh_strain, xm_minus_zm_half, ym_minus_zm, zm;
};

// N functions of a gap, as power series of a piece in `(h - m) / (h + m)` with the gap h over the smaller radius and the
// mean m of the piece.
template <int N> struct GapSeries {
    const double *coefficients;
    double at;

    __device__ double value(int function) const
    {
        double sum = coefficients[(NODES - 1) * N + function];
        for (int power = NODES - 2; power >= 0; power--) sum = sum * at + coefficients[power * N + function];
        return sum;
    }
};

// Piece of a gap: twice its binary exponent from 2^-24 on, plus one in the upper half of an octave.
static __device__ long long piece_of(double gap)
{
    union {
        double value;
        unsigned long long bits;
    } number = {gap};
    const unsigned long long mantissa = (1ull << 52) - 1, root_two = 0x6a09e667f3bcdull;
    long long piece = 2 * ((long long)(number.bits >> 52) - 1023 + 24) + ((number.bits & mantissa) >= root_two ? 1 : 0);
    return piece > 0 ? piece : 0;
}

template <int N> __device__ GapSeries<N> series_at(const Task &task, const NearKind &kind, int set, double gap)
{
    double scaled = gap / kind.small;
    long long piece = piece_of(scaled) - kind.first_piece[set];
    if (piece < 0) piece = 0;
    if (piece >= kind.pieces[set]) piece = kind.pieces[set] - 1;
    const double *list = task.near_series + kind.first[set] + piece * (1 + NODES * N);
    return {list + 1, (scaled - list[0]) / (scaled + list[0])};
}

// Factor that falls from 1 to 0 in the last quarter of the range of gaps.
static __device__ double taper(double gap_over_cutoff)
{
    double x = (1 - gap_over_cutoff) / 0.25;
    x = x < 0 ? 0 : x > 1 ? 1 : x;
    return x * x * x * (10 - x * (15 - 6 * x));
}

// Table of a stiff pair at its gap, and what makes it dimensional: the factor of the resistance over that of radii 1
// and q, and by sphere, the row's own first, shares of a mean velocity, velocities of the poles by strain, and square
// roots of the resistances of single spheres.
struct StiffTable {
    GapSeries<FACTORS> functions;
    double factor, radius, root_of_sum, sign;
    int own;
    double share[2], lever[2], moving[2], turning[2], straining[2];

    // Sum of a row of a symmetric matrix from strains to moments, whose lower triangle begins at a function.
    __device__ double moments(int first) const
    {
        double alone = functions.value(first + 2 * own) * straining[0], other = functions.value(first + 1) * straining[1];
        return factor * straining[0] * (alone + other);
    }
};

static __device__ StiffTable stiff_table(const Task &task, const NearKind &kind, double gap)
{
    const double pi = 3.14159265358979323846, lever = 0.816496580927726;
    double effective = task.separates_overlaps ? fabs(gap) : gap;
    if (effective < kind.minimum_gap) effective = kind.minimum_gap;
    StiffTable table;
    table.functions = series_at<FACTORS>(task, kind, STIFF, effective);
    table.factor = kind.drag * taper(gap / kind.cutoff);
    table.radius = kind.small;
    table.root_of_sum = sqrt(1 + kind.ratio);
    table.own = kind.is_larger != 0 ? 1 : 0;
    table.sign = table.own ? 1 : -1;
    for (int side = 0; side < 2; side++) {
        double radius = (side == 0) == (table.own == 1) ? kind.ratio : 1, cubed = radius * sqrt(radius);
        table.share[side] = radius / (1 + kind.ratio);
        table.lever[side] = lever * radius;
        table.moving[side] = sqrt(6 * pi) * sqrt(radius);
        table.turning[side] = sqrt(8 * pi) * cubed;
        table.straining[side] = sqrt(20.0 / 3 * pi) * cubed;
    }
    return table;
}

// Coefficients by velocities along the axis: the rate w at which the gap opens, and a mean velocity c.
static __device__ void set_axial(const StiffTable &t, SphereRow &row)
{
    const GapSeries<FACTORS> &f = t.functions;
    double square = t.radius * t.radius, single = sqrt(6 * 3.14159265358979323846), of_mean = single * t.root_of_sum;
    double p = single * f.value(0), q = of_mean * f.value(1), s = of_mean * f.value(2);
    double ww = t.factor * p * p, wc = t.factor * p * q, cc = t.factor * (q * q + s * s);
    row.xa[0] = ww + 2 * t.sign * t.share[0] * wc + t.share[0] * t.share[0] * cc;
    row.xa[1] = -ww + t.sign * (t.share[1] - t.share[0]) * wc + t.share[0] * t.share[1] * cc;
    double gaps[2], openings[2], means[2];
    for (int side = 0; side < 2; side++) {
        int sphere = side == 0 ? t.own : 1 - t.own;
        gaps[side] = t.factor * single * t.straining[side] * f.value(3 + sphere);
        openings[side] = gaps[side] - t.lever[side] * ww;
        means[side] = t.factor * of_mean * t.straining[side] * f.value(5 + sphere) - t.lever[side] * wc;
    }
    double to_moment = sqrt(1.5) * t.radius;
    row.xg[0] = to_moment / 3 * (t.sign * openings[0] + t.share[0] * means[0]);
    row.xg[1] = to_moment / 3 * (-t.sign * openings[0] + t.share[1] * means[0]);
    row.xg_strain = to_moment * (t.sign * (openings[0] + openings[1]) + t.share[0] * (means[0] + means[1]));
    double levers = t.lever[0] + t.lever[1];
    double moment = t.moments(7) - levers * gaps[0] - t.lever[0] * (gaps[0] + gaps[1]) + t.lever[0] * levers * ww;
    row.xm_minus_zm_half = (square * moment - row.zm) / 2;
}

// Coefficients by rotation about the axis.
static __device__ void set_spin(const StiffTable &t, SphereRow &row)
{
    double alone = t.functions.value(10 + 2 * t.own), both = t.functions.value(11);
    double other = t.functions.value(12 - 2 * t.own), own = t.radius * t.radius * t.factor * t.turning[0];
    row.xc[0] = own * t.turning[0] * (alone * alone + both * both);
    row.xc[1] = own * t.turning[1] * (alone * both + both * other);
}

// Place of the lower triangle's entry of a row and a column.
static __device__ int triangle(int row, int column)
{
    int low = row < column ? row : column, high = row < column ? column : row;
    return high * (high + 1) / 2 + low;
}

// Coefficients by velocities across the axis and the radius times rotations, with the row's own sphere first.
static __device__ void set_transverse(const StiffTable &t, SphereRow &row)
{
    const GapSeries<FACTORS> &f = t.functions;
    const int place[4] = {t.own, 1 - t.own, 2 + t.own, 3 - t.own};
    const double single[4] = {t.moving[0], t.moving[1], t.turning[0], t.turning[1]};
    double square = t.radius * t.radius, root[4][4], matrix[3][4];
    for (int i = 0; i < 4; i++)
        for (int j = 0; j <= i; j++) root[i][j] = root[j][i] = f.value(13 + triangle(place[i], place[j]));
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++) {
            double product = 0;
            for (int k = 0; k < 4; k++) product += root[i][k] * root[j][k];
            matrix[i][j] = t.factor * single[i] * single[j] * product;
        }
    row.yb_other = t.radius * matrix[1][2];
    double by_other[2];
    for (int side = 0; side < 2; side++) {
        row.ya[side] = matrix[0][side];
        row.yb[side] = t.radius * matrix[0][2 + side];
        row.yc[side] = square * matrix[2][2 + side];
        double moved = t.factor * single[side] * t.straining[0] * f.value(23 + 2 * place[side] + t.own);
        double turned = t.factor * single[2 + side] * t.straining[0] * f.value(23 + 2 * place[2 + side] + t.own);
        row.yg[side] = sqrt(0.5) * t.radius * moved;
        row.yh[side] = sqrt(0.5) * square * turned;
        int own = side == 0 ? 0 : 2;
        by_other[side] = t.factor * single[own] * t.straining[1] * f.value(23 + 2 * place[own] + 1 - t.own);
    }
    row.yg_strain = 2 * row.yg[0] + sqrt(2.0) * t.radius * by_other[0];
    row.yh_strain = 2 * row.yh[0] + sqrt(2.0) * square * by_other[1];
    row.ym_minus_zm = square * t.moments(31) - row.zm;
}

// Coefficients of a stiff pair: products of factors, so that the resistance is positive whatever the round-off.
static __device__ SphereRow stiff_side(const Task &task, const NearKind &kind, double gap)
{
    StiffTable table = stiff_table(task, kind, gap);
    SphereRow row;
    row.zm = kind.small * kind.small * table.moments(34);
    set_axial(table, row);
    set_spin(table, row);
    set_transverse(table, row);
    return row;
}

// Coefficients of a soft pair, which are tabulated themselves.
static __device__ SphereRow soft_side(const Task &task, const NearKind &kind, double gap)
{
    GapSeries<SIDES> functions = series_at<SIDES>(task, kind, SOFT, gap);
    double factor = taper(gap / kind.cutoff);
    SphereRow row;
    for (int k = 0; k < SIDES; k++) ((double *)&row)[k] = factor * functions.value(k);
    return row;
}
