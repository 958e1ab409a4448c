#include "soapfilm/io/e57/e57_head.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "soapfilm/error.h"
#include "soapfilm/io/e57/xml.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

// What the standard has besides points and poses: it describes the scan, no sample and no surface. Pictures are in
// images2D.
constexpr std::string_view e57_root_parts[] = {
    "formatName",       "guid",   "versionMajor", "versionMinor", "e57LibraryVersion", "coordinateMetadata",
    "creationDateTime", "data3D", "images2D"};
constexpr std::string_view e57_scan_parts[] = {"guid",
                                               "name",
                                               "description",
                                               "originalGuids",
                                               "sensorVendor",
                                               "sensorModel",
                                               "sensorSerialNumber",
                                               "sensorHardwareVersion",
                                               "sensorSoftwareVersion",
                                               "sensorFirmwareVersion",
                                               "temperature",
                                               "relativeHumidity",
                                               "atmosphericPressure",
                                               "indexBounds",
                                               "cartesianBounds",
                                               "sphericalBounds",
                                               "intensityLimits",
                                               "colorLimits",
                                               "acquisitionStart",
                                               "acquisitionEnd",
                                               "pose",
                                               "points",
                                               "pointGroupingSchemes"};

/// Converters copy the system identifier of LAS files, which often names a program or what was done with the points.
bool is_name_of_scanner(const std::string& name) {
  constexpr std::string_view no_scanners[] = {"las",          "pdal",       "liblas",         "cloudcompare", "merge",
                                              "modification", "extraction", "transformation", "other",        "unknown",
                                              "none",         "n/a",        "unified",        "converted"};
  const std::string text = lower_case(name);
  return !text.empty() && std::none_of(std::begin(no_scanners), std::end(no_scanners),
                                       [&](std::string_view word) { return text.substr(0, word.size()) == word; });
}

class E57HeadReader {
 public:
  E57HeadReader(E57Pages& pages, const Xml& xml) : pages_(pages), xml_(xml) {}

  E57Head read() {
    const pugi::xml_node root = xml_.root();
    if (local_name(root) != "e57Root")
      xml_.fail(root, fmt::format("XML begins with {}, must be e57Root", in_quotes(local_name(root))));
    note_unknown(root, e57_root_parts);
    E57Head head;
    head.coordinate_system = plain_text(child_of(root, "coordinateMetadata"));
    size_t number = 0;
    for (const pugi::xml_node& child : child_of(root, "data3D").children()) {
      if (child.type() != pugi::node_element) continue;
      E57Scan scan = read_scan(child, ++number);
      if (scan.records > 0) head.scans.push_back(std::move(scan));
    }
    return head;
  }

  const std::vector<std::string>& unknown() const { return unknown_; }

 private:
  template <size_t N>
  void note_unknown(const pugi::xml_node& node, const std::string_view (&known)[N]) {
    constexpr size_t most_named = 8;
    for (const pugi::xml_node& child : node.children()) {
      if (child.type() != pugi::node_element || unknown_.size() == most_named) continue;
      const std::string_view name = local_name(child);
      if (std::find(std::begin(known), std::end(known), name) != std::end(known)) continue;
      const std::string quoted = in_quotes(name);
      if (std::find(unknown_.begin(), unknown_.end(), quoted) == unknown_.end()) unknown_.push_back(quoted);
    }
  }

