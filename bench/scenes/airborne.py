"""Surveys from the air: strips of scan lines, steep rays, walls that are hardly seen, forests whose ground is seen
through the crowns. LAS or bare text; with the way of the aircraft in one case."""
from dataclasses import dataclass

import numpy as np

from geometry import joined
from rays import Ground, Solid, first_hit, gabled
from writers import write_las, write_way

HEIGHT, SPEED = 350.0, 55.0                   # meters, meters per second
UTM = np.array([691000.0, 5334000.0, 410.0])
START = 245000.0                              # GPS seconds of the week
GROUND, OTHER, BUILDING, HIGH = 2, 1, 6, 5    # LAS classes


@dataclass
class Pulses:
    origins: np.ndarray
    ways: np.ndarray             # unit
    times: np.ndarray
    strips: np.ndarray

    def __getitem__(self, chosen):
        return Pulses(self.origins[chosen], self.ways[chosen], self.times[chosen], self.strips[chosen])

    def at(self, reach):
        return self.origins + reach[:, None] * self.ways


def flown(size, spacing, strips, rng):
    """Pulses over a square: the mirror swings, so that scan lines are zigzag and denser where it turns."""
    half = size / strips / 2 * 1.35                             # of the swath: strips overlap
    parts = []
    for strip in range(strips):
        center = size * (strip + 0.5) / strips
        count = int(2 * half * size / spacing**2)
        along = np.linspace(-5, size + 5, count)
        phase = along / spacing / 2                             # one line for each spacing, there and back
        swing = 4 * np.abs(phase - np.floor(phase + 0.5)) - 1
        angle = np.arctan(half / HEIGHT) * (0.8 * np.sin(swing * np.pi / 2) + 0.2 * swing)
        along = along if strip % 2 == 0 else along[::-1]
        origins = np.stack([np.full(count, center), along, np.full(count, HEIGHT)], axis=1)
        ways = np.stack([np.sin(angle), rng.normal(0, 5e-4, count), -np.cos(angle)], axis=1)
        times = START + 200 * strip + np.arange(count) / count * (size + 10) / SPEED
        parts.append(Pulses(origins, ways / np.linalg.norm(ways, axis=1)[:, None], times, np.full(count, strip)))
    return Pulses(*(np.concatenate([getattr(p, k) for p in parts]) for k in ("origins", "ways", "times", "strips")))


@dataclass
class Seen:
    """Returns, each of one pulse."""
    pulses: Pulses
    positions: np.ndarray
    normals: np.ndarray
    classes: np.ndarray = GROUND
    number: np.ndarray = 1
    of: np.ndarray = 1


def seen(ground, solids, pulses, rng, noise=0.025):
    """Single returns; a few per cent of the pulses have none."""
    reach, normals = first_hit(pulses.origins, pulses.ways, solids, ground.hit)
    back = np.isfinite(reach) & (rng.random(len(reach)) > 0.03)
    pulses, reach, normals = pulses[back], reach[back], normals[back]
    return Seen(pulses, blurred(pulses, reach, rng, noise), normals)


def blurred(pulses, reach, rng, noise):
    """Errors along the ray; each strip lies a few centimeters off."""
    off = rng.normal(0, 0.02, (pulses.strips.max() + 1, 3))
    return pulses.at(reach + rng.normal(0, noise, len(reach))) + off[pulses.strips]


def as_text(kit, found, truth):
    positions = np.round(found.positions, 2)
    return kit.bare(positions, 2, truth, outward=found.normals, towards=found.pulses.origins)


def as_las(kit, found, truth, way=False, **known):
    p = found.pulses
    positions = write_las(kit.folder / "input.las", found.positions + UTM, p.times, 7326 + p.strips, found.number,
                          found.of, found.classes)
    made = kit.made(["input.las"], positions, None, (truth[0] + UTM, truth[1]), outward=found.normals,
                    towards=p.origins + UTM, **known)
    if way:
        made.trajectory = "flight.txt"
        rows = np.concatenate([flight(p[p.strips == strip]) for strip in np.unique(p.strips)])
        write_way(kit.folder / made.trajectory, rows[:, 0], rows[:, 1:] + UTM)
    return made


def flight(pulses, count=20):
    """Rows of time and place along one strip, from before its first pulse until after its last."""
    time = np.linspace(pulses.times.min() - 0.5, pulses.times.max() + 0.5, count)
    speed, begin = np.polyfit(pulses.times - time[0], pulses.origins[:, 1], 1)
    x, _, z = pulses.origins[0]
    return np.stack([time, np.full(count, x), begin + speed * (time - time[0]), np.full(count, z)], axis=1)


def relief(heights, written, size=150.0, spacing=1.0):
    """A maker of bare ground."""
    def make(kit):
        ground = Ground(heights, (-5, -5), (size + 5, size + 5))
        found = seen(ground, (), flown(size, spacing, 2, kit.rng), kit.rng)
        return written(kit, found, ground.mesh(1.0))
    return make


def bowl(x, y):
    return 24 * ((x - 75)**2 + (y - 75)**2) / 75**2 + 0.3 * np.sin(x / 4) * np.sin(y / 5)


def valley(x, y):
    return 22 * (x - 75 - 12 * np.sin(y / 40))**2 / 75**2 + 0.06 * y + 0.3 * np.sin(x / 5) * np.sin(y / 4)


def hill(x, y):
    return 30 * np.exp(-((x - 70)**2 + (y - 80)**2) / 45**2) + 0.2 * np.sin(x / 4) * np.sin(y / 5)


def slope(x, y):
    return 0.25 * x - 0.1 * y


