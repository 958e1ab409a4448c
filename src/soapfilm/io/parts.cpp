#include "soapfilm/io/parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <optional>
#include <system_error>
#include <utility>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/json_text.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io/bytes/encode.h"
#include "soapfilm/io/bytes/staged_files.h"
#include "soapfilm/io/files.h"
#include "soapfilm/io/formats.h"
#include "soapfilm/io/meshes/face_normals.h"
#include "soapfilm/io/meshes/gltf.h"
#include "soapfilm/io/meshes/mesh_blocks.h"
#include "soapfilm/io/meshes/obj.h"
#include "soapfilm/io/meshes/off.h"
#include "soapfilm/io/meshes/vdb.h"
#include "soapfilm/io/precision.h"
#include "soapfilm/io/text/text.h"
#include "soapfilm/platform/scratch.h"

namespace soapfilm {

namespace {

using nlohmann::ordered_json;

constexpr int parts_version = 1;
constexpr const char* part_word = ".part_";

/// What parts share, so that they fit.
struct PartStyle {
  const io::Format& format;
  WriteOptions options;
  std::optional<Vec3d> origin;  ///< of GLB, whose coordinates are relative to it
  std::vector<Vec3f> normals;   ///< of GLB, which has some always: the faces' of the whole mesh, where it has none
  bool is_text = false;         ///< of OBJ and OFF
};

PartStyle style_of(const io::Format& format, const Mesh& mesh, const WriteOptions& options) {
  PartStyle style{format, options, {}, {}, format.write_mesh == io::write_obj || format.write_mesh == io::write_off};
  if (format.write_mesh == io::write_glb) style.origin = mesh.box().center();
  if (style.origin && mesh.normals.empty()) {
    io::FaceNormals faces(mesh.vertices);
    for (const Triangle& triangle : mesh.triangles) faces.add(triangle);
    style.normals = faces.finish();
  }
  // Coordinates of all parts are double, or float where that changes nothing; or else they are float in all.
  const Vec3d origin = style.origin.value_or(Vec3d{});
  const bool is_exact =
      io::float_rounding_error(mesh.vertices, origin) > io::mesh_precision(mesh, options.coordinate_precision) ||
      io::collapsed_by_float(mesh, origin) > 0;
  style.options.coordinate_precision =
      is_exact ? std::numeric_limits<double>::min() : std::numeric_limits<double>::max();
  return style;
}

/// A float as the file holds it: in OBJ and OFF its shortest text, which as a double is another number.
double as_written(float value, bool is_text) {
  if (!is_text) return static_cast<double>(value);
  std::array<char, io::longest_number> text{};
  double number = 0;
  io::parse_number({text.data(), static_cast<size_t>(io::put_text(text.data(), value) - text.data())}, number);
  return number;
}

/// Of the coordinates in the file: rounding keeps their order.
Box3d written_box(const Box3d& box, const PartStyle& style, bool double_coordinates) {
  if (double_coordinates) return box;
  const Vec3d origin = style.origin.value_or(Vec3d{});
  const auto rounded = [&](const Vec3d& p) {
    Vec3d written;
    for (int axis = 0; axis < 3; ++axis) {
      // Volatile: GCC 12 (-O2, vectors of two) leaves the rounding of two coordinates at once out.
      const volatile auto single = static_cast<float>(p[axis] - origin[axis]);
      written[axis] = origin[axis] + as_written(single, style.is_text);
    }
    return written;
  };
  return {rounded(box.lo), rounded(box.hi)};
}

ordered_json box_json(const Box3d& box) {
  const auto triple = [](const Vec3d& p) { return ordered_json::array({p.x, p.y, p.z}); };
  return {{"lo", triple(box.lo)}, {"hi", triple(box.hi)}};
}

std::string index_text(const WrittenParts& written, const PartsParams& params, const PartStyle& style,
                       size_t vertices) {
  const auto known = [](const std::string& text) { return text.empty() ? ordered_json() : ordered_json(text); };
  ordered_json parts = ordered_json::array();
  size_t triangles = 0;
  Box3d box;
  for (const WrittenPart& part : written.parts) {
    parts.push_back({{"file", std::filesystem::path(part.file).filename().string()},
                     {"triangles", part.triangles},
                     {"vertices", part.vertices},
                     {"box", box_json(part.box)}});
    triangles += part.triangles;
    box.extend(part.box);
  }
  ordered_json index = {{"format", "soapfilm mesh parts"},
                        {"version", parts_version},
                        {"files", written.parts.size()},
                        {"triangles", triangles},
                        {"vertices", vertices},
                        {"box", box_json(box)},
                        {"coordinate_system", known(params.coordinate_system)},
                        {"unit", known(params.unit)}};
  const Vec3d origin = style.origin.value_or(Vec3d{});
  index["origin"] = ordered_json::array({origin.x, origin.y, origin.z});
  index["parts"] = std::move(parts);
  return json_text(index) + "\n";
}

/// Parts that an earlier mesh of more parts, or of other numbers of digits, has left.
void warn_of_other_parts(const std::string& path, WrittenParts& written) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  std::vector<std::string> others;
  std::error_code error;
  for (std::filesystem::directory_iterator at(folder.empty() ? "." : folder, error), end; !error && at != end;
       at.increment(error)) {
    const std::string file = (folder / at->path().filename()).string();
    const auto is_new = [&](const WrittenPart& part) { return part.file == file; };
    if (is_part_file(path, file) && std::none_of(written.parts.begin(), written.parts.end(), is_new))
      others.push_back(file);
  }
  if (others.empty()) return;
  written.report.warnings.push_back(
      fmt::format("{}: {} of an earlier mesh, not in {}", *std::min_element(others.begin(), others.end()),
                  others.size() == 1 ? "a part" : fmt::format("the first of {} parts", others.size()), written.index));
}

}  // namespace

