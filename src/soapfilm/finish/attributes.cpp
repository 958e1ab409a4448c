#include "soapfilm/finish/attributes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "soapfilm/core/kd_tree.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/error.h"

namespace soapfilm {

namespace {

constexpr size_t most_neighbors = 16;
constexpr size_t vertices_per_chunk = 1024;

bool names(std::span<const std::string> wanted, const std::string& name) {
  return std::find(wanted.begin(), wanted.end(), name) != wanted.end() ||
         std::find(wanted.begin(), wanted.end(), "all") != wanted.end();
}

/// The samples that a vertex takes its values from, nearest first, and what each counts for.
struct Neighbors {
  size_t count = 0;  ///< within reach, or the nearest one alone
  size_t found = 0;  ///< and beyond
  std::array<uint32_t, most_neighbors> sample{};
  std::array<double, most_neighbors> weight{};

  Neighbors(const KdTree& tree, const GridSamples& samples, Vec3d place) {
    std::array<double, most_neighbors> squared{};
    found = tree->knnSearch(&place.x, most_neighbors, sample.data(), squared.data());
    for (; count < found; ++count) {
      const double near = 1 - squared[count] / (attribute_reach * attribute_reach);
      if (near <= 0) break;
      weight[count] = near * near * static_cast<double>(samples.weight_of(sample[count]));
    }
    if (count == 0 && found > 0) weight[count++] = 1;
  }
};

/// Of the nearest sample that has one.
float nearest_number(const Neighbors& neighbors, const std::vector<float>& values) {
  for (size_t k = 0; k < neighbors.found; ++k)
    if (const float value = values[neighbors.sample[k]]; !std::isnan(value)) return value;
  return std::numeric_limits<float>::quiet_NaN();
}

float mean(const Neighbors& neighbors, const std::vector<float>& values) {
  double sum = 0, weights = 0;
  for (size_t k = 0; k < neighbors.count; ++k) {
    const double value = static_cast<double>(values[neighbors.sample[k]]);
    if (std::isnan(value)) continue;
    sum += neighbors.weight[k] * value;
    weights += neighbors.weight[k];
  }
  return weights > 0 ? static_cast<float>(sum / weights) : nearest_number(neighbors, values);
}

/// Of several with the same weight, the nearest sample's.
float majority(const Neighbors& neighbors, const std::vector<float>& values) {
  float best = nearest_number(neighbors, values);
  double most = 0;
  for (size_t k = 0; k < neighbors.count; ++k) {
    const float value = values[neighbors.sample[k]];
    double weight = 0;
    for (size_t j = 0; j < neighbors.count; ++j)
      if (values[neighbors.sample[j]] == value) weight += neighbors.weight[j];
    if (weight > most) {
      most = weight;
      best = value;
    }
  }
  return best;
}

Rgb8 mean(const Neighbors& neighbors, const std::vector<Rgb8>& colors) {
  std::array<double, 3> sum{};
  double weights = 0;
  for (size_t k = 0; k < neighbors.count; ++k) {
    for (size_t c = 0; c < 3; ++c) sum[c] += neighbors.weight[k] * colors[neighbors.sample[k]][c];
    weights += neighbors.weight[k];
  }
  Rgb8 color{};
  for (size_t c = 0; c < 3; ++c) color[c] = static_cast<uint8_t>(std::lround(sum[c] / weights));
  return color;
}

template <class T>
std::vector<T> sorted(const std::vector<T>& values, const GridSamples& samples) {
  std::vector<T> result;
  result.reserve(samples.size());
  for (const uint32_t source : samples.source) result.push_back(values[source]);
  return result;
}

}  // namespace

void check_attributes(const PointCloud& cloud, std::span<const std::string> wanted) {
  for (const std::string& name : wanted) {
    if (name == "all" || name == "color") continue;
    std::vector<std::string> known{"all", "color"};
    for (const Column& column : cloud.columns) known.push_back(column.name);
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw ParameterError(fmt::format("attributes = {}, must be among {}", name, fmt::join(known, ", ")));
  }
}

SampleAttributes sort_attributes(const PointCloud& cloud, const GridSamples& samples,
                                 std::span<const std::string> wanted) {
  SampleAttributes attributes;
  if (!cloud.colors.empty() && names(wanted, "color")) attributes.colors = sorted(cloud.colors, samples);
  for (const Column& column : cloud.columns)
    if (names(wanted, column.name))
      attributes.columns.push_back({column.name, sorted(column.values, samples), column.is_label});
  return attributes;
}

void carry_attributes(const SampleAttributes& attributes, const GridSamples& samples, const Lattice& lattice,
                      const Context& context, Mesh& mesh) {
  const std::vector<Vec3d> places = lattice_positions(samples);
  const KdTree tree(places);
  context.progress().advance(0.5, "samples sorted");
  if (!attributes.colors.empty()) mesh.colors.resize(mesh.vertices.size());
  const size_t first = mesh.attributes.size();
  for (const Column& column : attributes.columns)
    mesh.attributes.push_back({column.name, std::vector<float>(mesh.vertices.size()), column.is_label});
  parallel_for(context, mesh.vertices.size(), vertices_per_chunk, [&](size_t v) {
    const Neighbors neighbors(tree, samples, lattice.to_lattice(mesh.vertices[v]));
    if (!attributes.colors.empty()) mesh.colors[v] = mean(neighbors, attributes.colors);
    for (size_t c = 0; c < attributes.columns.size(); ++c) {
      const Column& column = attributes.columns[c];
      mesh.attributes[first + c].values[v] =
          column.is_label ? majority(neighbors, column.values) : mean(neighbors, column.values);
    }
  });
}

}  // namespace soapfilm
