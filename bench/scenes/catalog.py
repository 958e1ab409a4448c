"""All scenes: what each is, how it is made, what is right."""
from dataclasses import dataclass

import airborne
import clouds
import depth_camera
import scanned
import sweeps
import thin


@dataclass(frozen=True)
class Scene:
    name: str
    title: str
    make: callable               # Kit -> Made
    spacing: float               # of the samples where they are thin but still a surface: a sensible voxel
    components: int = None       # of the right surface, None: not judged
    genus: int = None
    open: bool = False           # the right surface has a border
    reach: callable = None       # positions, voxel -> mask of the samples that may not be lost; None: all
    view: str = "-1,-2,1.4"      # of the picture
    up: str = "z"
    cut: tuple = None            # (axis, share): the picture leaves out what lies beyond, to look inside
    copy_of: str = ""            # file of the folder: the surface must be that of this cloud alone
    kind: str = ""               # of verdicts.LIMITS
    warned: str = ""             # word of a warning that must be there


SCENES = (
    # As scanners see it.
    Scene("room_inside", "a furnished room from two places inside it, mixed pixels", scanned.room, 0.02, 1, 3,
          cut=(2, 0.93)),
    Scene("room_xyz", "the same as bare points", scanned.room_as_points, 0.02, 1, 3, cut=(2, 0.93)),
    Scene("depth_image", "one depth image of it", scanned.depth_image, 0.012, open=True, cut=(2, 0.93)),
    Scene("grazing", "a floor and a house front by one tripod, thinned to even density", scanned.grazing, 0.06,
          open=True),
    Scene("yard", "the same as the scanner takes it", scanned.yard, 0.05, open=True),
    Scene("glass_front", "posts and rails of a shop front, panes that return nothing", scanned.glass_front, 0.02,
          open=True),
    Scene("street", "one sweep of 64 rings from a car, ghosts below the road", scanned.street, 0.1, open=True,
          reach=scanned.street_reach),
    Scene("tunnel", "a vaulted tunnel from two places, open at both ends", scanned.tunnel, 0.03, 1, open=True,
          view="-2,-1,0.3"),
    Scene("facade", "a house front from the pavement, nothing behind it", scanned.facade, 0.04, open=True),
    Scene("terrain_als", "aerial lidar: hills, houses, trees; UTM, bare points", scanned.terrain, 0.5, open=True),
    Scene("standstill", "a robot with 16 rings stands for 60 sweeps, then drives 24", scanned.standstill, 0.05, 1, 0,
          cut=(2, 0.93)),
    Scene("bin", "an open bin, its inside half seen", scanned.trash_bin, 0.6, 1, 0, view="-1,-2,2.5"),
    Scene("on_table", "two balls that touch and a tin on a table, from above", scanned.table_top, 0.5, 1, open=True),
    Scene("statue_base", "a ring on a block, 24 scans, bottom unseen", scanned.statue, 0.8, 1, 1),
    Scene("drift", "the same, 2.5 spacings off where the walk closes", scanned.drift, 0.8, 1, 1),
    Scene("poster", "a flat wall by one tripod, nothing else", scanned.poster, 0.012, 1, 0, open=True),
    # One sweep, out to 100 m.
    Scene("sweep_16", "16 rings on a flat yard, cars and house fronts", sweeps.robot, 0.3, open=True, kind="sweep"),
    Scene("sweep_64_slope", "64 rings on a road that climbs by 8 %, as KITTI", sweeps.uphill, 0.2, open=True,
          kind="sweep"),
    Scene("sweep_128_hollow", "128 rings where the ground rolls", sweeps.hollow, 0.2, open=True, kind="sweep"),
    # From the air.
    Scene("als_bowl", "strips over a bowl, LAS", airborne.relief(airborne.bowl, airborne.as_las), 1.0, open=True,
          kind="airborne ground"),
    Scene("als_valley", "strips over a valley, bare points", airborne.relief(airborne.valley, airborne.as_text), 1.0,
          open=True, kind="airborne ground"),
    Scene("als_hill", "strips over a hill, bare points", airborne.relief(airborne.hill, airborne.as_text), 1.0,
          open=True, kind="airborne ground"),
    Scene("als_slope", "strips over a tilted plane, bare points", airborne.relief(airborne.slope, airborne.as_text),
          1.0, open=True, kind="airborne ground"),
    Scene("als_cliff", "strips over a step of 25 m, LAS", airborne.relief(airborne.cliff, airborne.as_las), 1.0,
          open=True, kind="airborne ground"),
    Scene("als_town", "strips over roofs and a river, walls hardly seen, LAS", airborne.town, 1.0, open=True,
          kind="airborne ground"),
    Scene("als_town_way", "the same with the way of the aircraft", airborne.town_with_way, 1.0, open=True,
          kind="airborne ground"),
    Scene("als_forest", "ground seen through crowns, up to four returns, LAS", airborne.forest, 0.8, open=True,
          kind="airborne forest"),
    # A depth camera, its noise growing with the square of the distance.
    Scene("depth_frames", "ten posed frames of a room that overlap", depth_camera.frames, 0.015, open=True,
          view="1,2,1.4", kind="depth frames"),
    Scene("fragment", "ten fused frames of it near one place, the camera told", depth_camera.fragment, 0.012,
          open=True, view="0.6,-0.9,-1.6", up="-y", kind="room with camera"),
    Scene("fragment_bare", "the same without the camera", depth_camera.fragment_bare, 0.012, open=True,
          view="0.6,-0.9,-1.6", up="-y", warned="--sensor"),
    # Thin, long, open.
    Scene("falloff", "floor and front, density 100:1 by distance, true normals", thin.falloff, 0.06, open=True),
    Scene("thin_sheet_15", "a bent sheet 1.5 spacings thick", thin.sheet(1.5), 1.0, 1, 0, view="1,-2,0.6"),
    Scene("thin_sheet_10", "1.0 thick", thin.sheet(1.0), 1.0, 1, 0, view="1,-2,0.6"),
    Scene("thin_sheet_07", "0.7 thick", thin.sheet(0.7), 1.0, 1, 0, view="1,-2,0.6"),
    Scene("thin_sheet_05", "0.5 thick", thin.sheet(0.5), 1.0, 1, view="1,-2,0.6"),
    Scene("blade", "a twisted blade, 5 to 0.6 spacings thick", thin.blade, 1.0, 1, 0),
    Scene("fence", "bars three spacings thick, rails, cables of two", thin.fence, 1.0, view="1,-2,0.6"),
    Scene("garden_wall", "100 m long, 0.2 m thick, both sides", thin.garden_wall, 0.035, 1, 0),
    Scene("wall_uneven", "both sides of a wall, density 100:1 along it", thin.uneven_wall, 0.1, 1, 0),
    Scene("annulus", "the upper side of a flange with bolt holes", thin.flange, 0.6, 1),
    Scene("cyl_open", "the side of a tin, open at both ends, bare points", thin.tin, 1.0, 1),
    # Something wrong with the cloud.
    Scene("outlier_10", "a knot, 10 % outliers with random normals", clouds.outliers(0.1), 0.008, 1, 4),
    Scene("outlier_40", "40 % of them", clouds.outliers(0.4), 0.008, 1, 4),
    Scene("flip_random_10", "10 % of the normals turned round", clouds.flipped(0.1), 0.008, 1, 4),
    Scene("flip_random_30", "30 % of them", clouds.flipped(0.3), 0.008, 1, 4),
    Scene("flip_patch", "all normals of one side turned round", clouds.flipped_patch, 0.008, 1, 4),
    Scene("pca_sign", "normals with the sign that the eigen-solver gave", clouds.flipped(0.5), 0.008, 1, 4),
    Scene("near_copies", "six exports of one cloud, other decimals", clouds.copies(False), 0.011, 1, 4,
          copy_of="one.ply"),
    Scene("dup10", "the same cloud ten times", clouds.copies(True), 0.011, 1, 4, copy_of="one.ply"),
    Scene("weights", "a second, wrong copy with small weights", clouds.weights, 0.009, 1, 4),
    Scene("thick_noise", "200,000 samples, noise of four spacings", clouds.thick_noise, 0.01, 1, 4),
    Scene("mvs_noise", "smooth errors of a stereo cloud, 3 % mismatches", clouds.stereo, 0.008, 1, 4),
    Scene("units", "a part of a micrometre in meters, one meter off", clouds.units(1e-6, (1.0, 2.0, -3.0)), 1.1e-8, 1,
          4),
    Scene("units_big", "the same at a scale of a million", clouds.units(1e6, (0.0, 0.0, 0.0)), 1.1e4, 1, 4),
    Scene("few_20", "20 samples of a ball", clouds.few(20), 0.8, 1, 0),
    Scene("few_50", "50 samples", clouds.few(50), 0.5, 1, 0),
    Scene("few_200", "200 samples", clouds.few(200), 0.25, 1, 0),
    Scene("cube_grid", "a cube with a square hole, samples on the integers", clouds.lattice_part, 1.0, 1, 1),
    Scene("no_normals", "bare points of a knot, slightly noisy", clouds.bare, 0.011, 1, 4),
    Scene("zero_normals", "columns of normals, all zero", clouds.zero_normals, 0.011, 1, 4),
    Scene("hopf", "a torus on a grid of parameters, spacing 1:8, bare points", clouds.hopf, 0.15, 1, 1),
    Scene("ct_voxels", "border voxels of a segmented ball with three bores, integers", clouds.ct_voxels, 1.0, 1, 5),
)