  E57Scan read_scan(const pugi::xml_node& node, size_t number) {
    note_unknown(node, e57_scan_parts);
    E57Scan scan;
    scan.name = plain_text(child_of(node, "name"));
    if (scan.name.empty()) scan.name = plain_text(child_of(node, "guid"));
    if (scan.name.empty()) scan.name = fmt::format("scan {}", number);
    scan.names_scanner = is_name_of_scanner(plain_text(child_of(node, "sensorModel"))) ||
                         is_name_of_scanner(plain_text(child_of(node, "sensorSerialNumber")));
    if (const pugi::xml_node pose = child_of(node, "pose")) scan.pose = read_pose(pose);
    if (const pugi::xml_node limits = child_of(node, "colorLimits")) scan.color_limits = read_color_limits(limits);

    const pugi::xml_node points = child_of(node, "points");
    const int64_t records = points ? xml_.integer(points, "recordCount").value_or(0) : 0;
    if (records < 0) xml_.fail(points, fmt::format("points: recordCount = {}, must be >= 0", records));
    if (records == 0) return scan;
    scan.records = static_cast<uint64_t>(records);
    const std::optional<int64_t> offset = xml_.integer(points, "fileOffset");
    if (!offset || *offset < 0)
      xml_.fail(points,
                offset ? fmt::format("points: fileOffset = {}, must be >= 0", *offset) : "points: has no fileOffset");
    scan.section = pages_.logical(static_cast<uint64_t>(*offset), "points: fileOffset");
    check_codecs(child_of(points, "codecs"));
    read_fields(child_of(points, "prototype"), 0, scan.fields);
    if (scan.fields.empty()) xml_.fail(points, "points: the prototype has no fields");
    return scan;
  }

  Placement read_pose(const pugi::xml_node& node) const {
    const auto part = [&](const pugi::xml_node& of, const char* name) {
      const pugi::xml_node child = child_of(of, name);
      const double value = child ? xml_.number(child) : 0;
      if (!std::isfinite(value)) xml_.fail(child, fmt::format("pose: {} = {}, must be finite", name, value));
      return value;
    };
    Placement pose;
    if (const pugi::xml_node rotation = child_of(node, "rotation")) {
      const double w = part(rotation, "w"), x = part(rotation, "x"), y = part(rotation, "y"), z = part(rotation, "z");
      if (w == 0 && x == 0 && y == 0 && z == 0)
        xml_.fail(rotation, "pose: rotation = (0, 0, 0, 0), must be a quaternion of length 1");
      pose = placement_of_quaternion(w, x, y, z);
    }
    if (const pugi::xml_node translation = child_of(node, "translation"))
      pose.translation = {part(translation, "x"), part(translation, "y"), part(translation, "z")};
    return pose;
  }

  std::optional<std::array<double, 2>> read_color_limits(const pugi::xml_node& node) const {
    std::array<double, 2> limits{HUGE_VAL, -HUGE_VAL};
    for (const char* channel : {"Red", "Green", "Blue"}) {
      const pugi::xml_node low = child_of(node, fmt::format("color{}Minimum", channel));
      const pugi::xml_node high = child_of(node, fmt::format("color{}Maximum", channel));
      if (!low || !high) return std::nullopt;
      limits = {std::min(limits[0], xml_.number(low)), std::max(limits[1], xml_.number(high))};
    }
    return limits;
  }

  /// The standard knows one codec, which is also the one without saying so.
  void check_codecs(const pugi::xml_node& codecs) const {
    for (const pugi::xml_node& codec : codecs.children())
      for (const pugi::xml_node& part : codec.children())
        if (part.type() == pugi::node_element && local_name(part) != "inputs" && local_name(part) != "bitPackCodec")
          xml_.fail(part, fmt::format("codec {}, must be bitPackCodec", in_quotes(local_name(part))));
  }

  /// The fields in the order of their streams, also those in structures of the prototype.
  void read_fields(const pugi::xml_node& node, int depth, std::vector<E57Field>& fields) const {
    constexpr int deepest = 8;
    constexpr size_t most_fields = 256;
    for (const pugi::xml_node& child : node.children()) {
      if (child.type() != pugi::node_element) continue;
      const std::string_view type = child.attribute("type").value();
      if (type == "Structure" || type == "Vector") {
        if (depth == deepest) xml_.fail(child, fmt::format("prototype of structures more than {} deep", deepest));
        read_fields(child, depth + 1, fields);
      } else {
        if (fields.size() == most_fields)
          xml_.fail(child, fmt::format("prototype of more than {} fields", most_fields));
        fields.push_back(read_field(child, type));
      }
    }
  }

