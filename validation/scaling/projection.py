"""Time of an evaluation, and of a step with lubrication, on the nodes of a cluster."""

import dataclasses
import math

from scaling.network import LATENCY, Group, Layout, Network

# Largest memory of a round of the exchange along z (`ROOM` of the crate fcm-solve-solver), and coefficients in a block along x by bytes
# of a value.
ROUND, BLOCK = 64 << 20, {4: 16, 8: 8}
# Ranks in one row are slabs if each has so many planes.
PLANES_OF_SLAB = 4
# Times that a value is read and written: copied to its place on the same node; packed and taken by MPI for others.
COPIES_ON_NODE, COPIES_TO_OTHERS = 1, 2


@dataclasses.dataclass(frozen=True)
class Calls:
    """Exchanges of a rank in an evaluation or a step: `sums` along a tree of the ranks, `halos` with those that it borders on; bytes of
    an image of a sphere; pairs of transforms."""

    sums: float
    halos: float
    image_bytes: float
    transforms: float


@dataclasses.dataclass(frozen=True)
class Design:
    """The program as it is, or with changes."""

    # One component of the grid is on the way while the next is transformed.
    overlaps: bool = False
    value_bytes: int = 4
    # Grid points along an axis, relative to the plan's.
    coarseness: float = 1.0
    # Share of a rank's work that its threads do not divide; `None`: as measured.
    serial: float | None = None


@dataclasses.dataclass(frozen=True)
class Job:
    """Spheres on all cores of nodes, ranks of so many threads."""

    spheres: int
    cores: int
    threads: int
    lubricated: bool = False

    @property
    def ranks(self):
        return math.ceil(self.cores / self.threads)


@dataclasses.dataclass(frozen=True)
class Parts:
    """Seconds by cause: work on all threads, work on one thread while the others wait, transpositions, halos, messages."""

    work: float
    serial: float
    transpositions: float
    halos: float
    messages: float

    @property
    def total(self):
        return sum(dataclasses.astuple(self))


@dataclasses.dataclass(frozen=True)
class Slice:
    """Ranks in a table of rows along y and columns along z, and the grid that they divide."""

    ranks: int
    points: int

    @property
    def table(self):
        ranks = self.ranks
        if ranks <= 4 or PLANES_OF_SLAB * ranks <= self.points:
            return 1, ranks
        rows = max(n for n in range(1, math.isqrt(ranks) + 1) if ranks % n == 0)
        return rows, ranks // rows

    def unevenness(self, value_bytes):
        """The largest over the mean share of grid lines in space, and of coefficients, which ranks divide in blocks along x."""
        (rows, columns), blocks = self.table, math.ceil(self.points / 2 / BLOCK[value_bytes])
        along = [math.ceil(count / parts) * parts / count for count, parts in ((self.points, rows), (self.points, columns), (blocks, rows))]
        return along[0] * along[1], along[2] * along[1]


