#include "cli/preview.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iterator>

#include "cli/read_cloud.h"
#include "cli/shell.h"
#include "soapfilm/run/defaults.h"

namespace soapfilm::cli {

namespace {

constexpr double coarser = 4;       // times as large cells
constexpr int fewest_cells = 16;    // along the longest axis, if the full run has as many
constexpr size_t enough = 100'000;  // samples
constexpr size_t most_of_one = 16;  // of so many at most one stays: as many for a larger face as one had before

/// Evenly mixed bits of a number (the finalizer of SplitMix64): every fourth sample of a scan would be a stripe of it.
uint64_t mixed(uint64_t i) {
  i = (i ^ (i >> 30)) * 0xbf58476d1ce4e5b9u;
  i = (i ^ (i >> 27)) * 0x94d049bb133111ebu;
  return i ^ (i >> 31);
}

}  // namespace

std::string default_mesh(const std::string& input, bool preview) {
  const std::filesystem::path path = named_path(input);
  const bool folder = std::filesystem::is_directory(path);
  return (folder ? path.filename() : path.stem()).string() + (preview ? ".preview.ply" : ".mesh.ply");
}

void make_preview(ReconstructParams& params, PointCloud& cloud, Progress& progress) {
  // vrip draws the triangles between neighboring samples of a scan: it needs all of them.
  const size_t one_of = params.method == Method::vrip ? 1 : std::clamp<size_t>(cloud.size() / enough, 1, most_of_one);
  if (one_of > 1) {
    std::vector<bool> keep(cloud.size());
    for (size_t i = 0; i < keep.size(); ++i) keep[i] = mixed(i + 1) % one_of == 0;
    cloud.filter(keep);
  }
  PlaceParams& place = params.place;
  double larger = coarser;
  if (place.voxel) {
    larger = std::clamp(cloud.box().longest() / fewest_cells / *place.voxel, 1.0, larger);
    place.voxel = *place.voxel * larger;
  }
  if (place.resolution) {
    const int cells = *place.resolution - 2 * place.padding;
    const int left = std::max(std::min(cells, fewest_cells), static_cast<int>(cells / coarser));
    larger = static_cast<double>(cells) / left;
    place.resolution = 2 * place.padding + left;
  }
  // What a face of a cell holds of the samples that stay, over what it held.
  const double more = larger * larger / static_cast<double>(one_of);
  place.samples_per_voxel2 *= more;
  if (params.energy.lambda) params.energy.lambda = *params.energy.lambda * more;
  // Splitting edges takes half of the time. What was asked for is done.
  double& split_tolerance = params.surface.relax.split_tolerance;
  if (refines(params) && split_tolerance == RelaxParams{}.split_tolerance) split_tolerance = 0;
  progress.info(fmt::format("preview: cells {:.3g} times as large{}", larger,
                            one_of > 1 ? fmt::format(", one sample of {}", one_of) : ""));
}

std::string full_run(const std::vector<std::string>& arguments) {
  std::vector<std::string> words{"soapfilm"};
  std::copy_if(arguments.begin(), arguments.end(), std::back_inserter(words),
               [](const std::string& argument) { return !argument.starts_with("--preview"); });
  return shell_words(words);
}

}  // namespace soapfilm::cli
