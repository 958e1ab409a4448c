#include "soapfilm/io/sets/meshlab.h"

#include <fmt/format.h>

#include <algorithm>

#include "soapfilm/core/placement.h"
#include "soapfilm/error.h"
#include "soapfilm/io/e57/xml.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

SetMember placed_member(std::string file, const Placement& pose) {
  return {std::move(file), [pose](PointCloud& cloud) {
            if (!(pose == Placement{})) place_cloud(pose, cloud);
          }};
}

/// The meshes of a project.
class MlpReader {
 public:
  MlpReader(ByteSource& source, ReadReport& report)
      : source_(source),
        report_(report),
        xml_({source.bytes().begin(), source.bytes().end()}, 4 * source.bytes().size() + (size_t{64} << 20),
             [this](size_t offset) { return place_of(offset); }) {}

  std::vector<SetMember> read() {
    const pugi::xml_node root = xml_.root();
    if (local_name(root) != "MeshLabProject")
      xml_.fail(root, fmt::format("{}, must be MeshLabProject", in_quotes(local_name(root))));
    for (const pugi::xml_node& group : root.children()) {
      if (local_name(group) != "MeshGroup") continue;  // a RasterGroup holds pictures
      for (const pugi::xml_node& mesh : group.children())
        if (local_name(mesh) == "MLMesh") add(mesh);
    }
    if (hidden_ > 0)
      report_.warnings.push_back(
          fmt::format("{}: not read, as MeshLab hides them (visible=\"0\"): {}", source_.path(),
                      first_hidden_ + (hidden_ == 1 ? "" : fmt::format(" and {} more", hidden_ - 1))));
    if (members_.empty()) throw InputError(source_.path() + ": has no visible MLMesh, must name at least one scan");
    return std::move(members_);
  }

 private:
  std::string place_of(size_t offset) const {
    const std::string_view text = source_.bytes().substr(0, offset);
    return fmt::format("{}:{}", source_.path(), 1 + std::count(text.begin(), text.end(), '\n'));
  }

  void add(const pugi::xml_node& mesh) {
    const std::string file = mesh.attribute("filename").value();
    if (file.empty()) xml_.fail(mesh, "MLMesh without a filename");
    if (mesh.attribute("visible") && std::string_view(mesh.attribute("visible").value()) == "0") {
      if (hidden_++ == 0) first_hidden_ = in_quotes(file);
      return;
    }
    if (const int64_t id = xml_.integer(mesh, "idInFile").value_or(-1); id > 0)
      xml_.fail(mesh, fmt::format("MLMesh {}: idInFile = {}, must be 0 or -1: files of several meshes cannot be read",
                                  in_quotes(file), id));
    const pugi::xml_node matrix = child_of(mesh, "MLMatrix44");
    members_.push_back(placed_member(file, matrix ? read_matrix(matrix, file) : Placement{}));
  }

  Placement read_matrix(const pugi::xml_node& node, const std::string& file) const {
    std::array<double, 16> matrix{};
    std::string_view text = node.child_value(), field;
    size_t count = 0;
    for (; next_field(text, field); ++count) {
      double value = 0;
      if (!parse_number(field, value))
        xml_.fail(node, fmt::format("MLMatrix44 of {}: {}, must be a number", in_quotes(file), in_quotes(field)));
      if (count < matrix.size()) matrix[count] = value;
    }
    if (count != matrix.size())
      xml_.fail(node, fmt::format("MLMatrix44 of {}: {} numbers, must be 16", in_quotes(file), count));
    std::string error;
    const Placement pose = placement_of_matrix(matrix, error);
    if (!error.empty()) xml_.fail(node, fmt::format("MLMatrix44 of {} {}", in_quotes(file), error));
    return pose;
  }

  ByteSource& source_;
  ReadReport& report_;
  Xml xml_;
  std::vector<SetMember> members_;
  size_t hidden_ = 0;
  std::string first_hidden_;
};

/// The count of meshes; for each its file's name, a line with #, and a matrix; a 0 at the end.
class AlnReader {
 public:
  explicit AlnReader(ByteSource& source) : cursor_(source) {}

  std::vector<SetMember> read() {
    const std::string_view first = line("the number of meshes");
    int64_t count = 0;
    if (!parse_integer(first, count) || count < 1)
      cursor_.fail(fmt::format("number of meshes = {}, must be an integer > 0", in_quotes(first)));
    std::vector<SetMember> members;
    for (int64_t i = 0; i < count; ++i) {
      const std::string file(line(fmt::format("mesh {} of {}", i + 1, count)));
      members.push_back(placed_member(file, read_matrix(file)));
    }
    std::string_view rest;
    while (cursor_.next_content_line(rest))
      if (trimmed_line(rest) != "0")
        cursor_.fail(fmt::format("{} after {} meshes, must be 0 or the end of the file", in_quotes(rest), count));
    return members;
  }

 private:
  static std::string_view trimmed_line(std::string_view text) {
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
  }

  /// The next line that is neither blank nor begins with #.
  std::string_view line(const std::string& what) {
    std::string_view text;
    if (!cursor_.next_content_line(text)) cursor_.fail("truncated: the file ends where " + what + " must follow");
    return trimmed_line(text);
  }

  Placement read_matrix(const std::string& file) {
    std::array<double, 16> matrix{};
    for (size_t row = 0; row < 4; ++row) {
      std::string_view text = line("the matrix of " + in_quotes(file)), field;
      size_t column = 0;
      for (; next_field(text, field); ++column)
        if (column < 4 && !parse_number(field, matrix[4 * row + column]))
          cursor_.fail(fmt::format("matrix of {}: {}, must be a number", in_quotes(file), in_quotes(field)));
      if (column != 4) cursor_.fail(fmt::format("matrix of {}: row of {} numbers, must be 4", in_quotes(file), column));
    }
    std::string error;
    const Placement pose = placement_of_matrix(matrix, error);
    if (!error.empty()) cursor_.fail(fmt::format("matrix of {} {}", in_quotes(file), error));
    return pose;
  }

  TextCursor cursor_;
};

}  // namespace

std::vector<SetMember> mlp_members(ByteSource& source, ReadReport& report) { return MlpReader(source, report).read(); }

std::vector<SetMember> aln_members(ByteSource& source, ReadReport& /*report*/) { return AlnReader(source).read(); }

PointCloud read_mlp(ByteSource& source, ReadReport& report, const ReadOptions& options, const Context& context) {
  return read_members(source, "MLMesh", mlp_members(source, report), report, options, context);
}

PointCloud read_aln(ByteSource& source, ReadReport& report, const ReadOptions& options, const Context& context) {
  return read_members(source, "the alignment", aln_members(source, report), report, options, context);
}

}  // namespace soapfilm::io
