"""Sections of the page on scale."""

import functools
import math
import pathlib
import re
import textwrap

from support.page import table

from scaling import counts, measured, published
from scaling.network import LATENCY, Node
from scaling.projection import Calls, Design, Job, Model, Slice, efficiency, images
from scaling.work import sixteen_cores

PLANNER = pathlib.Path(__file__).resolve().parents[2] / "fcm" / "src" / "plan" / "network.rs"
# Largest relative difference of the planner's calls from those counted.
DIFFERENCE = 0.1
NODES = [Node("40 cores, 12.5 GB/s", 40, 2, 12.5e9, 150e9), Node("128 cores, 25 GB/s", 128, 8, 25e9, 350e9)]
# Spheres and cores of the projection, and those of weak scaling.
JOBS = [(10**7, 1024), (10**9, 4096), (10**9, 16384), (10**9, 65536)]
SPHERES_A_CORE, WEAK = 10**7 / 1024, (1024, 8192)
NOW, OVERLAP, COARSER = Design(), Design(overlaps=True), Design(overlaps=True, coarseness=0.76)
# Designs, and whether a rank has the cores of a NUMA domain.
DESIGNS = [
    ("as it is, a rank a core", NOW, False),
    ("as it is, a rank a NUMA domain", NOW, True),
    ("a rank a core, one component on the way while the next is transformed", OVERLAP, False),
    ("and 0.76 of the grid points along an axis", COARSER, False),
    ("all of these, a rank a NUMA domain", COARSER, True),
    ("and 1% of its work serial", Design(overlaps=True, coarseness=0.76, serial=0.01), True),
]


def prose(text):
    """A paragraph in lines, and an empty line."""
    return [*textwrap.wrap(" ".join(text.split()), 120, break_long_words=False, break_on_hyphens=False), ""]


def short(value):
    """Three digits without an exponent."""
    return f"{value:,.0f}" if value >= 100 else f"{value:.3g}"


def power(count):
    return f"10^{round(math.log10(count))}"


def transforms(found, exponent):
    """Published times, and those of the model."""
    network = published.network(found, exponent)
    by = {(of.program, of.points, of.ranks): of for of in found}
    rows = []
    for points, ranks in sorted({key[1:] for key in by}):
        modelled = published.seconds(by["P3DFFT", points, ranks], network)
        times = [by[program, points, ranks].total for program in ("P3DFFT", "PencilFFTs")]
        cells = [cell for time in times for cell in (short(1e3 * time), f"{modelled / time:.2f}")]
        rows.append([f"{points}³", f"{ranks:,}", short(1e3 * modelled), *cells])
    fitted = [of for of in found if of.ranks <= published.RANKS]
    ratios, ideal = published.ratios(fitted, exponent), published.ratios(fitted, 0.0)
    header = ["points", "ranks", "model, ms", "P3DFFT, ms", "model over measured", "PencilFFTs, ms", "model over measured"]
    return [
        "### The transform alone, as published for other programs",
        "",
        *prose(f"""A forward and a backward transform of a real field in f64 on nodes of 40 cores with one port of 12.5 GB/s, a
            rank a core, from the result files of PencilFFTs (source in `validation/data/pencil-transforms.csv`). In the model a transform
            along an axis reads and writes the values of a rank once, packing and unpacking twice each exchange, at
            {published.memory_bandwidth(found) / 1e9:.0f} GB/s of a node, the median of what the programs' own timers show. Parts for other
            nodes share the port of the node; parts for ranks of the same node are copied twice. A message takes
            {1e6 * LATENCY:g} microseconds. One number is fitted: the bisection bandwidth of the fat tree grows as nodes^(1 - e), with
            e = {exponent:.3f}. It would be 0 for a tree whose links never thin out and whose routes never collide, and 1/3 for a torus
            of three dimensions."""),
        *table(header, rows),
        "",
        *prose(f"""Up to {published.RANKS:,} ranks all are within a factor of {published.FACTOR}, from {ratios.min():.2f} to {ratios.max():.2f};
            `scripts/validate scale` fails otherwise. With e = 0 they would be from {ideal.min():.2f} to {ideal.max():.2f}. The rows of 16,384
            ranks, 410 nodes, are not fitted. The model is too fast there, and so may be its projections to more nodes."""),
    ]


def calls_of(stored):
    """Calls of an evaluation and of a step, as counted on sixteen ranks in slabs."""
    found = {}
    for case, lubricated, count in (("evaluation", False, counts.EVALUATED), ("step", True, counts.STEPPED)):
        of, plan, slabs = stored["counts"][case]["16"], measured.plan(stored, count, lubricated), 16
        neighbours = 2 * math.ceil(plan.reach * slabs / plan.edge)
        per_image = of["halos_bytes"][1] / images(count, plan, (1, slabs)).count
        sums, halos = of["sums_messages"][1] / math.log2(slabs), of["halos_messages"][1] / neighbours
        found[lubricated] = Calls(sums, halos, per_image, of["groups_calls"][1] / 2)
    return found


