#include "cli/level_files.h"

#include <fmt/format.h>

#include <system_error>

#include "soapfilm/error.h"
#include "soapfilm/extract/isosurface.h"
#include "soapfilm/io.h"
#include "soapfilm/surface/indicator.h"

namespace soapfilm::cli {

namespace {

/// Unsmoothed. That of an open level ends at the box, as the final mesh does.
Mesh surface_of(const Level& level, double threshold, const Lattice& lattice, const Context& context) {
  const IndicatorField surface = binary_indicator(labels_of(level, static_cast<float>(threshold), context), context);
  return extract_isosurface(
      surface.grid, surface.value, [&](Vec3i brick) { return surface.missing_value(brick); }, 0.5f, lattice, context,
      drawn_range(level.box));
}

}  // namespace

LevelFiles::~LevelFiles() {
  std::error_code ignored;
  for (const std::filesystem::path& file : written_) std::filesystem::remove(file, ignored);
}

PyramidObserver LevelFiles::writer(const std::filesystem::path& folder, double threshold, const Context& context) {
  if (folder.empty()) return {};
  PyramidObserver observer;
  observer.solved = [this, folder, threshold, &context](const Level& level, const Lattice& lattice) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) throw OutputError(fmt::format("{}: cannot make the folder: {}", folder.string(), error.message()));
    const Mesh mesh = surface_of(level, threshold, lattice, context);
    if (mesh.triangles.empty()) return;  // no surface pays for its area on this level
    const std::filesystem::path file = folder / name(level.box.level);
    write_mesh(file.string(), mesh, {}, context);
    written_.push_back(file);
  };
  return observer;
}

std::string LevelFiles::name(int level) { return fmt::format("level_{}.ply", level); }

}  // namespace soapfilm::cli
