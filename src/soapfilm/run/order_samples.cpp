#include "soapfilm/run/order_samples.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "soapfilm/core/box_of.h"
#include "soapfilm/core/column_sort.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/core/morton.h"
#include "soapfilm/platform/memory.h"
#include "soapfilm/run/memory_plan.h"

namespace soapfilm {

namespace {

bool may_be_ordered(const PointCloud& cloud) {
  size_t end = 0;
  for (const Scan& scan : cloud.scans) {
    if (scan.begin < end || scan.end < scan.begin || scan.end > cloud.size()) return false;
    end = scan.end;
  }
  return std::all_of(cloud.positions.begin(), cloud.positions.end(), [](Vec3d p) { return is_finite(p); }) &&
         std::all_of(cloud.weights.begin(), cloud.weights.end(), [](float w) { return w >= 0 && std::isfinite(w); });
}

void order_scan(PointCloud& cloud, size_t begin, size_t end) {
  constexpr int depth = 21;
  const auto positions = std::span(cloud.positions).subspan(begin, end - begin);
  const Box3d box = box_of(positions);
  if (!(box.longest() > 0)) return;
  std::vector<uint64_t> keys(positions.size());
  for (size_t i = 0; i < keys.size(); ++i) keys[i] = morton_key((positions[i] - box.lo) / box.longest(), depth);
  const ColumnSort sort(std::move(keys));
  const auto apply = [&](auto& column) {
    if (!column.empty()) sort.apply(std::span(column).subspan(begin, end - begin));
  };
  apply(cloud.positions);
  apply(cloud.normals);
  apply(cloud.sensors);
  apply(cloud.weights);
  apply(cloud.colors);
  for (Column& column : cloud.columns) apply(column.values);
}

}  // namespace

void order_scans_by_place(PointCloud& cloud) {
  if (!may_be_ordered(cloud)) return;
  if (cloud.scans.empty()) order_scan(cloud, 0, cloud.size());
  for (const Scan& scan : cloud.scans)
    if (!scan.range_grid) order_scan(cloud, scan.begin, scan.end);
}

void order_samples(PointCloud& cloud, const Context& context) {
  if (context.state().scratch_folder.empty()) return;
  if (plan_placing(cloud) > Room(context.memory_limit(), held_memory_bytes()).bytes) order_scans_by_place(cloud);
}

}  // namespace soapfilm
