#include "soapfilm/io/pcd/pcd.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io/bytes/lzf.h"
#include "soapfilm/io/grid_view.h"
#include "soapfilm/io/pcd/pcd_header.h"
#include "soapfilm/io/point_columns.h"
#include "soapfilm/io/point_table.h"
#include "soapfilm/io/range_image.h"
#include "soapfilm/io/text/number_line.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

/// Values of one field, `stride` bytes apart. Those of text are numbers whatever the field's type.
struct PcdValues {
  const char* at;
  size_t stride;
  size_t count;
  bool is_text = false;
};

template <class T, class Put>
void put_values(const PcdValues& values, const Put& put) {
  for (size_t i = 0; i < values.count; ++i) put(i, static_cast<double>(load_little<T>(values.at + i * values.stride)));
}

/// Calls put(i, value) for each of them.
template <class Put>
void for_each_value(const PcdField& field, const PcdValues& values, const Put& put) {
  if (values.is_text)
    for (size_t i = 0; i < values.count; ++i) put(i, load<double>(values.at + i * values.stride, false));
  else if (field.type == 'F')
    field.size == 4 ? put_values<float>(values, put) : put_values<double>(values, put);
  else if (field.type == 'I')
    field.size == 1   ? put_values<int8_t>(values, put)
    : field.size == 2 ? put_values<int16_t>(values, put)
    : field.size == 4 ? put_values<int32_t>(values, put)
                      : put_values<int64_t>(values, put);
  else
    field.size == 1   ? put_values<uint8_t>(values, put)
    : field.size == 2 ? put_values<uint16_t>(values, put)
    : field.size == 4 ? put_values<uint32_t>(values, put)
                      : put_values<uint64_t>(values, put);
}

/// The four bytes B, G, R, A of a color that text has as a whole number, or as the float with the same bits.
uint32_t packed_color(const PcdField& field, double value) {
  constexpr double most = 4294967295.0;
  if (std::isnan(value)) return 0;
  const bool whole = value == std::floor(value) && std::abs(value) <= most;
  if (field.type == 'F' && !(whole && value >= 1)) return std::bit_cast<uint32_t>(static_cast<float>(value));
  return whole ? static_cast<uint32_t>(static_cast<int64_t>(value)) : 0;
}

/// What the fields mean.
struct PcdLayout : PointColumns {
  size_t packed_color = Triple::absent;
  std::vector<std::string> unused;  ///< names of fields that are neither used nor padding
};

PcdLayout pcd_layout(const PcdHeader& header, const std::vector<std::string>& attributes, const std::string& path) {
  std::vector<std::string> scalars;
  for (const PcdField& field : header.fields)
    scalars.push_back(field.count == 1 && !field.is_padding() ? field.name : std::string());
  PcdLayout layout;
  static_cast<PointColumns&>(layout) = meaning_of(scalars);
  if (!layout.position.present()) throw InputError(path + ": FIELDS lacks x, y or z");
  std::vector<size_t> columns;
  for (const size_t k : layout.others) {
    const PcdField& field = header.fields[k];
    const std::string name = lower_case(field.name);
    if (field.is_padding()) continue;
    const bool is_packed = field.count == 1 && field.size == 4 && (name == "rgb" || name == "rgba");
    if (field.count > 1 || (is_packed && (layout.color.present() || layout.packed_color != Triple::absent)))
      layout.unused.push_back(in_quotes(field.name));
    else if (is_packed)
      layout.packed_color = k;
    else
      columns.push_back(k);
  }
  layout.others = std::move(columns);
  if (keep_attributes(attributes, scalars, layout) &&
      std::find(attributes.begin(), attributes.end(), "color") == attributes.end())
    layout.packed_color = Triple::absent;
  return layout;
}

class PcdReader {
 public:
  PcdReader(ByteSource& source, PointSink& sink, PcdHeader header, const ReadOptions& options, const Context& context)
      : source_(source),
        context_(context),
        header_(std::move(header)),
        layout_(pcd_layout(header_, options.attributes, source.path())),
        stream_(sink) {}

