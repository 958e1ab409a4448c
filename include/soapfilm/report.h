// The report of a reconstruction: report.json, key by key in docs/reference/report.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "soapfilm/mesh.h"
#include "soapfilm/params.h"
#include "soapfilm/simplify.h"

namespace SOAPFILM_API soapfilm {

struct StageTime {
  std::string name;
  double elapsed = 0, cpu = 0;  ///< seconds: wall clock; CPU of all threads of the run
};

/// Where each sample's direction came from: counts of samples.
struct OrientReport {
  size_t from_normals = 0, from_sensor = 0, from_scan = 0;
  size_t from_planes = 0;    ///< of those two, by `automatic`: now normals of planes through neighbors, same side
  size_t far_planes = 0;     ///< samples along lines, such as rings, whose plane comes from beyond their neighbors
  size_t without_plane = 0;  ///< samples without a given normal that have no plane around them either
  size_t estimated = 0;
  std::string assumed;  ///< one line: what the sides of samples without any direction follow from; empty: nothing
  bool inward = false;  ///< the given normals mostly point towards the center of the samples
  size_t without_direction = 0;  ///< their direction is zero: no neighbors that span a plane
  double contradicting = 0;      ///< share of pairs of neighboring directions on one plane that contradict, [0, 1]
  size_t reoriented = 0;         ///< normals whose sign was therefore not used and is now reversed
  std::vector<std::string> warnings;
};

struct InputFacts {
  size_t samples = 0;
  size_t dropped = 0, no_return = 0;  ///< by the reader: not finite, and rays that met nothing
  size_t scans = 0;
  Box3d box;
  std::string coordinate_system;  ///< see PointCloud
  double density = 0;             ///< samples per voxel^2 of surface
  OrientReport directions;
  double noise = 0;  ///< standard deviation of the samples along the surface's normal, input units; 0: unknown
};

/// The finest grid.
struct GridFacts {
  Vec3i size;          ///< vertices along each of its axes, padding included
  int axis_shift = 0;  ///< its axis k is the world's axis (k + axis_shift) % 3
  int levels = 1;      ///< of the pyramid; level 0 is the finest
  int padding = 6;     ///< cells between the samples' box and the border
  double voxel = 1;    ///< edge of a cell, input units
  Vec3d first_vertex;  ///< world position of vertex (0, 0, 0)
  bool open = false;   ///< the surface may end at the border, at no cost
};

/// Energies of equation (4), E(u) = lambda TV(u) - <f, u>, and its dual: E(u) >= optimum >= D(p) on the whole domain.
struct Energies {
  double total_variation = 0;  ///< TV(u), whole domain
  double data = 0;             ///< <f, u>
  double primal = 0;           ///< lambda TV(u) - <f, u>
  double dual = 0;             ///< D(p), whole domain
  double gap = 0;              ///< sum of the local terms, each >= 0; equals primal - dual except for rounding
  double gap_band = 0;         ///< the part of the gap that the band can still reduce
  double max_dual_norm = 0;    ///< max |p| / lambda over the band, before any rescaling

  /// Relative to max(|D|, 1000 lambda).
  double relative_gap(double lambda) const;
  double relative_gap_band(double lambda) const;
};

/// Energies and bounds on the finest grid, valid for the whole domain.
struct Certificate {
  double lambda = 0;
  Energies relaxed;   ///< of the relaxed u and of p
  Energies binary;    ///< of the thresholded u, from which the mesh is made, and the same p
  size_t inside = 0;  ///< thresholded vertices inside, whole domain