@dataclasses.dataclass(frozen=True)
class Model:
    """The network, the work by the coarseness of the grid, seconds of a step of a sphere, calls of an evaluation and of a step, the
    ratios of sixteen cores by case and number of spheres, and the plan by number of spheres and lubrication."""

    network: Network
    works: dict
    step_of_sphere: float
    calls: dict
    ratios: callable
    plan: callable

    def on(self, node):
        return dataclasses.replace(self, network=Network(node, self.network.exponent))

    def parts(self, job, design):
        """Seconds of an evaluation, or of a step with lubrication."""
        points = round(self.plan(job.spheres, job.lubricated).points * design.coarseness)
        grid = Slice(job.ranks, points)
        layout = Layout(job.ranks, max(1, self.network.node.cores // job.threads))
        work = self.work(job, design, grid)
        serial = self.serial_share(job, design) * (job.threads - 1) * work
        halos, of_halos = self.halos(job, design, layout)
        transpositions, transforms = self.transpositions(job, design, layout)
        if design.overlaps and transpositions > 0:
            # Two of three components hide what is shorter.
            transpositions -= 2 / 3 * min(transpositions, transforms)
        return Parts(work, serial, transpositions, halos, of_halos * LATENCY)

    def serial_share(self, job, design):
        case = "step" if job.lubricated else "evaluation"
        return self.ratios(case, job.spheres / job.ranks).serial if design.serial is None else design.serial

    def busy(self, job):
        return self.ratios("step" if job.lubricated else "evaluation", job.spheres / job.ranks).busy

    def transform_seconds(self, job, design, grid):
        """Seconds of the transforms of a rank of one thread, on a core alone."""
        lines, coefficients = grid.unevenness(design.value_bytes)
        share = (lines + 2 * coefficients) / 3
        wide = design.value_bytes / 4
        pairs = self.calls[job.lubricated].transforms
        return pairs * wide * share * self.works[design.coarseness].transform(grid.points**3 / job.ranks, grid.points)

    def work(self, job, design, grid):
        """Seconds of the work of the largest rank on a node whose cores are all at work."""
        own = job.spheres / job.ranks
        most = own + math.sqrt(2 * math.log(max(job.ranks, 2)) * own)
        if job.lubricated:
            # Evaluations of the step on another grid differ by as much as those without lubrication.
            now, then = (self.works[coarseness].of_sphere for coarseness in (design.coarseness, 1.0))
            transforms = self.transform_seconds(job, dataclasses.replace(design, value_bytes=4), grid)
            even = self.calls[True].transforms * self.works[1.0].transform(grid.points**3 / job.ranks, grid.points)
            seconds = most * (self.step_of_sphere + self.calls[True].transforms * (now - then)) + transforms - even
        else:
            seconds = most * self.works[design.coarseness].of_sphere + self.transform_seconds(job, design, grid)
        return self.busy(job) * seconds / job.threads

    def transpositions(self, job, design, layout):
        """Seconds of the transpositions, and of the transforms between them."""
        points = round(self.plan(job.spheres, job.lubricated).points * design.coarseness)
        grid = Slice(job.ranks, points)
        (rows, columns), (lines, coefficients) = grid.table, grid.unevenness(design.value_bytes)
        values = 3 * design.value_bytes * points**3 / job.ranks
        seconds = 0.0
        for group, uneven in ((Group(columns, 1), coefficients), (Group(rows, columns), max(lines, coefficients))):
            away = group.shares(layout)[0] if group.size > 1 else 0.0
            packed = self.network.memory_seconds(layout, 2 * COPIES_TO_OTHERS * away * values * uneven)
            rounds = math.ceil(values * uneven / ROUND) if group.stride == 1 else 1
            repeated = (rounds - 1) * (group.size - 1) * LATENCY
            seconds += self.network.exchange_seconds(layout, group, values * uneven, COPIES_ON_NODE) + packed + repeated
        transforms = self.busy(job) * self.transform_seconds(job, design, grid) / job.threads
        return 2 * self.calls[job.lubricated].transforms * seconds, transforms

    def halos(self, job, design, layout):
        """Seconds of the bytes of images, and messages of a rank."""
        calls, ranks = self.calls[job.lubricated], job.ranks
        if ranks == 1:
            return 0.0, 0.0
        of = self.plan(job.spheres, job.lubricated)
        of = dataclasses.replace(of, reach=of.reach / design.coarseness)
        table = Slice(ranks, of.points).table
        found = images(job.spheres, of, table)
        reached = [min(math.ceil(of.reach / (of.edge / parts)), parts // 2) if parts > 1 else 0 for parts in table]
        # Neighbours along z follow in the order of the ranks; all others are on other nodes.
        away = min(1.0, (reached[1] or 1) / layout.per_node) if table[0] == 1 else 1 - found.along_z * max(0.0, 1 - reached[1] / layout.per_node)
        away = 0.0 if layout.nodes == 1 else away
        sent = calls.image_bytes * found.count
        seconds = self.network.port_seconds(layout, away * sent) + self.network.memory_seconds(layout, 4 * sent)
        neighbours = min(ranks - 1, (2 * reached[0] + 1) * (2 * reached[1] + 1) - 1)
        return seconds, calls.sums * math.ceil(math.log2(ranks)) + calls.halos * neighbours


@dataclasses.dataclass(frozen=True)
class Images:
    """Images of other ranks' spheres on a rank, and the share of them whose owners are beside it along z alone."""

    count: float
    along_z: float


def images(spheres, of, table):
    """Images on a rank of a table."""
    ranks = table[0] * table[1]
    widths = [of.edge / parts for parts in table]
    reached = [min(of.edge, width + 2 * of.reach) if parts > 1 else of.edge for width, parts in zip(widths, table)]
    density = spheres / of.edge**2
    count = density * (reached[0] * reached[1] - widths[0] * widths[1])
    along_z = density * (reached[1] - widths[1]) * widths[0]
    return Images(count, along_z / count if count and ranks > 1 else 0.0)


def efficiency(model, job, design):
    """Parallel efficiency relative to a full node with as many spheres a core."""
    node = model.network.node
    cores = node.cores // job.threads * job.threads
    alone = dataclasses.replace(job, spheres=round(job.spheres / job.cores * cores), cores=cores)
    return model.parts(alone, design).total / model.parts(job, design).total