  void read(ReadReport& report, bool trust_viewpoint) {
    if (is_image()) stream_.keep_whole();
    if (header_.data == PcdData::ascii)
      read_text();
    else if (header_.data == PcdData::binary)
      read_binary(report);
    else
      read_compressed(report);
    if (bad_weight_) throw InputError(*bad_weight_);
    if (!layout_.unused.empty())
      report.warnings.push_back(
          fmt::format("{}: fields not used: {}", source_.path(), fmt::join(layout_.unused, ", ")));
    warn_of_color_parts(layout_, source_.path(), report.warnings);
    finish(report, trust_viewpoint);
  }

 private:
  void begin_samples() {
    PointHeader samples;
    samples.samples = header_.points;
    samples.normals = layout_.normal.present();
    samples.sensors = layout_.sensor.present();
    samples.weights = layout_.weight != Triple::absent;
    samples.colors = layout_.color.present() || layout_.packed_color != Triple::absent;
    for (const size_t k : layout_.others) samples.columns.push_back(header_.fields[k].name);
    samples.colors_in_range_of_all = layout_.color.present();
    stream_.begin(samples, source_.path());
  }

  /// Makes room for further samples; their values are put afterwards, from the returned one on.
  size_t grow(size_t count) {
    PointCloud& cloud = stream_.samples();
    const size_t first = cloud.size(), size = first + count;
    cloud.positions.resize(size);
    if (layout_.normal.present()) cloud.normals.resize(size);
    if (layout_.sensor.present()) cloud.sensors.resize(size);
    if (layout_.weight != Triple::absent) cloud.weights.resize(size);
    if (layout_.packed_color != Triple::absent) cloud.colors.resize(size);
    if (layout_.color.present()) colors_.resize(count);
    for (Column& column : cloud.columns) column.values.resize(size);
    first_ = first;
    return first;
  }

  /// All values of the samples that grow() made room for have been put.
  void pass() {
    const PointCloud& cloud = stream_.samples();
    for (const Vec3f& c : colors_)
      stream_.colors().add(static_cast<double>(c.x), static_cast<double>(c.y), static_cast<double>(c.z));
    for (size_t i = first_; i < cloud.weights.size() && !bad_weight_; ++i)
      if (const float weight = cloud.weights[i]; !(weight >= 0) || !std::isfinite(weight))
        bad_weight_ = fmt::format("{}: point {}: weight = {}, must be finite and >= 0", source_.path(),
                                  stream_.passed() + i, weight);
    stream_.pass();
  }

  /// Puts values of field `k` where they belong, from sample `first` on.
  void put(size_t k, size_t first, const PcdValues& values) {
    const PcdField& field = header_.fields[k];
    if (put_axis(layout_.position, k, first, values, stream_.samples().positions)) return;
    if (put_axis(layout_.normal, k, first, values, stream_.samples().normals)) return;
    if (put_axis(layout_.sensor, k, first, values, stream_.samples().sensors)) return;
    if (put_axis(layout_.color, k, first - first_, values, colors_)) return;
    if (k == layout_.packed_color) return put_packed(field, first, values);
    std::vector<float>* to = k == layout_.weight ? &stream_.samples().weights : nullptr;
    for (size_t c = 0; c < layout_.others.size(); ++c)
      if (layout_.others[c] == k) to = &stream_.samples().columns[c].values;
    if (to == nullptr) return;
    for_each_value(field, values, [to, first](size_t i, double v) { (*to)[first + i] = static_cast<float>(v); });
  }

  template <class T>
  bool put_axis(const Triple& triple, size_t k, size_t first, const PcdValues& values, std::vector<Vec3<T>>& to) {
    if (!triple.present()) return false;
    const auto found = std::find(triple.index.begin(), triple.index.end(), k);
    if (found == triple.index.end()) return false;
    const auto axis = static_cast<int>(found - triple.index.begin());
    for_each_value(header_.fields[k], values,
                   [&to, first, axis](size_t i, double v) { to[first + i][axis] = static_cast<T>(v); });
    return true;
  }

  void put_packed(const PcdField& field, size_t first, const PcdValues& values) {
    for (size_t i = 0; i < values.count; ++i) {
      const char* at = values.at + i * values.stride;
      const uint32_t bits = values.is_text ? packed_color(field, load<double>(at, false)) : load_little<uint32_t>(at);
      stream_.samples().colors[first + i] = {static_cast<uint8_t>(bits >> 16 & 255),
                                             static_cast<uint8_t>(bits >> 8 & 255), static_cast<uint8_t>(bits & 255)};
    }
  }

