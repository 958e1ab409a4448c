"""Scenes as a scanner sees them that stands in the air: all on the virtual scanner."""
import numpy as np
from scipy.spatial import cKDTree

import geometry
from geometry import ball, block, joined, rectangle, tube, turned
from kit import Made
from peers import columns, read_vertices


def room(kit):
    return kit.scan("room", "--noise", 0.003, "--mixed-pixels", 0.3)


def room_as_points(kit):
    made = room(kit)
    order = kit.rng.permutation(len(made.positions))
    return kit.bare(made.positions[order], 4, "truth.ply", good=made.good[order], outward=made.outward[order],
                    towards=made.towards[order])


def depth_image(kit):
    return kit.scan("room", "--rays", "central", "--position=5.6,3.6,1.7", "--target=2,1.2,0.6", "--image", "320x240",
                    "--noise", 0.004, "--mixed-pixels", 0.5)


def grazing(kit):
    """Thinned to even density, as exports are: the angle of the rays alone tells how far the scanner was."""
    kit.run("scan", "yard", "-o", kit.folder, "--samples", 170000, "--directions", "views", "--position=0,0,1.6",
            "--noise", 0.003, "--seed", kit.seed)
    positions, sensors = samples_with_sensors(kit)
    far = np.hypot(positions[:, 0], positions[:, 1]) > 1
    positions, sensors = positions[far], sensors[far]
    return kit.cloud(positions, sensors=sensors, towards=sensors, truth="truth.ply")


def samples_with_sensors(kit):
    vertices = read_vertices(kit.folder / "samples.ply")
    (kit.folder / "samples.ply").unlink()
    return columns(vertices, "x", "y", "z"), columns(vertices, "sensor_x", "sensor_y", "sensor_z")


def yard(kit):
    return kit.scan("yard", "--noise", 0.003, "--image", "1200x300", "--span=-60,60")


def glass_front(kit):
    """Posts and rails of a shop front return, the panes do not; behind them a back wall and a floor."""
    posts = [block((x, 0, 0), (x + 0.06, 0.1, 3)) for x in np.arange(0, 10, 1.2)]
    rails = [block((0, 0, z), (10, 0.1, z + 0.08)) for z in (0.0, 1.1, 2.92)]
    hall = [rectangle((-4, -8, -0.01), (18, 0, 0), (0, 13, 0)), rectangle((-4, 5, 0), (18, 0, 0), (0, 0, 3.2))]
    return kit.scan("front.ply", "--rays", "spinning", "--position=2,-2.5,1.5", "--position=7,-1.2,1.5", "--image",
                    "900x260", "--span=-40,50", "--noise", 0.003, "--max-incidence", 89, "--mixed-pixels", 0.3,
                    mesh=joined(*posts, *rails, *hall))


def street(kit):
    return kit.scan("street", "--noise", 0.02, "--ghosts", 0.005, "--max-range", 70)


def street_reach(positions, voxel):
    """Out to where neighboring rings, 0.4 degrees apart at 1.73 m, lie 20 voxels apart on the road."""
    reach = np.sqrt(20 * voxel * 1.73 / np.radians(26.8 / 63))
    return np.hypot(positions[:, 0], positions[:, 1]) < reach


def tunnel(kit):
    return kit.scan("tunnel", "--noise", 0.004, "--image", "720x180")


def terrain(kit):
    """Aerial lidar as offices send it: UTM, text with two decimals, no normals. The crowns of trees, balls of a few
    samples each in the air, may be lost."""
    made = kit.scan("terrain", "--noise", 0.03)
    made.positions = np.round(made.positions + kit.rng.normal(0, 0.05, made.positions.shape) * (1, 1, 0), 2)
    utm = np.array([452310.0, 5411220.0, 312.0])
    from_file = geometry.read_mesh(kit.folder / "truth.ply")
    ground_and_houses = 251**2 + 4 * 6 * 4  # vertices, the first of the mesh
    made.good &= cKDTree(from_file[0]).query(made.positions)[1] < ground_and_houses
    geometry.write_mesh(kit.folder / "truth-utm.ply", (from_file[0] + utm, from_file[1]))
    return kit.bare(made.positions + utm, 2, "truth-utm.ply", good=made.good, outward=made.outward,
                    towards=made.towards + utm)


def facade(kit):
    return kit.scan("facade", "--noise", 0.005, "--image", "900x150")


def carved_face(wave):
    """The face of a stone 1.5 m from the scanner: crosswise waves, an eighth of their length high."""
    x, z = np.meshgrid(np.linspace(-0.6, 0.6, 481), np.linspace(0, 1.2, 481), indexing="ij")
    waves = wave / 8 * np.sin(2 * np.pi * x / wave) * np.sin(2 * np.pi * z / wave)
    return geometry.grid_mesh(np.stack([x, 1.5 - waves, z], axis=2))


def carved(wave):
    """A carved stone beside the scanner, on a floor out to 20 m; its face alone is face.ply."""
    def make(kit):
        face = carved_face(wave)
        geometry.write_mesh(kit.folder / "face.ply", face)
        floor = rectangle((-20, -20, 0), (40, 0, 0), (0, 40, 0))
        stone = block((-0.6, 1.55, 0), (0.6, 1.9, 1.2), ("-z", "-y"))
        return kit.scan("carved.ply", "--rays", "spinning", "--position=0,0,1", "--image", "2400x500", "--span=-50,30",
                        "--noise", 0.0005, "--max-range", 25, "--max-incidence", 89, mesh=joined(floor, stone, face))
    return make


