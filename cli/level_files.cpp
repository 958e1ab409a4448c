#include "cli/level_files.h"

#include <fmt/format.h>

#include <cmath>
#include <system_error>

#include "soapfilm/error.h"
#include "soapfilm/extract/cut.h"
#include "soapfilm/extract/isosurface.h"
#include "soapfilm/io.h"
#include "soapfilm/surface/indicator.h"

namespace soapfilm::cli {

namespace {

/// Whether the level covers a place and what is within a quarter of a vertex of it: walls at the end of its places lie
/// half a vertex beyond the last one.
bool is_within(const Level& level, Vec3d place) {
  for (int k = 0; k < 8; ++k) {
    Vec3i vertex;
    for (int axis = 0; axis < 3; ++axis)
      vertex[axis] = static_cast<int>(std::floor(place[axis] + (octant_of(k)[axis] == 0 ? 0.25 : 0.75)));
    if (!level.covers(brick_of(vertex))) return false;
  }
  return true;
}

/// The bricks of places that touch others, and these: between them walls are drawn.
BrickMask bricks_at_end(const BrickMask& places) {
  BrickMask bricks(places.bricks());
  places.for_each([&](Vec3i b) {
    for (int slot = 0; slot < 27; ++slot)
      if (const Vec3i n = b + slot_offset(slot); places.contains(n) && !places.test(n)) {
        bricks.set(b);
        bricks.set(n);
      }
  });
  return bricks;
}

/// Unsmoothed. That of an open level ends at the box, as the final mesh does; that of a level in some places where they
/// end.
Mesh surface_of(const Level& level, double threshold, const Lattice& lattice, const Context& context) {
  const Labels labels = labels_of(level, static_cast<float>(threshold), context);
  BrickMask bricks = bricks_near_surface(labels, context);
  if (level.places) bricks |= bricks_at_end(*level.places);
  const IndicatorField surface = binary_indicator(labels, BrickGrid(bricks, context), context);
  Mesh mesh = extract_isosurface(
      surface.grid, surface.value, [&](Vec3i brick) { return surface.missing_value(brick); }, 0.5f, lattice, context,
      drawn_range(level.box));
  if (level.places)
    keep_triangles(mesh, [&](uint32_t v) { return is_within(level, lattice.to_lattice(mesh.vertices[v])); });
  return mesh;
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
