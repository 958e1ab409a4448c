#include "soapfilm/lambda/folds.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

#include "soapfilm/core/random.h"
#include "soapfilm/core/some_by_place.h"
#include "soapfilm/error.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/field/terms.h"

namespace soapfilm {

namespace {

constexpr int most_folds = 100;

/// How many samples of each scan are usable.
std::vector<size_t> scan_sizes(const PointCloud& cloud, std::span<const Vec3f> directions) {
  std::vector<size_t> sizes;
  for (const Scan& scan : cloud.scans) {
    size_t size = 0;
    for (size_t i = scan.begin; i < scan.end; ++i) size += takes_part(cloud, directions, i);
    sizes.push_back(size);
  }
  return sizes;
}

void deal_scans(const PointCloud& cloud, const std::vector<size_t>& scan_size, Folds& folds) {
  std::vector<size_t> order(cloud.scans.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return scan_size[a] > scan_size[b]; });
  std::vector<size_t> load(static_cast<size_t>(folds.count), 0);
  for (const size_t s : order) {
    const auto lightest = std::min_element(load.begin(), load.end());
    *lightest += scan_size[s];
    const auto fold = static_cast<uint8_t>(lightest - load.begin());
    std::fill(folds.of_sample.begin() + static_cast<std::ptrdiff_t>(cloud.scans[s].begin),
              folds.of_sample.begin() + static_cast<std::ptrdiff_t>(cloud.scans[s].end), fold);
  }
}

/// By their places: samples at one place are in one fold, in whatever order they come.
void deal_samples(const PointCloud& cloud, uint64_t seed, Folds& folds) {
  const Box3d box = cloud.box();
  for (size_t i = 0; i < cloud.size(); ++i)
    folds.of_sample[i] = static_cast<uint8_t>(Random(seed ^ hash_of_place(cloud.positions[i], box)).next() %
                                              static_cast<uint64_t>(folds.count));
}

}  // namespace

Folds make_folds(const PointCloud& cloud, std::span<const Vec3f> directions, int count, FoldSource source,
                 uint64_t seed) {
  if (count < 2 || count > most_folds)
    throw ParameterError(fmt::format("folds = {}, must be between 2 and {}", count, most_folds));
  const std::vector<size_t> scan_size = scan_sizes(cloud, directions);
  const auto scans = std::count_if(scan_size.begin(), scan_size.end(), [](size_t size) { return size > 0; });
  if (source == FoldSource::scans && scans < count)
    throw ParameterError(
        fmt::format("folds = {} of whole scans: the input has {} scan{} with directions, must be at "
                    "least {}",
                    count, scans, scans == 1 ? "" : "s", count));

  Folds folds;
  folds.count = count;
  folds.whole_scans = source == FoldSource::scans;
  folds.of_sample.assign(cloud.size(), 0);
  if (folds.whole_scans)
    deal_scans(cloud, scan_size, folds);
  else
    deal_samples(cloud, seed, folds);

  folds.sizes.assign(static_cast<size_t>(count), 0);
  for (size_t i = 0; i < cloud.size(); ++i) folds.sizes[folds.of_sample[i]] += takes_part(cloud, directions, i);
  const auto smallest = std::min_element(folds.sizes.begin(), folds.sizes.end());
  if (*smallest < fewest_held_out)
    throw ParameterError(
        fmt::format("folds = {}: fold {} has {} samples with a direction, must be at least {}; give "
                    "fewer folds or a lambda",
                    count, smallest - folds.sizes.begin(), *smallest, fewest_held_out));
  return folds;
}

FoldFields hold_out(const PointCloud& cloud, std::span<const Vec3f> directions, const Folds& folds, int fold,
                    const Lattice& lattice, const Context& context) {
  if (fold < 0 || fold >= folds.count)
    throw ParameterError(fmt::format("fold = {}, must be between 0 and {}", fold, folds.count - 1));
  const auto field_of = [&](bool held_out) {
    const auto wanted = [&](size_t i) { return (folds.of_sample[i] == fold) == held_out; };
    return data_field(sort_samples(cloud, directions, lattice, context, wanted), lattice.box(0), context);
  };
  const auto all = std::accumulate(folds.sizes.begin(), folds.sizes.end(), size_t{0});
  FoldFields fields{field_of(false), field_of(true), 0};
  fields.training_share = 1 - static_cast<double>(folds.sizes[static_cast<size_t>(fold)]) / static_cast<double>(all);
  return fields;
}

}  // namespace soapfilm
