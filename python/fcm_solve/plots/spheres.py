"""Images of shaded spheres in orthographic projection."""

import numpy as np

AZIMUTH, ELEVATION = np.radians(-60.0), np.radians(18.0)
LIGHT = np.array([-0.45, 0.65, 0.62])
AMBIENT = 0.35
# For more than MANY spheres, only the DEPTH foremost spheres of each column are drawn.
MANY, DEPTH = 20_000, 10


def view():
    """Directions right, up and towards the viewer as rows; z is up."""
    cos_a, sin_a, cos_e, sin_e = np.cos(AZIMUTH), np.sin(AZIMUTH), np.cos(ELEVATION), np.sin(ELEVATION)
    towards = np.array([cos_e * cos_a, cos_e * sin_a, sin_e])
    right = np.array([-sin_a, cos_a, 0.0])
    return np.array([right, np.cross(towards, right), towards])


def corners(lattice):
    """The twelve edges of a box with lattice vectors as rows, as pairs of points in the image plane, (12, 2, 2)."""
    points = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    pairs = [(a, b) for i, a in enumerate(points) for b in points[i + 1 :] if np.abs(a - b).sum() == 1]
    return np.array(pairs) @ lattice @ view().T[:, :2]


def nearest_to_viewer(places, radii):
    """Indices of the spheres that may be visible: for many, the nearest ones in each column as wide as the largest sphere."""
    if len(places) <= MANY:
        return np.arange(len(places))
    columns = np.floor(places[:, :2] / (2 * radii.max())).astype(int)
    order = np.lexsort((-places[:, 2], columns[:, 1], columns[:, 0]))
    is_first = np.any(np.diff(columns[order], axis=0, prepend=columns[order[:1]] - 1) != 0, axis=1)
    starts = np.maximum.accumulate(np.where(is_first, np.arange(len(order)), 0))
    return order[np.arange(len(order)) - starts < DEPTH]


def render(positions, radii, colours, lattice, pixels):
    """An image (height, width, 4) of the spheres on a transparent background, and its extent (left, right, bottom, top) in the
    image plane. Each pixel shows the sphere nearest to the viewer, lit from the upper left."""
    places = positions @ view().T
    chosen = nearest_to_viewer(places, radii)
    places, radii, colours = places[chosen], radii[chosen], colours[chosen]
    margin = radii.max()
    low = corners(lattice).min(axis=(0, 1)) - margin
    high = corners(lattice).max(axis=(0, 1)) + margin
    scale = pixels / (high - low).max()
    width, height = np.ceil((high - low) * scale).astype(int)
    image, depth = np.zeros((height, width, 4)), np.full((height, width), -np.inf)
    light = LIGHT / np.linalg.norm(LIGHT)
    for (x, y, z), radius, colour in zip(places, radii, colours):
        first = np.floor(([x - radius, y - radius] - low) * scale).astype(int)
        last = np.ceil(([x + radius, y + radius] - low) * scale).astype(int) + 1
        columns, rows = np.arange(first[0], last[0]), np.arange(first[1], last[1])
        dx = ((columns + 0.5) / scale + low[0] - x)[None, :] / radius
        dy = ((rows + 0.5) / scale + low[1] - y)[:, None] / radius
        square = 1 - dx**2 - dy**2
        dz = np.sqrt(np.maximum(square, 0))
        window = np.ix_(rows, columns)
        nearest = (square > 0) & (z + radius * dz > depth[window])
        shade = AMBIENT + (1 - AMBIENT) * np.maximum(dx * light[0] + dy * light[1] + dz * light[2], 0)
        part, far = image[window], depth[window]
        part[nearest, :3] = (shade[..., None] * colour[:3])[nearest]
        part[nearest, 3] = 1
        far[nearest] = (z + radius * dz)[nearest]
        image[window], depth[window] = part, far
    return image, (low[0], low[0] + width / scale, low[1], low[1] + height / scale)