std::string part_file(const std::string& path, size_t number, size_t count) {
  std::filesystem::path file(path);
  const std::string extension = file.extension().string();
  const size_t digits = std::max<size_t>(3, fmt::format("{}", count).size());
  file.replace_extension();
  return fmt::format("{}{}{:0{}}{}", file.string(), part_word, number, digits, extension);
}

std::string parts_index(const std::string& path) {
  std::filesystem::path file(path);
  return file.replace_extension(".parts.json").string();
}

bool is_part_file(const std::string& path, const std::string& file) {
  namespace fs = std::filesystem;
  const auto place = [](const std::string& name) {
    std::error_code error;
    return fs::weakly_canonical(fs::absolute(name, error).parent_path(), error);
  };
  const std::string begin = fs::path(path).stem().string() + part_word, name = fs::path(file).stem().string();
  return fs::path(file).extension() == fs::path(path).extension() && name.size() > begin.size() &&
         name.starts_with(begin) && name.find_first_not_of("0123456789", begin.size()) == std::string::npos &&
         place(path) == place(file);
}

void check_parts_output(const std::string& path) {
  const io::Format* format = io::format_of_extension(path);
  if (format && format->write_mesh == io::write_vdb)
    throw OutputError(path + ": .vdb holds a closed surface, which a part of a mesh is not; must be another format");
  if (!format || !format->write_mesh) return check_mesh_output(path);  // which refuses it
  check_output(part_file(path, 1, 1));
  check_output(parts_index(path));
}

WrittenParts write_parts(const std::string& path, const Mesh& mesh, const PartsParams& params,
                         const WriteOptions& options, const Context& context) {
  if (params.triangles == 0) throw ParameterError("triangles of a part = 0, must be > 0");
  io::check_mesh(mesh);
  check_parts_output(path);
  const PartStyle style = style_of(*io::format_of_extension(path), mesh, options);
  const io::MeshBlocks blocks = io::cut_into_blocks(mesh, params.triangles, context);
  io::PartMaker maker(mesh, style.normals);
  WrittenParts written;
  written.index = parts_index(path);
  io::StagedFiles files(ranks_of(context));
  const Context silent = silenced(context);
  for (size_t k = 0; k < blocks.size(); ++k) {
    context.check();
    const Mesh part = maker.part(blocks[k]);
    const std::string file = part_file(path, k + 1, blocks.size());
    WriteReport report;
    files.write(file, [&](io::AtomicFile& to) {
      report = style.origin ? io::write_glb_at(to, part, *style.origin, style.options)
                            : style.format.write_mesh(to, part, style.options, silent);
    });
    written.parts.push_back(
        {file, part.triangles.size(), part.vertices.size(), written_box(part.box(), style, report.double_coordinates)});
    written.report.format = report.format;
    written.report.double_coordinates |= report.double_coordinates;
    if (written.report.warnings.empty()) written.report.warnings = report.warnings;  // of the first that has some
    context.progress().advance(static_cast<double>(k + 1) / static_cast<double>(blocks.size()), {});
  }
  files.write(written.index,
              [&](io::AtomicFile& to) { to.append(index_text(written, params, style, maker.vertices())); });
  check_scratch_files(context.state().scratch_folder);
  files.commit();
  warn_of_other_parts(path, written);
  return written;
}

}  // namespace soapfilm