def cliff(x, y):
    """A step of 25 m, 80 degrees steep, with ledges along it."""
    edge = 75 + 10 * np.sin(y / 22) + 2 * np.sin(y / 5)
    return 12.5 * np.tanh((x - edge) / 2.2) + 0.05 * x + 0.3 * np.sin(x / 4) * np.sin(y / 5)


def tilted(x, y):
    return 0.06 * x + 0.03 * y + 0.4 * np.sin(x / 25) * np.cos(y / 30)


def river(x, y):
    return np.abs(y - 100 - 18 * np.sin(x / 35)) < 11


def town(kit, way=False):
    """Gabled houses on tilted ground, their walls hardly seen; a river from which next to nothing returns."""
    size = 200.0
    ground = Ground(tilted, (-5, -5), (size + 5, size + 5))
    houses = []
    for x in np.arange(15, 195, 24):
        for y in (18, 45, 70, 140, 168, 190):
            here = np.array([x, y]) + kit.rng.uniform(-2.5, 2.5, 2)
            length, width, eaves = kit.rng.uniform((8, 7, 3.2), (15, 11, 8))
            if kit.rng.random() < 0.85 and not river(*(here + (0, 14))) and not river(*(here - (0, 14))):
                floor = (*here, tilted(*here) - 1.5)
                houses.append(Solid(gabled(floor, length, width, eaves + 1.5, eaves + 1.5 + width * 0.35)))
    found = seen(ground, houses, flown(size, 1.05, 3, kit.rng), kit.rng)
    on_roof = found.positions[:, 2] - tilted(*found.positions[:, :2].T) > 0.5
    stays = on_roof | ~river(*found.positions[:, :2].T) | (kit.rng.random(len(on_roof)) < 0.004)
    found = Seen(found.pulses[stays], found.positions[stays], found.normals[stays],
                 np.where(on_roof[stays], BUILDING, GROUND))
    return as_las(kit, found, joined(ground.mesh(1.0), *(h.mesh for h in houses)), way)


def town_with_way(kit):
    return town(kit, way=True)


def wooded(x, y):
    return 6 * np.sin(x / 28) * np.cos(y / 33) + 0.12 * x


def chords(pulses, crown):
    """Where pulses enter and leave an ellipsoid (center, radii); inf, -inf when they miss it."""
    center, radii = crown
    o, w = (pulses.origins - center) / radii, pulses.ways / radii
    a, b, c = (w * w).sum(axis=1), (o * w).sum(axis=1), (o * o).sum(axis=1) - 1
    square = b * b - a * c
    root = np.sqrt(np.maximum(square, 0))
    return np.where(square > 0, (-b - root) / a, np.inf), np.where(square > 0, (-b + root) / a, -np.inf)


def forest(kit):
    """Crowns let part of each pulse through: up to four returns, the last of many from the ground."""
    size = 100.0
    ground = Ground(wooded, (-5, -5), (size + 5, size + 5))
    pulses = flown(size, 0.75, 2, kit.rng)
    reach, normals = ground.hit(pulses.origins, pulses.ways)
    within = np.isfinite(reach)
    pulses, reach, normals = pulses[within], reach[within], normals[within]
    hits = [np.full(len(reach), np.inf)] * 3                     # of the crowns, the nearest first
    for _ in range(170):
        x, y = kit.rng.uniform(0, size, 2)
        if np.hypot(x - 60, y - 45) < 14:                        # a clearing
            continue
        tall, wide, deep = kit.rng.uniform((12, 1.8, 3.5), (24, 3.4, 6.5))
        center = np.array([x, y, wooded(x, y) + tall - deep])
        near = np.abs(pulses.origins + ((HEIGHT - center[2]) * pulses.ways / -pulses.ways[:, 2:]) - center)
        beside = np.flatnonzero((near[:, :2] < wide + 3).all(axis=1))
        into, out = chords(pulses[beside], (center, np.array([wide, wide, deep])))
        at = into + kit.rng.exponential(1.3, len(beside))        # how deep the leaves let it
        for _ in range(2):
            inside = at < out
            more = np.full(len(reach), np.inf)
            more[beside[inside]] = at[inside]
            hits = list(np.sort(np.stack([*hits, more]), axis=0)[:3])
            at = at + 1.2 + kit.rng.exponential(2.2, len(beside))
    return returned(kit, ground, pulses, reach, normals, hits)


def returned(kit, ground, pulses, reach, normals, hits):
    """Each return leaves less for what lies behind."""
    rows, left = [], np.ones(len(reach))
    for at in [*hits, reach]:
        back = np.isfinite(at) & (at <= reach) & (kit.rng.random(len(at)) < 0.97) & (left > 0.15)
        rows.append(np.where(back, at, np.inf))
        left = np.where(back, left * kit.rng.uniform(0.2, 0.75, len(at)), left)
    back = np.isfinite(np.array(rows))
    number, of = back.cumsum(axis=0), back.sum(axis=0)
    pulse = np.concatenate([np.flatnonzero(b) for b in back])
    order = np.argsort(pulse, kind="stable")
    level = np.concatenate([np.full(b.sum(), k) for k, b in enumerate(back)])[order]
    pulse = pulse[order]
    onto = level == 3
    chosen = pulses[pulse]
    positions = blurred(chosen, np.array(rows)[level, pulse], kit.rng, 0.03)
    found = Seen(chosen, positions, np.where(onto[:, None], normals[pulse], (0, 0, 1.0)),
                 np.where(onto, GROUND, HIGH), number[level, pulse], of[pulse])
    return as_las(kit, found, ground.mesh(1.0), sided=onto)
