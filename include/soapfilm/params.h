// All parameters of a reconstruction, one struct per stage, with their defaults (by option: docs/reference/options.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "soapfilm/vec.h"

namespace SOAPFILM_API soapfilm {

enum class Method : uint8_t {
  tv,            ///< total variation (4), primal-dual, coarse to fine on a band, certified
  tv_sor,        ///< the same energy by the paper's numerics, section 4.2
  poisson,       ///< the quadratic regularizer (6)
  graph_cut_6,   ///< the discrete optimum, 6 neighbors (Lempitsky and Boykov 2007)
  graph_cut_26,  ///< the same with 26 neighbors
  vrip,          ///< weighted signed distance of range scans (Curless and Levoy 1996)
};

/// Where directions come from. A sample without data for the chosen source takes the next one of normals, sensor, scan,
/// estimate; `automatic` begins with normals.
enum class DirectionSource : uint8_t {
  automatic,  ///< normals first; without their signs where these contradict each other
  normals,    ///< the given normal as it is, unless it is zero
  sensor,     ///< towards the scanner's position: the sample's, its scan's, or OrientParams::sensor
  scan,       ///< one direction for a whole scan: its viewing direction, or from its mean towards its scanner
  estimate    ///< normal of a plane through the neighbors, on the scanner's side where one is known
};

enum class Axis : uint8_t { x, y, z, minus_x, minus_y, minus_z };

struct OrientParams {
  DirectionSource source = DirectionSource::automatic;
  std::optional<Vec3d> sensor;   ///< scanner position of scans that have none, input units and frame
  std::optional<Axis> up;        ///< from where sheets without any known direction were seen; else z, except in a house
  int neighbors = 16;            ///< of a sample, for estimated normals; in [3, 1000]
  std::optional<double> radius;  ///< estimated normals: also all samples within this distance; > 0, input units
};

/// Where the grid lies and how fine it is. At most one of `voxel` and `resolution` may be given.
struct PlaceParams {
  std::optional<double> voxel;    ///< edge of a cell, input units, > 0 and <= the samples' box
  std::optional<int> resolution;  ///< grid vertices along the longest axis, padding included, > 2 padding
  double samples_per_voxel2 = 1;  ///< if neither is given: the voxel with this many samples per voxel^2 of surface, > 0
  int padding = 6;                ///< cells between the samples and the border, 2..4096
  int levels = 0;                 ///< of the pyramid, 1..12; 0: until the coarsest has at most 24 vertices per axis
  /// Input units and frame: tiles of 256^3 cells lie there and whole numbers of tiles from there, whatever the samples,
  /// and vertices at whole numbers of voxels. Needs `voxel`.
  std::optional<Vec3d> anchor;
  /// Voxels of 1/4, 1/2, 2, 4, ... of the chosen one where samples are dense or sparse, or of 1, 2, 4, ... of a given
  /// one. Of `tv` and graph cuts, with refinement.
  bool adapt = false;
};

/// How the area of the surface is measured: the norm in TV(u) = sum over vertices of |grad u|.
enum class Norm : uint8_t {
  isotropic,   ///< |g| = sqrt(gx^2 + gy^2 + gz^2), area as it is
  anisotropic  ///< |g| = |gx| + |gy| + |gz|, area projected along the axes: as graph-cut-6
};

/// The weights of the energy (4).
struct EnergyParams {
  std::optional<double> lambda;      ///< the paper's: cost of a voxel face of area against one unit vector, > 0
  double lambda_per_density = 0.02;  ///< if not given: lambda is this times the samples per voxel^2 of surface, > 0
  bool cross_validate = false;       ///< choose lambda_per_density from the samples; `lambda` must be absent
  bool by_area = true;          ///< if `lambda` is not given: samples are weighted by the area they stand for; else 1
  Norm norm = Norm::isotropic;  ///< of the gradient; anisotropic only for Method::tv and graph cuts
};

enum class Border : uint8_t {
  automatic,
  air,    ///< u = 0 beyond the box: a closed surface that looks outward
  solid,  ///< u = 1 there: a closed surface that looks inward; solved as its complement, all directions reversed
  open    ///< the surface may end at the box, at no cost
};

/// What lies beyond the box of the samples. open: only Method::tv; automatic: other methods take air.
struct BorderParams {
  Border outside = Border::automatic;
  double open_gain = 0.35;  ///< automatic: open if that saves more than this share of the closed surface's area, (0, 1]
};

/// What is held out together in cross-validation.
enum class FoldSource : uint8_t {
  automatic,  ///< single samples, also where there are scans
  samples,    ///< single samples, at random
  scans       ///< whole scans
};

/// Of EnergyParams::cross_validate.
struct CrossValidationParams {
  int folds = 5;                              ///< parts, each held out once; in [2, 100]
  FoldSource source = FoldSource::automatic;  ///< what the folds are made of
  int max_resolution = 64;                    ///< vertices of the coarse grid along its longest axis; in [32, 512]
  double indifference = 0.002;                ///< errors above the smallest by at most this share are equal; in [0, 1)
  uint64_t seed = 1;                          ///< of the random choice of samples
  std::vector<double> candidates = {0.0025, 0.005, 0.01, 0.02,
                                    0.04,   0.08,  0.16, 0.32};  ///< lambda per sample and voxel^2, > 0, increasing
};

/// Method::tv.
struct PrimalDualParams {
  double tolerance = 1e-3;    ///< of the band's relative gap, > 0 (chosen by bench/results/tolerance.md)
  int max_iterations = 2000;  ///< per level, including those after its band grew, >= 1
  bool settle = true;         ///< end a level whose labels change no more; open coarse ones by their share of the work
  int check_every = 32;       ///< largest number of iterations between two gaps, 1 to 1000; the first comes after half
  double step_balance = 1.4;  ///< sigma in units of lambda at first, half of it near the end; tau = 1.3 / (12 sigma)
};

enum class SorOrder : uint8_t {
  lexicographic,  ///< the paper's: x fastest; uses at most two threads
  red_black,      ///< first the vertices with even x + y + z, then the odd ones; for any number of threads
};
enum class SorGradient : uint8_t { central, forward };

/// Method::tv_sor: the paper's section 4.2 (solve/sor.h).
struct SorParams {
  double epsilon = 0.001;     ///< bounds the diffusivity where u is constant, > 0
  double omega = 1.85;        ///< relaxation, > 0 and < 2
  int renew_every = 2;        ///< iterations with the same diffusivity, >= 1
  int levels = 3;             ///< of the pyramid, >= 1; at most the lattice's
  double tolerance = 1.2e-7;  ///< of the relative change of E between two iterations: float's resolution; >= 0
  int max_iterations = 400;   ///< per level, >= 1
  SorOrder order = SorOrder::lexicographic;
  SorGradient gradient = SorGradient::central;  ///< how |grad u| is taken for the diffusivity
  bool skip_empty = true;  ///< leave out runs of vertices that cannot change; the result is the same
  double snap = 1e-6;      ///< u closer to 0 or 1 than this becomes 0 or 1; >= 0 and < 0.5, 0: as the paper
};

/// Method::poisson.
struct PoissonParams {
  double tolerance = 1e-4;  ///< of the residual |f + 2 lambda Laplace(u)| / |f|, in (0, 1)
  int max_iterations = 50;  ///< of conjugate gradients, >= 1
};

/// edge_length: 1 / length of the link, as in Lempitsky and Boykov's program; cauchy_crofton: by solid angles (Boykov
/// and Kolmogorov 2003), so that the cost of a plane depends less on its direction.
enum class LinkWeights : uint8_t { edge_length, cauchy_crofton };

/// Method::graph_cut_6 and _26.
struct GraphCutParams {
  LinkWeights weights = LinkWeights::edge_length;
};

/// A range scan as the surface that its scanner saw (fuse/range_surface.h).
struct RangeSurfaceParams {
  double max_edge = 4;            ///< longest edge of a triangle, in distances between the scan's samples, > 1
  double max_incidence_deg = 75;  ///< largest angle between a triangle's normal and its ray, degrees, (0, 90)
  int taper = 4;                  ///< the weight falls towards the scan's border over so many samples, >= 0
};

/// Method::vrip: how far in front of and behind its surface, along the normal, a scan counts, voxels, (0, 1000].
struct VripParams {
  double front = 6;
  double behind = 2;
  RangeSurfaceParams surface;
};

/// Where the surface was refined: moves the flat triangles of one voxel onto the smooth surface.
struct RelaxParams {
  double split_tolerance =
      0.018;  ///< split edges whose middle is farther from the smooth surface, voxels; 0: none; [0, 1]
};

/// From the relaxed indicator to the surface (section 4.4).
struct SurfaceParams {
  double threshold = 0.5;               ///< mu, in (0, 1)
  std::optional<bool> refine;           ///< move the level set onto the samples; if not given: for tv, and with adapt
  std::optional<bool> drop_components;  ///< drop parts with few samples; if not given: where the surface is refined
  std::optional<double> isovalue;  ///< unrefined: of the smoothed indicator, (0, 1); if not given: its mean at samples
  RelaxParams relax;
  bool distance = false;  ///< adds the attribute "distance" to vertices: to the nearest sample, input units
  bool support = false;   ///< adds the attribute "support" to vertices: samples per voxel^2 of surface there
  bool gap = false;  ///< adds the attribute "gap" to vertices: the certificate's gap there, as a share of the area's
                     ///< price; not a number where the mesh has left the certified surface; tv and tv_sor only
  std::optional<double> volume_interval{};  ///< eps: bounds the volumes of all near segmentations of energy <= E* + eps
  std::vector<std::string> attributes = {"color"};  ///< of samples, carried to vertices: "color", columns, "all"
};

/// A part is a component or cavity; its surface lies between it and the part around it. Support: samples on that
/// surface, over those that the same area has on average.
struct ComponentParams {
  double min_support = 0.2;      ///< parts with less support are dropped, >= 0; 1: sampled like the whole surface
  int few_samples = 5;           ///< parts with fewer samples are dropped whatever their support, >= 0
  int many_samples = 100;        ///< parts with at least so many samples are kept down to sparse_support, >= 0
  double sparse_support = 0.01;  ///< a surface sampled a hundred times less than the whole, >= 0
};

/// How holes, where no sample is, are filled: with the curvature around them, or as the minimal surface.
enum class HoleFill : uint8_t { smooth, flat };

/// How the surface is moved onto the samples.
struct RefineParams {
  std::optional<double> smoothing{};  ///< gamma, weight of curvature against one sample, lattice units; [1e-6, 1e6]. If
                                      ///< not given: chosen by held-out samples
  std::optional<double> normals{};    ///< weight of a unit normal against one voxel; [0, 1e6], 0: directions say only
                                      ///< which side is outside. If not given: chosen by held-out samples
  double reach = 3;                   ///< half width of the band, voxels; [1, 3]
  double sparse = 0.5;  ///< samples per voxel^2, [0, 1e3]: where there are fewer, a fit on every second vertex, or
                        ///< every fourth, ..., replaces the full one if it is as good
  HoleFill holes = HoleFill::smooth;
};

/// Cutting away surface far from all samples.
struct TrimParams {
  std::optional<bool> on{};          ///< if not given: where the surface may end at the border (Border::open)
  std::optional<double> distance{};  ///< input units, > 0; if not given: 3 voxels, or 3 sample spacings if larger
  bool holes = false;                ///< also cut out the regions that would otherwise stay filled
  /// Decides which gaps in the samples stay filled, not the rules of trim_regions.h: those at most so wide; input
  /// units, > 0. Turns trimming on.
  std::optional<double> fill_holes{};
};

/// A smaller mesh within a proved distance of the full one (simplify.h). At most one of them; none: the mesh stays.
struct SimplifyParams {
  std::optional<double> tolerance{};      ///< input units, > 0
  std::optional<double> tolerance_vox{};  ///< voxels, > 0
  bool automatic = false;                 ///< tolerance: 0.02 voxel, or a twelfth of the estimated noise if larger
  std::optional<size_t> triangles{};      ///< at most so many, by the smallest tolerance that does; >= 1
};

struct ReconstructParams {
  Method method = Method::tv;
  OrientParams orient;
  PlaceParams place;
  EnergyParams energy;
  BorderParams border;
  CrossValidationParams cross_validation;
  PrimalDualParams solve;
  SorParams sor;
  PoissonParams poisson;
  GraphCutParams graph_cut;
  VripParams vrip;
  SurfaceParams surface;
  ComponentParams components;
  RefineParams refine;
  TrimParams trim;  ///< for all but Method::vrip, whose surface ends where nothing was seen
  SimplifyParams simplify;
  bool checked = false;  ///< distances from samples to the mesh are computed next: plans their memory too
};

/// Throws ParameterError naming the first value that is out of its range, and the range.
void validate(const ReconstructParams& params);

/// All parameters by name; absent ones as null.
std::string to_json(const ReconstructParams& params);
/// The inverse, also of a whole report (to_json() of report.h); a key that is absent keeps its default. Throws
/// ParameterError for text that is not JSON, an unknown key, a value of the wrong type or out of range.
ReconstructParams params_from_json(const std::string& text);

}  // namespace soapfilm
