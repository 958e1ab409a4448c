// What a reconstruction reports of itself: report.json, key by key in docs/reference/report.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "soapfilm/mesh.h"
#include "soapfilm/params.h"
#include "soapfilm/vec.h"

namespace SOAPFILM_API soapfilm {

struct StageTime {
  std::string name;
  double elapsed = 0, cpu = 0;  ///< seconds, by the clock and of all threads of the run
};

/// Where each sample's direction came from: counts of samples.
struct OrientReport {
  size_t from_normals = 0;
  size_t from_sensor = 0;
  size_t from_scan = 0;
  size_t from_planes = 0;  ///< of those two, by `automatic`: now normals of the planes around them, on that side
  size_t estimated = 0;
  bool inward = false;           ///< normals that were given point towards the samples' middle on the whole
  size_t without_direction = 0;  ///< their direction is zero: no neighbors that span a plane
  double contradicting = 0;      ///< share of the pairs of neighboring directions on one plane that do, [0, 1]
  size_t reoriented = 0;         ///< normals that were therefore used without their signs: reversed since
  std::vector<std::string> warnings;
};

struct InputFacts {
  size_t samples = 0;
  size_t dropped = 0;  ///< by the reader: not finite
  size_t scans = 0;
  Box3d box;
  double density = 0;  ///< samples per voxel^2 of surface
  OrientReport directions;
};

/// The finest grid.
struct GridFacts {
  Vec3i size;          ///< vertices along each of its axes, padding included
  int turn = 0;        ///< its axis k is the world's axis (k + turn) % 3
  int levels = 1;      ///< of the pyramid; level 0 is the finest
  int padding = 6;     ///< cells between the samples' box and the border
  double voxel = 1;    ///< edge of a cell, input units
  Vec3d first_vertex;  ///< world position of vertex (0, 0, 0)
  bool open = false;   ///< a surface may end at the border, at no cost
};

/// Of equation (4), E(u) = lambda TV(u) - <f, u>, and of its dual: E(u) >= optimum >= D(p) on the whole domain.
struct Energies {
  double total_variation = 0;  ///< TV(u), whole domain
  double data = 0;             ///< <f, u>
  double primal = 0;           ///< lambda TV(u) - <f, u>
  double dual = 0;             ///< D(p), whole domain
  double gap = 0;              ///< sum of the local terms, each >= 0; equals primal - dual but for rounding
  double gap_band = 0;         ///< the part of it that the band can still reduce
  double max_dual_norm = 0;    ///< max |p| / lambda over the band, before any rescaling

  /// Relative to max(|D|, 1000 lambda).
  double relative_gap(double lambda) const;
  double relative_gap_band(double lambda) const;
};

/// Energies and bounds on the finest grid, valid for the whole domain.
struct Certificate {
  double lambda = 0;
  Energies relaxed;   ///< of the relaxed u and of p
  Energies binary;    ///< of the thresholded u, the one that the mesh comes from, and the same p
  size_t inside = 0;  ///< thresholded vertices inside, whole domain

  double relative_gap() const { return relaxed.relative_gap(lambda); }
  double relative_gap_binary() const { return binary.relative_gap(lambda); }
  /// Relative to the area term: how much less area and misfit the optimum could have at most.
  double gap_per_area() const;
  double gap_per_area_binary() const;
};

/// Parts that few samples support.
struct ComponentReport {
  struct Count {
    size_t kept = 0, dropped = 0;
  };
  Count objects;               ///< parts of the inside
  Count cavities;              ///< parts of the outside but the outermost
  size_t samples = 0;          ///< by their weights, on the surfaces of dropped parts; one on two of them counts twice
  double area = 0;             ///< of these surfaces, voxel^2
  size_t vertices = 0;         ///< of the grid, that changed sides
  double highest_dropped = 0;  ///< support of the dropped part that has most; 0 without one
  double lowest_kept = 0;      ///< and of the kept part that has least
};

/// How the surface was moved onto the samples.
struct RefineReport {
  double smoothing = 0;  ///< gamma in use: weight of curvature against one sample, lattice units
  double normals = 0;    ///< weight of a direction's error (as a vector of unit length) against a voxel, in use
  double noise = 0;      ///< standard deviation of the samples along the surface's normal, voxels, estimated
  double spacing = 1;    ///< of the vertices that the fit worked on, voxels: 1, 2, 4, ...
};

struct RelaxReport {
  size_t split_edges = 0;
  size_t triangles_before = 0;
};

struct TrimReport {
  double distance = 0;        ///< in use, input units
  size_t removed = 0;         ///< regions farther than that from all samples that were cut away
  size_t filled = 0;          ///< and those that stay
  double removed_area = 0;    ///< of all that was cut away, share of the mesh's area, [0, 1]
  size_t leftovers = 0;       ///< small pieces that the cuts left, and that were dropped
  bool nothing_near = false;  ///< no surface is within the distance: the mesh stays as it was
};

/// Does the mesh hold what the samples saw, and only that? Farther: than 3 voxels.
struct SelfCheckReport {
  size_t samples = 0;   ///< looked at
  size_t places = 0;    ///< on the surface, one on each of some triangles; each counts by the triangle's area
  double lost = 0;      ///< share of these samples, by weight, that lie farther from the mesh, [0, 1]
  double outliers = 0;  ///< share of the lost ones around which others show no surface, [0, 1]; a guess
  double noise = 0;     ///< standard deviation of the samples' noise, voxels, if it is what loses most; else 0; a guess
  double invented = 0;  ///< share of the surface that lies farther than that from every sample, [0, 1]
};

struct ScannerReport {
  size_t scanners = 0;  ///< whose places in the solution were looked at
  size_t in_solid = 0;  ///< stand inside of solid matter
  size_t enclosed = 0;  ///< stand in the air, with solid matter all around: along both ways of each axis
};

/// What report.json has beyond this: of each level, of the comparison methods, of cross-validation.
struct ReportDetails;

/// Version of the layout of report.json; a new key keeps it, a changed meaning does not.
inline constexpr int report_version = 1;

struct ReconstructReport {
  std::string command;  ///< as typed; empty when called as a library
  ReconstructParams params;
  InputFacts input;
  GridFacts grid;
  Border outside = Border::air;               ///< what was taken to lie beyond the box
  std::string outside_reason;                 ///< half a line
  Certificate certificate;                    ///< but for Method::vrip, which has no energy: lambda alone
  std::optional<ComponentReport> components;  ///< when parts that few samples support were dropped
  std::optional<RefineReport> refine;         ///< when the surface was moved onto the samples
  std::optional<RelaxReport> relax;           ///< when edges were split
  std::optional<TrimReport> trim;             ///< when surface that no sample is near was looked for
  double isovalue = 0;                        ///< of the smoothed indicator; 0 of the refined field
  size_t mesh_vertices = 0;
  size_t mesh_triangles = 0;
  SelfCheckReport self_check;
  ScannerReport scanners;                          ///< not of Method::vrip
  std::optional<TopologyReport> topology;          ///< when it was checked
  std::optional<DistanceSummary> sample_distance;  ///< samples to mesh, input units; when it was checked
  std::vector<StageTime> stages;                   ///< in order
  size_t planned_bytes = 0;
  size_t peak_bytes = 0;   ///< of the process, which may do more than this run
  size_t array_bytes = 0;  ///< the most that this run's large arrays took at once: grids, bands, fields
  std::vector<std::string> warnings;
  std::shared_ptr<const ReportDetails> details;
};

std::string to_json(const ReconstructReport& report);

}  // namespace soapfilm