def planned_calls():
    """Calls of an evaluation in plans for a network."""
    constants = dict(re.findall(r"^const (\w+): f64 = ([\d.]+);", PLANNER.read_text(), re.M))
    return Calls(*(float(constants[name]) for name in ("SUMS", "EXCHANGES", "IMAGE")), transforms=1.0)


def counted(stored):
    """Messages and bytes of a rank as counted."""
    sent = [[ranks, f"{of['bytes_sent'] / 1e6:.2f}", f"{of['messages_sent']:,}"] for ranks, of in stored["counts"]["evaluation"].items()]
    kinds = []
    for case, of_ranks in ((case, stored["counts"][case]) for case in ("evaluation", "step")):
        for ranks, of in ((ranks, of) for ranks, of in of_ranks.items() if int(ranks) >= 8):
            numbers = [of[f"{kind}_{name}"][1] / unit for name, unit in (("messages", 1), ("bytes", 1e3)) for kind in counts.KINDS]
            kinds.append([case, ranks, *map(short, numbers)])
    step = stored["counts"]["step"]["16"]
    trees = step["sums_messages"][1] / 4
    resumed = [of["sums_calls"][1] for of in stored["counts"]["resumed"].values()]
    of, planned = calls_of(stored)[False], planned_calls()
    header = ["", "ranks", "messages of sums", "of halos", "of transpositions", "kB of sums", "of halos", "of transpositions"]
    return [
        "### Messages and bytes of a rank",
        "",
        *prose(f"""One evaluation of {counts.EVALUATED:,} spheres at 12% with tolerance 1e-3, as `fcm-solve bench` counts it for the rank with
            the most, with the neighbour lists of the evaluation before, on more ranks than this machine has cores.
            {counts.RANKS_PER_NODE} ranks count as a node, within which the grid is
            exchanged through shared memory without messages."""),
        *table(["ranks", "MB sent", "messages"], sent),
        "",
        *prose(f"""By kind, as a counter between the program and MPI finds them, means of the ranks: the same evaluation, and a step of
            {counts.STEPPED:,} spheres at 20% in shear with lubrication. *Sums* are collective calls, each with as many messages as a tree
            of the ranks has levels: sums over the ranks, broadcasts, and the barriers that end an exchange of lists of unknown lengths.
            *Halos* are messages to those ranks that get something: lists, images, what is returned for them, and migration.
            *Transpositions* are those between nodes."""),
        *table(header, kinds),
        "",
        *prose(f"""A step with lubrication makes {trees:.0f} collective calls: {trees * 6:,.0f} messages of a rank on 64 ranks, and
            {trees * 10:,.0f} on 1,024. Those of halos depend on the ranks within reach alone. A run resumed makes
            {resumed[0]:.0f} collective calls before its first step on 8 ranks, {resumed[1]:.0f} on 16."""),
        "",
        *prose(f"""An evaluation has {of.sums:g} messages of sums for each level of the tree, {of.halos:g} messages to each rank within
            reach, and {of.image_bytes:.0f} bytes for each image. Plans for a [network](parallel.md#plans-for-a-network) take
            {planned.sums:g}, {planned.halos:g} and {planned.image_bytes:g}; `scripts/validate scale` fails if one differs by more
            than {DIFFERENCE:.0%}."""),
    ]


def local(stored):
    """Times on one thread, and ratios of sixteen cores."""
    works = measured.works(stored)
    rows = [[f"{coarseness:g}", f"{of.points}³", *(short(1e3 * time) for time in (
        of.of_sphere * of.spheres, of.transform(of.points**3, of.points), of.seconds))] for coarseness, of in works.items()]
    cases = [("evaluation", 10**5), ("evaluation", 10**6), ("step", 50_000)]
    ratios = [[case, f"{count:,}", f"{of.busy:.2f}", f"{of.serial:.1%}"] for case, count in cases for of in [sixteen_cores(case, count)]]
    return [
        "### Work of a rank",
        "",
        *prose(f"""An evaluation of {works[1.0].spheres:,} spheres on one thread, in milliseconds of processor time
            ({stored['work']['processor']}), on the grid of the plan, and on coarser grids with a longer cutoff for the same tolerance:"""),
        *table(["points along an axis", "grid", "spheres", "transform", "total"], rows),
        "",
        *prose(f"""A step with lubrication takes {1e6 * stored['work']['step_of_sphere']:.1f} microseconds of a sphere at 20%. On a node whose
            cores are all at work a core is slower than alone, and threads do not divide all of the work of a rank. Both are
            from sixteen cores (`validation/data/sixteen-cores.csv`): 16 times the time of 16 ranks over that of one, and the share by
            which 16 threads take longer than 16 ranks."""),
        *table(["", "spheres", "slower on a busy node", "serial share of a rank"], ratios),
        "",
    ]