  double relative_gap() const { return relaxed.relative_gap(lambda); }
  double relative_gap_binary() const { return binary.relative_gap(lambda); }
  /// Relative to the area term: at most so much less area and misfit could the optimum have.
  double gap_per_area() const;
  double gap_per_area_binary() const;
};

/// Parts supported by too few samples.
struct ComponentReport {
  struct Count {
    size_t kept = 0, dropped = 0;
  };
  Count objects, cavities;     ///< parts of the inside, and of the outside without the outermost
  size_t samples = 0;          ///< sum of weights on surfaces of dropped parts; a sample on two of them counts twice
  double area = 0;             ///< of these surfaces, voxel^2
  size_t vertices = 0;         ///< of the grid, that changed their label
  double highest_dropped = 0;  ///< largest support of a dropped part; 0 if there is none
  double lowest_kept = 0;      ///< smallest support of a kept part
};

/// How the surface was moved onto the samples.
struct RefineReport {
  double smoothing = 0;  ///< gamma used: weight of curvature against one sample, lattice units
  double normals = 0;    ///< weight used of a direction's error (of unit vectors) against one voxel
  double noise = 0;      ///< estimated standard deviation of the samples along the surface's normal, voxels
  double spacing = 1;    ///< of the vertices used by the fit, voxels: 1, 2, 4, ...
};

struct RelaxReport {
  size_t split_edges = 0, triangles_before = 0;
};

/// A part of the surface that no sample is near: a hole in the sampling.
struct HoleFacts {
  Vec3d center;         ///< of its area, input units
  double diameter = 0;  ///< of its rim
  double area = 0;
  bool cut = false;  ///< trimmed away; else filled
};

/// How much, and how sure: lengths in input units.
struct MeasureReport {
  double area = 0;                      ///< times a voxel: change of volume when the surface moves by it
  double filled_area = 0;               ///< of holes that were filled: nobody saw it
  std::optional<double> volume;         ///< of a closed mesh, >= 0
  std::optional<double> volume_flat;    ///< with its holes filled flat; absent for an open mesh
  std::optional<double> volume_smooth;  ///< with its holes curved as what is around; absent if they were not
  std::vector<HoleFacts> holes;         ///< the largest first
};

struct TrimReport {
  double distance = 0;             ///< used, input units
  size_t removed = 0, filled = 0;  ///< regions far from all samples, or facing none: cut away, and left as filled holes
  size_t unfaced = 0, crossed = 0;   ///< of those cut away: near samples that look to the other side; crossed by rays
  double removed_area = 0;           ///< of all that was cut away, as a share of the mesh's area, [0, 1]
  size_t shells = 0, leftovers = 0;  ///< dropped: closed parts of negative volume; small pieces left by the cuts
  bool nothing_near = false;         ///< no surface is within the distance: the mesh is unchanged
  std::vector<HoleFacts> holes;      ///< cut away or filled
};

/// Does the mesh contain what the samples show, and nothing else? "Far": more than 3 voxels.
struct SelfCheckReport {
  size_t samples = 0;              ///< compared
  size_t places = 0;               ///< compared points on the surface, one on some triangles; weighted by triangle area
  double lost = 0;                 ///< share of these samples, by weight, that are far from the mesh, [0, 1]
  double outliers = 0, alone = 0;  ///< shares of the lost ones: neighbors show no surface; hardly any; [0, 1], guesses
  double noise = 0;                ///< standard deviation of the noise, voxels, if it loses most of them; else 0
  double invented = 0;             ///< share of the surface that is far from every sample, [0, 1]
};

struct ScannerReport {
  size_t scanners = 0;  ///< whose positions in the solution were examined
  size_t in_solid = 0;  ///< inside of solid matter
  size_t enclosed = 0;  ///< in the air, with solid matter in both directions along each axis
};

/// Further keys of report.json: levels, comparison methods, cross-validation.
struct ReportDetails;
/// Layout version of report.json: unchanged by a new key, increased when a meaning changes.
inline constexpr int report_version = 1;

struct ReconstructReport {
  std::string command;  ///< as typed; empty when called as a library
  ReconstructParams params;
  InputFacts input;
  GridFacts grid;
  Border outside = Border::air;               ///< the choice of what lies beyond the box
  std::string outside_reason;                 ///< half a line of text
  Certificate certificate;                    ///< for Method::vrip, which has no energy, only lambda
  std::optional<ComponentReport> components;  ///< if components were dropped by their support
  std::optional<RefineReport> refine;         ///< if the surface was moved onto the samples
  std::optional<RelaxReport> relax;           ///< if edges were split
  std::optional<TrimReport> trim;             ///< if surface far from samples was searched for
  std::optional<SimplifyReport> simplify;     ///< if the mesh was simplified
  double isovalue = 0;                        ///< of the smoothed indicator; 0 of the refined field
  size_t mesh_vertices = 0, mesh_triangles = 0;
  SelfCheckReport self_check;
  MeasureReport measure;
  ScannerReport scanners;                          ///< not for Method::vrip
  std::optional<TopologyReport> topology;          ///< if it was checked
  std::optional<DistanceSummary> sample_distance;  ///< samples to mesh, input units; if it was checked
  std::vector<StageTime> stages;                   ///< in order
  size_t planned_bytes = 0;
  size_t peak_bytes = 0;   ///< of the process, including anything besides this run
  size_t array_bytes = 0;  ///< the most that this run's large arrays took at once: grids, bands, fields
  std::vector<std::string> warnings;
  std::shared_ptr<const ReportDetails> details;
};

std::string to_json(const ReconstructReport& report);

}  // namespace soapfilm
