#include "soapfilm/orient/scan_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "soapfilm/core/kd_tree.h"
#include "soapfilm/core/median.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

namespace {

constexpr size_t most_scans = 12, most_samples = 3000, least_samples = 200, most_queries = 500;

/// Some samples of a scan with their directions.
struct ThinScan {
  std::vector<Vec3d> positions;
  std::vector<Vec3d> directions;
  double diagonal = 0;
  double spacing = 0;
  std::unique_ptr<KdTree> tree;
};

/// The nearest sample to `p`, or the `rank`-th nearest, and its squared distance.
std::pair<size_t, double> nearest_of(const ThinScan& scan, const Vec3d& p, size_t rank = 0) {
  std::array<uint32_t, 2> index{};
  std::array<double, 2> squared{};
  const std::array<double, 3> query{p.x, p.y, p.z};
  (*scan.tree)->knnSearch(query.data(), rank + 1, index.data(), squared.data());
  return {index[rank], squared[rank]};
}

ThinScan thin(const PointCloud& cloud, const Scan& scan, std::span<const Vec3f> directions) {
  ThinScan thinned;
  const size_t step = std::max<size_t>(1, scan.size() / most_samples);
  Box3d box;
  for (size_t i = scan.begin; i < scan.end; i += step) {
    if (directions[i] == Vec3f{}) continue;
    thinned.positions.push_back(cloud.positions[i]);
    thinned.directions.push_back(normalized(static_cast<Vec3d>(directions[i])));
    box.extend(cloud.positions[i]);
  }
  if (thinned.positions.size() < least_samples) return {};
  thinned.diagonal = box.diagonal();
  thinned.tree = std::make_unique<KdTree>(thinned.positions);
  std::vector<double> squared;
  for (size_t i = 0; i < thinned.positions.size(); i += 1 + thinned.positions.size() / most_queries)
    squared.push_back(nearest_of(thinned, thinned.positions[i], 1).second);
  thinned.spacing = std::sqrt(median(std::move(squared)));
  return thinned;
}

/// Some samples of `a` against the surface of `b`.
ScanFit compare(const ThinScan& a, const ThinScan& b) {
  constexpr double reach = 0.05, apart = 0.01;  // of the smaller diagonal
  constexpr double beside = 2, turned = 0.5;    // spacings; cosine
  const double diagonal = std::min(a.diagonal, b.diagonal);
  ScanFit fit;
  const size_t step = 1 + a.positions.size() / most_queries;
  for (size_t i = 0; i < a.positions.size(); i += step) {
    const auto [k, squared] = nearest_of(b, a.positions[i]);
    const double cosine = dot(a.directions[i], b.directions[k]);
    if (squared > reach * diagonal * (reach * diagonal) || cosine <= 0) continue;
    const double off = std::abs(dot(a.positions[i] - b.positions[k], b.directions[k]));
    if (squared - off * off > beside * b.spacing * (beside * b.spacing)) continue;
    ++fit.overlap;
    fit.contradicting += off > std::max(apart * diagonal, b.spacing) || cosine < turned;
  }
  return fit;
}

}  // namespace

ScanFit compare_scans(const PointCloud& cloud, std::span<const Vec3f> directions, const Context& context) {
  std::vector<const Scan*> large;
  for (const Scan& scan : cloud.scans)
    if (scan.size() >= least_samples) large.push_back(&scan);
  std::vector<const Scan*> chosen;
  const size_t count = std::min(large.size(), most_scans);
  for (size_t k = 0; k < count; ++k) chosen.push_back(large[k * large.size() / count]);
  std::vector<ThinScan> scans(chosen.size());
  parallel_for(context, scans.size(), 1, [&](size_t k) { scans[k] = thin(cloud, *chosen[k], directions); });
  std::vector<ScanFit> fits(scans.size() * scans.size());
  parallel_for(context, fits.size(), 1, [&](size_t pair) {
    const ThinScan &a = scans[pair / scans.size()], &b = scans[pair % scans.size()];
    if (&a != &b && a.tree && b.tree) fits[pair] = compare(a, b);
  });
  ScanFit all;
  for (const ScanFit& fit : fits) {
    all.overlap += fit.overlap;
    all.contradicting += fit.contradicting;
  }
  return all;
}

std::optional<std::string> misfit_of_scans(const PointCloud& cloud, std::span<const Vec3f> directions,
                                           const Context& context) {
  constexpr size_t least_overlap = 40;
  constexpr double most_share = 0.4;  // of posed scans up to 0.16, of others from 0.59 on
  if (cloud.scans.size() < 2) return std::nullopt;
  const ScanFit fit = compare_scans(cloud, directions, context);
  if (fit.overlap < least_overlap || fit.share() <= most_share) return std::nullopt;
  return fmt::format(
      "scans contradict each other: {:.2g} % of the samples near another scan's surface do not lie on it; are the "
      "scans in one frame? (their poses: .conf, .mlp, .aln)",
      100 * fit.share());
}

}  // namespace soapfilm