  void read_text() {
    begin_samples();
    TextCursor cursor(source_, header_.body_offset, header_.body_line);
    const size_t width = header_.point_values;
    const size_t points_at_once = std::clamp<size_t>(most_values / width, 1, header_.points);
    std::vector<double> numbers(points_at_once * width);
    std::string_view line;
    std::string buffer;
    for (uint64_t i = 0; i < header_.points;) {
      context_.check();
      const size_t count = std::min<uint64_t>(points_at_once, header_.points - i);
      for (size_t k = 0; k < count; ++k) {
        if (!next_filled_line(cursor, line))
          cursor.fail(fmt::format("truncated: the file ends after {} of {} points", i + k, header_.points));
        const size_t found =
            parse_number_line(cursor, without_commas(line, width, buffer), {numbers.data() + k * width, width});
        if (found != width) cursor.fail(fmt::format("point {}: {} numbers, must be {}", i + k, found, width));
        cursor.release();
      }
      const size_t first = grow(count);
      for (size_t k = 0; k < header_.fields.size(); ++k)
        put(k, first,
            {reinterpret_cast<const char*>(numbers.data() + header_.fields[k].first_value), width * sizeof(double),
             count, true});
      pass();
      i += count;
    }
    if (next_filled_line(cursor, line))
      cursor.fail(
          fmt::format("{} after the last of {} points, must be the end of the file", in_quotes(line), header_.points));
  }

  void read_binary(ReadReport& report) {
    begin_samples();
    ByteCursor cursor(source_, header_.body_offset);
    const size_t points_at_once = std::clamp<size_t>(bytes_at_once / header_.point_bytes, 1, header_.points);
    for (uint64_t i = 0; i < header_.points;) {
      context_.check();
      const size_t count = std::min<uint64_t>(points_at_once, header_.points - i);
      const char* at = cursor.take(count * header_.point_bytes);
      const size_t first = grow(count);
      for (size_t k = 0; k < header_.fields.size(); ++k)
        put(k, first, {at + header_.fields[k].offset, header_.point_bytes, count});
      pass();
      cursor.release();
      i += count;
    }
    warn_of_rest(cursor.remaining(), report);
  }

  /// Field after field, each with the values of all points; with padding or without it.
  void read_compressed(ReadReport& report) {
    ByteCursor cursor(source_, header_.body_offset);
    const uint64_t packed_size = cursor.read<uint32_t>();
    const uint64_t full_size = cursor.read<uint32_t>();
    if (packed_size > cursor.remaining())
      throw InputError(fmt::format("{}: byte {}: compressed size = {}, but the file is truncated: {} bytes are left",
                                   source_.path(), header_.body_offset, packed_size, cursor.remaining()));
    const bool padded = has_padding_inside(full_size);
    const size_t begin = cursor.offset();
    const std::string_view packed(cursor.take(packed_size), packed_size);
    const bool is_lzf = lzf_decoded_size(packed) == full_size;
    if (!is_lzf && packed_size != full_size)
      throw InputError(fmt::format("{}: byte {}: the compressed data is broken: it does not decode to {} bytes",
                                   source_.path(), begin, full_size));
    stream_.keep_whole();
    begin_samples();
    grow(header_.points);
    LzfBytes bytes(packed);
    size_t raw = 0;
    for (size_t k = 0; k < header_.fields.size(); ++k) {
      const PcdField& field = header_.fields[k];
      if (field.is_padding() && !padded) continue;
      const uint64_t size = field.bytes() * header_.points;
      const uint64_t at_once = LzfBytes::most_at_once / field.size * field.size;
      for (uint64_t done = 0; done < size;) {
        context_.check();
        const size_t count = std::min(at_once, size - done);
        const char* at = is_lzf ? bytes.take(count) : packed.data() + raw;
        raw += count;
        const auto rows = [&](uint64_t part) { return static_cast<size_t>(part / field.size); };
        if (field.count == 1) put(k, rows(done), {at, static_cast<size_t>(field.size), rows(count)});
        done += count;
        source_.release_before(begin + (is_lzf ? bytes.used() : raw));
      }
    }
    pass();
    const std::string_view rest = source_.bytes().substr(cursor.offset());
    if (rest.find_first_not_of('\0') != std::string_view::npos)  // the library fills the last page with zeros
      warn_of_rest(rest.size(), report);
  }