  E57Field read_field(const pugi::xml_node& node, std::string_view type) const {
    E57Field field;
    field.name = std::string(local_name(node));
    if (type == "Float") {
      const std::string_view precision = node.attribute("precision").value();
      if (precision != "" && precision != "single" && precision != "double")
        xml_.fail(node, fmt::format("{}: precision {}, must be single or double", field.name, in_quotes(precision)));
      field.kind = precision == "single" ? E57Field::Kind::float32 : E57Field::Kind::float64;
      field.bits = precision == "single" ? 32 : 64;
      const auto low = xml_.number(node, "minimum"), high = xml_.number(node, "maximum");
      if (low && high) field.range = {*low, *high};
    } else if (type == "Integer" || type == "ScaledInteger") {
      read_integer(node, type == "ScaledInteger", field);
    } else if (type == "String") {
      field.kind = E57Field::Kind::text;
      field.bits = 0;
    } else {
      xml_.fail(node, fmt::format("{}: type {}, must be Float, Integer, ScaledInteger or String", in_quotes(field.name),
                                  in_quotes(type)));
    }
    return field;
  }

  void read_integer(const pugi::xml_node& node, bool scaled, E57Field& field) const {
    const std::optional<int64_t> low = xml_.integer(node, "minimum"), high = xml_.integer(node, "maximum");
    const int64_t least = low.value_or(INT64_MIN), most = high.value_or(INT64_MAX);
    if (least > most)
      xml_.fail(node,
                fmt::format("{}: minimum = {}, must be at most the maximum = {}", in_quotes(field.name), least, most));
    field.kind = E57Field::Kind::integer;
    const uint64_t span = static_cast<uint64_t>(most) - static_cast<uint64_t>(least);
    field.bits = static_cast<int>(std::bit_width(span));
    field.minimum = least;
    if (scaled) {
      field.scale = xml_.number(node, "scale").value_or(1);
      field.offset = xml_.number(node, "offset").value_or(0);
      if (!std::isfinite(field.scale) || !std::isfinite(field.offset) || field.scale == 0)
        xml_.fail(node, fmt::format("{}: scale = {}, offset = {}, must be finite and the scale not 0",
                                    in_quotes(field.name), field.scale, field.offset));
    }
    if (!low || !high) return;
    const double first = field.value(0), last = field.value(span);
    field.range = {std::min(first, last), std::max(first, last)};
  }

  E57Pages& pages_;
  const Xml& xml_;
  std::vector<std::string> unknown_;
};

}  // namespace

uint64_t E57Scan::bits() const {
  uint64_t sum = 0;
  for (const E57Field& field : fields) sum += static_cast<uint64_t>(field.bits);
  return sum;
}

E57Head read_e57_head(E57Pages& pages, ReadReport& report) {
  std::vector<char> text(pages.xml_length());
  pages.read(pages.xml_offset(), text.data(), text.size());
  const size_t budget = 4 * pages.file_size() + (size_t{64} << 20);
  const Xml xml(std::move(text), budget, [&](size_t offset) {
    return fmt::format("{}: byte {}", pages.path(), pages.physical(pages.xml_offset() + offset));
  });
  E57HeadReader reader(pages, xml);
  E57Head head = reader.read();
  if (!reader.unknown().empty())
    report.warnings.push_back(fmt::format("{}: ignored, as it is not known what it means: {}", pages.path(),
                                          fmt::join(reader.unknown(), ", ")));
  if (pages.left_over() > 0)
    report.warnings.push_back(
        fmt::format("{}: {} bytes ignored after the end that the header gives", pages.path(), pages.left_over()));
  return head;
}

}  // namespace soapfilm::io