def seconds_table(model):
    """Seconds of evaluations and steps."""
    rows = []
    for node, (spheres, cores), by_domain in ((node, job, by_domain) for node in NODES for job in JOBS for by_domain in (False, True)):
        for lubricated in (False, True):
            job, of_node = Job(spheres, cores, node.cores // node.domains if by_domain else 1, lubricated), model.on(node)
            parts = of_node.parts(job, NOW)
            times = (parts.work, parts.serial, parts.transpositions, parts.halos, parts.messages, parts.total)
            rows.append([f"{node.cores}", power(spheres), f"{cores:,}", f"{job.ranks:,} × {job.threads}", "step" if lubricated else "evaluation",
                         *map(short, times), f"{efficiency(of_node, job, NOW):.0%}"])
    header = ["cores a node", "spheres", "cores", "ranks × threads", "", "work, s", "serial, s", "transpositions, s", "halos, s",
              "messages, s", "total, s", "efficiency"]
    return table(header, rows)


def weak_table(model):
    """Weak efficiency and seconds by design."""
    cases = [(lubricated, node, cores) for lubricated in (False, True) for node in NODES for cores in WEAK]
    rows = []
    for name, design, by_domain in DESIGNS:
        jobs = [(model.on(node), Job(round(SPHERES_A_CORE * cores), cores, node.cores // node.domains if by_domain else 1, lubricated))
                for lubricated, node, cores in cases]
        rows.append([name, *(f"{efficiency(of_node, job, design):.0%}, {short(of_node.parts(job, design).total)}" for of_node, job in jobs)])
    header = [f"{'step' if lubricated else 'evaluation'}, {node.cores} a node, {cores:,}" for lubricated, node, cores in cases]
    return table(["", *header], rows)


def wire_table(model):
    """An evaluation with values of four and of eight bytes."""
    rows = []
    for node, (spheres, cores) in ((node, job) for node in NODES for job in JOBS):
        single, double = (model.on(node).parts(Job(spheres, cores, 1), Design(value_bytes=width)) for width in (4, 8))
        sent_single = double.total - double.transpositions + single.transpositions
        rows.append([f"{node.cores}", power(spheres), f"{cores:,}", *map(short, (single.total, double.total, sent_single))])
    return table(["cores a node", "spheres", "cores", "all in f32, s", "all in f64, s", "f64, sent as f32, s"], rows)


def memory_table(stored):
    """Memory of the largest rank."""
    rows = [[power(spheres), f"{ranks:,}", f"{spheres / ranks:,.0f}", "yes" if lubricated else "no", short(size / 1e9)]
            for spheres, ranks, lubricated, size in stored["plans"]["memory"]]
    return table(["spheres", "ranks", "spheres a rank", "lubrication", "GB of the largest rank"], rows)


def breaks(model, stored):
    """Limits in the order in which they are met, with numbers."""
    plan = measured.plan(stored, 10**9, False)
    grid = Slice(65536, plan.points)
    found = images(10**9, plan, grid.table).count / (10**9 / 65536)
    return [
        "1. **The transpositions**, which are limited by the port of a node and by the fat tree.",
        f"2. **Blocks along x.** Ranks divide the {plan.points // 2:,} coefficients along x in blocks of 16: on 65,536 ranks in "
        f"{grid.table[0]} rows the "
        f"largest share is {grid.unevenness(4)[1]:.1f} times the mean.",
        f"3. **Images.** Pencils of 65,536 ranks are {plan.edge / 256:.1f} radii wide, and a rank has {found:.1f} images of "
        "other ranks' spheres for each "
        "of its own.",
    ]


def projection(stored, exponent):
    """All sections after the published transforms."""
    network = published.network(published.transforms(), exponent)
    ways = (calls_of(stored), sixteen_cores, functools.partial(measured.plan, stored))
    model = Model(network, measured.works(stored), stored["work"]["step_of_sphere"], *ways)
    return [
        *counted(stored),
        *local(stored),
        "### Seconds",
        "",
        *prose("""The program as it is: an evaluation at 12%, a step with lubrication at 20%. Nodes have 40 cores in 2 NUMA domains, a port of
            12.5 GB/s and 150 GB/s of memory, or 128 cores in 8, 25 GB/s and 350 GB/s. Efficiency is relative to a full node with as
            many spheres a core."""),
        *seconds_table(model),
        "",
        "### Weak scaling, and what changes it",
        "",
        *prose(f"""{SPHERES_A_CORE:,.0f} spheres a core: efficiency relative to a full node of the same design, and
            seconds, by cores. A rank a NUMA domain has the serial shares above unless stated otherwise, on the single node too, so that a
            high efficiency may go with a longer time."""),
        *weak_table(model),
        "",
        "### Precision of what is sent",
        "",
        *prose("""An evaluation, a rank a core. Plans with tolerances
            of 1e-6 and above are in f32 as a whole.
            On 65,536 ranks f32 is no faster, since ranks divide its coefficients in larger blocks."""),
        *wire_table(model),
        "",
        "### Memory",
        "",
        *prose("""As `fcm-solve check` predicts it for a run at 12%, or with lubrication at 20%."""),
        *memory_table(stored),
        "",
        "### Limits, in the order in which they are met",
        "",
        *breaks(model, stored),
    ]
