#include "soapfilm/io/kitti.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <filesystem>

#include "soapfilm/error.h"
#include "soapfilm/io/bytes/binary_fields.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

constexpr size_t kitti_columns = 4;
constexpr size_t nuscenes_columns = 5;
constexpr std::array<std::string_view, nuscenes_columns> sweep_names{"x", "y", "z", "intensity", "ring"};

/// Meters of a scanner at the origin. Whole numbers and text read as 32-bit floats are tiny, halves of doubles are
/// anything.
bool is_sweep_coordinate(float value) {
  constexpr float farthest = 1e6F, nearest = 1e-18F;
  return value == 0 || (std::abs(value) < farthest && std::abs(value) > nearest);
}

class SweepReader {
 public:
  SweepReader(ByteSource& source, const Context& context) : source_(source), context_(context) {}

  /// The number of columns. Throws InputError.
  size_t find_columns() const {
    if (is_text())
      throw InputError(source_.path() +
                       ": is text, must be 32-bit numbers x y z intensity (name it .xyz to read text)");
    const size_t size = source_.bytes().size();
    const bool rings = may_have_rings();
    if (rings && (size % 16 != 0 || is_named_nuscenes() || has_negative_intensity())) return nuscenes_columns;
    if (size % 16 != 0)
      throw InputError(
          fmt::format("{}: {} bytes, must be a multiple of 16: rows of 32-bit x y z intensity", source_.path(), size));
    return kitti_columns;
  }

  /// Throws InputError at the first number that none of a sweep can be.
  void check(size_t columns) const {
    for (size_t row = 0; row < rows(columns); ++row) {
      if (row % FieldReader::block_rows == 0) context_.check();
      for (size_t k = 0; k < kitti_columns; ++k) {
        const float v = value(row * columns + k);
        if (k < 3 ? is_sweep_coordinate(v) : std::isfinite(v)) continue;
        throw InputError(fmt::format("{}: byte {}: {} = {}, must be {}: this is no file of 32-bit x y z intensity",
                                     source_.path(), (row * columns + k) * sizeof(float), sweep_names[k], v,
                                     k < 3 ? "0 or from 1e-18 to 1e6 in size" : "finite"));
      }
    }
  }

  PointTraits read(size_t columns, const std::vector<std::string>& attributes, PointStream& stream) {
    std::vector<BinaryField> fields;
    std::vector<std::string> names;
    for (size_t k = 0; k < columns; ++k) {
      names.emplace_back(sweep_names[k]);
      BinaryField field{.name = names.back()};
      field.offset = k * sizeof(float);
      field.stride = columns * sizeof(float);
      field.swap = std::endian::native != std::endian::little;
      fields.push_back(std::move(field));
    }
    PointColumns meaning = meaning_of(names);
    keep_attributes(attributes, names, meaning);
    FieldReader reader(source_, fields, std::move(meaning));
    stream.begin(reader.header(rows(columns)), source_.path());
    for (size_t first = 0; first < rows(columns); first += FieldReader::block_rows) {
      context_.check();
      reader.append(first, std::min(FieldReader::block_rows, rows(columns) - first), nullptr, stream);
      stream.pass();
      source_.release_before(first * columns * sizeof(float));
    }
    PointTraits traits = reader.traits();
    traits.float32 = traits.zero_is_none = true;
    return traits;
  }

 private:
  size_t rows(size_t columns) const { return source_.bytes().size() / (columns * sizeof(float)); }
  float value(size_t index) const { return load_little<float>(source_.bytes().data() + index * sizeof(float)); }

  bool is_text() const {
    const std::string_view head = source_.bytes().substr(0, 4096);
    return std::all_of(head.begin(), head.end(), [](char c) { return is_blank(c) || (c >= ' ' && c <= '~'); });
  }

  bool is_named_nuscenes() const {
    const std::string name = lower_case(source_.path());
    return name.size() > 8 && name.substr(name.size() - 8) == ".pcd.bin";
  }

  /// Is every fifth number a whole one, and the one before it an intensity? Of four columns nothing looks like that.
  bool may_have_rings() const {
    constexpr float most_rings = 255;
    if (source_.bytes().size() % (nuscenes_columns * sizeof(float)) != 0) return false;
    for (size_t row = 0; row < rows(nuscenes_columns); ++row) {
      const float intensity = value(row * nuscenes_columns + 3), ring = value(row * nuscenes_columns + 4);
      if (!(ring >= 0 && ring <= most_rings) || ring != std::floor(ring) || !(intensity >= 0)) return false;
    }
    return true;
  }

  /// Read as four columns.
  bool has_negative_intensity() const {
    for (size_t row = 0; row < rows(kitti_columns); ++row)
      if (value(row * kitti_columns + 3) < 0) return true;
    return false;
  }

  ByteSource& source_;
  const Context& context_;
};

}  // namespace

void read_kitti(ByteSource& source, PointSink& sink, ReadReport& report, const ReadOptions& options,
                const Context& context) {
  SweepReader reader(source, context);
  const size_t columns = reader.find_columns();
  reader.check(columns);
  PointStream stream(sink);
  const PointTraits traits = reader.read(columns, options.attributes, stream);
  Scan scan;
  scan.name = std::filesystem::path(source.path()).stem().string();
  scan.end = stream.size();
  scan.sensor = Vec3d{0, 0, 0};
  FileReport file;
  file.path = source.path();
  file.format = columns == kitti_columns ? "KITTI sweep, 32-bit x y z intensity"
                                         : "nuScenes sweep, 32-bit x y z "
                                           "intensity ring";
  for (size_t k = 0; k < columns; ++k) file.properties.emplace_back(sweep_names[k]);
  PointEnd end;
  end.scans.push_back(std::move(scan));
  stream.finish(std::move(end), std::move(file), traits, report);
  stream.close();
}

}  // namespace soapfilm::io