  /// Does the decoded content hold the padding between the fields, too? Some writers leave it out.
  bool has_padding_inside(uint64_t full_size) const {
    uint64_t padding = 0;
    for (const PcdField& field : header_.fields)
      if (field.is_padding()) padding += field.bytes();
    if (full_size / header_.points == header_.point_bytes && full_size % header_.points == 0) return true;
    if (full_size / header_.points == header_.point_bytes - padding && full_size % header_.points == 0) return false;
    throw InputError(fmt::format("{}: byte {}: full size = {}, must be {} points of {} bytes", source_.path(),
                                 header_.body_offset + 4, full_size, header_.points, header_.point_bytes));
  }

  void warn_of_rest(size_t bytes, ReadReport& report) const {
    if (bytes > 0)
      report.warnings.push_back(
          fmt::format("{}: {} bytes after the last of {} points are not read", source_.path(), bytes, header_.points));
  }

  void finish(ReadReport& report, bool trust_viewpoint) {
    FileReport file;
    file.path = source_.path();
    file.format = describe(header_.data);
    for (const PcdField& field : header_.fields)
      if (!field.is_padding()) file.properties.push_back(field.name);
    Scan scan;
    scan.name = std::filesystem::path(source_.path()).stem().string();
    scan.end = stream_.size();
    if (is_image()) scan.range_grid = full_grid(static_cast<int>(header_.columns), static_cast<int>(header_.rows));
    place_scanner(scan, trust_viewpoint, report);
    PointEnd end;
    end.scans.push_back(std::move(scan));
    const bool float32 = std::all_of(layout_.position.index.begin(), layout_.position.index.end(), [&](size_t k) {
      return header_.fields[k].type == 'F' && header_.fields[k].size == 4 && header_.data != PcdData::ascii;
    });
    PointTraits traits{.float32 = float32, .zero_is_none = is_image(), .nan_is_none = is_image()};
    traits.whole_colors = layout_.color.present() && header_.fields[layout_.color[0]].type != 'F';
    stream_.finish(std::move(end), std::move(file), traits, report);
    stream_.close();
  }

  bool is_image() const { return header_.columns > 1 && header_.rows > 1; }

  /// Positions stay as they are: the library's users take them to be in the world's frame, like VIEWPOINT itself.
  void place_scanner(Scan& scan, bool trust_viewpoint, ReadReport& report) const {
    const auto& [x, y, z, qw, qx, qy, qz] = header_.viewpoint;
    const bool turned = qx != 0 || qy != 0 || qz != 0;
    const bool is_default = x == 0 && y == 0 && z == 0 && !turned;
    if (is_default && !trust_viewpoint && !is_scanner_place(stream_.samples().positions, scan, {}, false)) return;
    scan.sensor = Vec3d{x, y, z};
    if (turned)
      report.warnings.push_back(fmt::format(
          "{}: VIEWPOINT is turned: only its position ({}, {}, {}) is used; if the points are in the scanner's own "
          "frame, pcl_transform_from_viewpoint moves them",
          source_.path(), x, y, z));
  }

  static constexpr size_t most_values = size_t{1} << 15, bytes_at_once = size_t{1} << 17;  // in the cache

  ByteSource& source_;
  const Context& context_;
  PcdHeader header_;
  PcdLayout layout_;
  PointStream stream_;
  std::vector<Vec3f> colors_;  // of three fields, of the samples that grow() made room for
  size_t first_ = 0;           // of them
  std::optional<std::string> bad_weight_;
};

}  // namespace

void read_pcd(ByteSource& source, PointSink& sink, ReadReport& report, const ReadOptions& options,
              const Context& context) {
  PcdHeader header = read_pcd_header(source, report);
  PcdReader(source, sink, std::move(header), options, context).read(report, options.trust_viewpoint);
}

}  // namespace soapfilm::io
