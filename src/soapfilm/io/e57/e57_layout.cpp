#include "soapfilm/io/e57/e57_layout.h"

#include <fmt/format.h>

#include <algorithm>

#include "soapfilm/error.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

class E57LayoutFinder {
 public:
  explicit E57LayoutFinder(const E57Scan& scan) : scan_(scan), taken_(scan.fields.size()) {}

  E57Layout find(const std::string& path, std::vector<std::string>& ignored) {
    for (size_t k = 0; k < scan_.fields.size(); ++k)
      if (scan_.fields[k].kind == E57Field::Kind::text) {
        taken_[k] = true;
        ignored.push_back(fmt::format("{} (text)", in_quotes(scan_.fields[k].name)));
      }
    find_position(path);
    take(layout_.normal, meaning_.normal);
    take(layout_.sensor, meaning_.sensor);
    take(layout_.color, meaning_.color);
    layout_.color_state = take("isColorInvalid");
    if (meaning_.weight != Triple::absent) taken_[layout_.weight = meaning_.weight] = true;
    find_cells();
    find_further();
    return layout_;
  }

 private:
  size_t index_of(std::string_view name) const {
    for (size_t k = 0; k < scan_.fields.size(); ++k)
      if (scan_.fields[k].name == name && scan_.fields[k].kind != E57Field::Kind::text) return k;
    return Triple::absent;
  }
  size_t take(std::string_view name) {
    const size_t k = index_of(name);
    if (k != Triple::absent) taken_[k] = true;
    return k;
  }
  void take(Triple& to, const Triple& from) {
    if (!from.present()) return;
    to = from;
    for (const size_t k : from.index) taken_[k] = true;
  }

  void find_position(const std::string& path) {
    std::vector<std::string> names;  // of text none is compared
    for (const E57Field& field : scan_.fields)
      names.push_back(field.kind == E57Field::Kind::text ? std::string() : field.name);
    meaning_ = meaning_of(names);
    const Triple cartesian{{take("cartesianX"), take("cartesianY"), take("cartesianZ")}};
    const Triple spherical{{take("sphericalRange"), take("sphericalAzimuth"), take("sphericalElevation")}};
    const size_t cartesian_state = take("cartesianInvalidState"), spherical_state = take("sphericalInvalidState");
    layout_.spherical = !cartesian.present() && spherical.present();  // with both, they say the same
    layout_.position = layout_.spherical ? spherical : cartesian;
    layout_.position_state = layout_.spherical ? spherical_state : cartesian_state;
    if (!layout_.position.present()) take(layout_.position, meaning_.position);
    if (!layout_.position.present())
      throw InputError(fmt::format(
          "{}: points of {}: have no position, must have cartesianX, cartesianY, cartesianZ or sphericalRange, "
          "sphericalAzimuth, sphericalElevation",
          path, in_quotes(scan_.name)));
  }

  void find_cells() {
    layout_.return_index = index_of("returnIndex");
    const size_t row = index_of("rowIndex"), column = index_of("columnIndex");
    if (row == Triple::absent || column == Triple::absent) return;
    layout_.row = row;
    layout_.column = column;
    taken_[row] = taken_[column] = true;
  }

  void find_further() {
    const size_t time = index_of("timeStamp");
    const size_t time_state = take("isTimeStampInvalid"), intensity_state = take("isIntensityInvalid");
    for (size_t k = 0; k < scan_.fields.size(); ++k) {
      if (taken_[k] || is_transparency(k)) continue;
      E57Layout::Further further{k, scan_.fields[k].name};
      if (k == time) further = {k, "time", time_state, true};
      if (further.name == "intensity") further.state = intensity_state;
      const std::string name = further.name;
      for (int n = 2; has_name(further.name); ++n) further.name = fmt::format("{}_{}", name, n);
      layout_.further.push_back(std::move(further));
    }
  }

  /// What has a meaning, but not that of the groups or of a column.
  bool is_transparency(size_t k) const {
    if (std::find(meaning_.others.begin(), meaning_.others.end(), k) != meaning_.others.end()) return false;
    for (const Triple& triple : {meaning_.position, meaning_.normal, meaning_.sensor, meaning_.color})
      if (triple.present() && std::find(triple.index.begin(), triple.index.end(), k) != triple.index.end())
        return false;
    return true;
  }

  bool has_name(const std::string& name) const {
    return std::any_of(layout_.further.begin(), layout_.further.end(),
                       [&](const E57Layout::Further& f) { return f.name == name; });
  }

  const E57Scan& scan_;
  std::vector<bool> taken_;
  PointColumns meaning_;
  E57Layout layout_;
};

}  // namespace

std::vector<bool> E57Layout::used(size_t fields) const {
  std::vector<bool> all(fields);
  const auto use = [&](size_t k) {
    if (k != Triple::absent) all[k] = true;
  };
  for (const Triple& triple : {position, normal, sensor, color})
    if (triple.present())
      for (const size_t k : triple.index) use(k);
  for (const size_t k : {weight, position_state, row, column}) use(k);
  if (color.present()) use(color_state);
  if (has_cells()) use(return_index);
  for (const Further& f : further) {
    use(f.field);
    use(f.state);
  }
  return all;
}

E57Layout e57_layout(const E57Scan& scan, const std::string& path, std::vector<std::string>& ignored) {
  return E57LayoutFinder(scan).find(path, ignored);
}

}  // namespace soapfilm::io
