#include "soapfilm/io/levels.h"

#include <fmt/format.h>

#include <filesystem>

#include "soapfilm/core/context_state.h"
#include "soapfilm/io/bytes/staged_files.h"
#include "soapfilm/io/formats.h"
#include "soapfilm/io/meshes/gltf.h"
#include "soapfilm/platform/scratch.h"

namespace soapfilm {

namespace {

bool holds_all_levels(const std::string& path) {
  const io::Format* format = io::format_of_extension(path);
  return format && format->write_mesh == io::write_glb;
}

}  // namespace

std::vector<std::string> level_files(const std::string& path, size_t count) {
  std::vector<std::string> files{path};
  const std::filesystem::path name(path);
  for (size_t level = 1; level < count && !holds_all_levels(path); ++level) {
    std::filesystem::path file = name;
    file.replace_extension(fmt::format("{}{}", level, name.extension().string()));
    files.push_back(file.string());
  }
  return files;
}

WriteReport write_levels(const std::string& path, const std::vector<DetailLevel>& levels, const WriteOptions& options,
                         const Context& context) {
  if (levels.size() == 1) return write_mesh(path, levels[0].mesh, options, context);
  const io::Format& format = io::mesh_output_format(path);
  const std::vector<std::string> files = level_files(path, levels.size());
  io::StagedFiles staged(ranks_of(context));
  WriteReport all;
  if (files.size() == 1)
    staged.write(path, [&](io::AtomicFile& file) { all = io::write_glb_levels(file, levels, options); });
  for (size_t level = files.size(); files.size() > 1 && level-- > 0;)
    staged.write(files[level], [&](io::AtomicFile& file) {
      const WriteReport report = format.write_mesh(file, levels[level].mesh, options, context);
      all.format = report.format;
      all.double_coordinates |= report.double_coordinates;
      all.warnings.insert(all.warnings.begin(), report.warnings.begin(), report.warnings.end());
    });
  check_scratch_files(context.state().scratch_folder);
  staged.commit();
  return all;
}

}  // namespace soapfilm