def standstill(kit):
    """A robot with 16 rings stands for 60 sweeps, then drives 24 m along a corridor."""
    corridor = joined(turned(block((-4, -1.5, 0), (30, 1.5, 2.5))), block((10, 0.8, 0), (11, 1.5, 2), ("-z", "+y")),
                      block((18, -1.5, 0), (19, -0.7, 1), ("-z", "-y")))
    places = [f"--position={max(0, k - 59)},0,0.6" for k in range(84)]
    rings = ",".join(f"{e:g}" for e in np.linspace(15, -15, 16))
    return kit.scan("corridor.ply", "--rays", "spinning", f"--rings={rings}", "--image", "360x1", "--noise", 0.01,
                    "--max-range", 25, "--max-incidence", 89.5, *places, mesh=corridor)


def trash_bin(kit):
    """Open at the top, walls of 1.5 of 40; the bottom and most of the inside never seen."""
    outer, inner = block((-20, -15, 0), (20, 15, 50), ("+z",)), block((-18.5, -13.5, 1.5), (18.5, 13.5, 50), ("+z",))
    rim = [block((-20, -15, 49.99), (-18.5, 15, 50)), block((18.5, -15, 49.99), (20, 15, 50)),
           block((-18.5, -15, 49.99), (18.5, -13.5, 50)), block((-18.5, 13.5, 49.99), (18.5, 15, 50))]
    around = [f"--position={90 * np.cos(a):.3f},{90 * np.sin(a):.3f},{75 if k % 2 else 135}"
              for k, a in enumerate(np.arange(14) * np.pi / 7)]
    return kit.scan("bin.ply", "--position=-12,4,170", "--position=12,4,170", *around, "--target=0,0,25", "--image",
                    "130x130", "--noise", 0.05, mesh=joined(outer, turned(inner), *rim))


def table_top(kit):
    """Two balls that touch and a tin, seen from above only."""
    things = joined(rectangle((-45, -35, 0), (90, 0, 0), (0, 70, 0)), ball((-10, 0, 10), 10), ball((10, 0, 10), 10),
                    tube([(28, 18, 0), (28, 18, 8), (28, 18, 16)], 7, 48))
    around = [f"--position={120 * np.cos(a):.3f},{120 * np.sin(a):.3f},90" for a in np.arange(8) * np.pi / 4]
    return kit.scan("table.ply", *around, "--target=0,0,8", "--image", "170x140", "--noise", 0.05, mesh=things)


def statue_scans(kit):
    """A ring on a block: 24 views around it, its bottom never seen."""
    a = np.linspace(0, 2 * np.pi, 97)[:-1]
    ring = tube(np.stack([30 * np.cos(a), 0 * a, 30 * np.sin(a) + 60], axis=1), 10, 32, closed=True)
    around = [f"--position={150 * np.cos(a):.3f},{150 * np.sin(a):.3f},70" for a in np.arange(24) * np.pi / 12]
    return kit.scan("statue.ply", *around, "--target=0,0,50", "--image", "110x110", "--noise", 0.15, "--max-incidence",
                    75, mesh=joined(ring, block((-25, -18, 0), (25, 18, 21))))


def statue(kit):
    return statue_scans(kit)


def drift(kit):
    """The same walk, each scan a little farther off: 2.5 spacings when the loop closes."""
    made = statue_scans(kit)
    stands, of_sample = np.unique(made.sensors, axis=0, return_inverse=True)
    angle = np.arctan2(stands[:, 1], stands[:, 0]) % (2 * np.pi)
    files, positions, sensors = [], made.positions.copy(), made.sensors.copy()
    for k in np.argsort(angle):
        of_scan, part = of_sample.ravel() == k, angle[k] / (2 * np.pi) - 0.5
        c, s = np.cos(0.02 * part), np.sin(0.02 * part)
        turn, shift = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]), part * np.array([1.5, 1.0, 0.8])
        positions[of_scan], sensor = made.positions[of_scan] @ turn.T + shift, stands[k] @ turn.T + shift
        sensors[of_scan] = sensor
        files.append(f"input_{len(files):02d}.ply")
        comment = "sensor %.9g %.9g %.9g" % tuple(sensor)
        geometry.write_cloud(kit.folder / files[-1], positions[of_scan], comments=[comment])
    return Made(files, positions, sensors=sensors, good=made.good, outward=made.outward, towards=sensors,
                truth="truth.ply")


def poster(kit):
    """A flat wall by one tripod, nothing else."""
    x, z = np.meshgrid(np.arange(0, 4, 0.012), np.arange(0, 3, 0.012))
    positions = np.stack([x.ravel(), 0 * x.ravel(), z.ravel()], axis=1)
    stand = np.array([2, -4, 1.6])
    ways = positions - stand
    positions = positions + ways / np.linalg.norm(ways, axis=1)[:, None] * kit.rng.normal(0, 0.002, len(ways))[:, None]
    sensors = np.broadcast_to(stand, positions.shape)
    return kit.cloud(positions, sensors=sensors, towards=sensors, truth=rectangle((0, 0, 0), (4, 0, 0), (0, 0, 3)),
                     outward=np.broadcast_to([0, -1.0, 0], positions.shape))
