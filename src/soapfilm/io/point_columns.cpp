#include "soapfilm/io/point_columns.h"

#include <algorithm>
#include <span>

#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

using Names = std::array<std::string_view, 3>;

// As bare() leaves them.
constexpr Names positions[] = {{"x", "y", "z"},
                               {"px", "py", "pz"},
                               {"posx", "posy", "posz"},
                               {"positionx", "positiony", "positionz"},
                               {"pointx", "pointy", "pointz"},
                               {"coordx", "coordy", "coordz"},
                               {"xcoord", "ycoord", "zcoord"},
                               {"xcoordinate", "ycoordinate", "zcoordinate"},
                               {"cartesianx", "cartesiany", "cartesianz"},
                               {"easting", "northing", "elevation"},
                               {"easting", "northing", "height"},
                               {"easting", "northing", "altitude"},
                               {"easting", "northing", "z"},
                               {"east", "north", "up"},
                               {"east", "north", "height"},
                               {"east", "north", "elevation"},
                               {"easting", "northing", "elev"},
                               {"rechtswert", "hochwert", "hoehe"},
                               {"e", "n", "h"},
                               {"e", "n", "z"},
                               {"fieldx", "fieldy", "fieldz"}};
constexpr Names normals[] = {{"nx", "ny", "nz"},
                             {"normalx", "normaly", "normalz"},
                             {"normal0", "normal1", "normal2"},
                             {"normx", "normy", "normz"},
                             {"xnormal", "ynormal", "znormal"}};
constexpr Names sensors[] = {{"sensorx", "sensory", "sensorz"},
                             {"sx", "sy", "sz"},
                             {"xorigin", "yorigin", "zorigin"},
                             {"originx", "originy", "originz"},
                             {"x0", "y0", "z0"},
                             {"xsensor", "ysensor", "zsensor"},
                             {"scannerx", "scannery", "scannerz"},
                             {"viewpointx", "viewpointy", "viewpointz"},
                             {"vpx", "vpy", "vpz"}};
constexpr Names colors[] = {{"red", "green", "blue"},
                            {"r", "g", "b"},
                            {"diffusered", "diffusegreen", "diffuseblue"},
                            {"rf", "gf", "bf"},
                            {"colorred", "colorgreen", "colorblue"},
                            {"colorr", "colorg", "colorb"},
                            {"colourred", "colourgreen", "colourblue"}};
constexpr std::string_view transparencies[] = {"alpha", "a", "af", "diffusealpha", "coloralpha"};

/// A name as it is compared.
std::string bare(std::string_view name) {
  std::string text;
  for (const char c : name) {
    if (c == '(' || c == '[') break;
    if (c >= 'A' && c <= 'Z')
      text += static_cast<char>(c - 'A' + 'a');
    else if (c > ' ' && std::string_view("\"'_.-/#").find(c) == std::string_view::npos)
      text += c;
  }
  return text;
}

Triple find(const std::vector<std::string>& names, std::span<const Names> spellings) {
  for (const Names& spelling : spellings) {
    Triple triple;
    for (size_t k = 0; k < 3; ++k) {
      const auto found = std::find(names.begin(), names.end(), spelling[k]);
      if (found != names.end()) triple.index[k] = static_cast<size_t>(found - names.begin());
    }
    if (triple.present()) return triple;
  }
  return {};
}

bool is_one_of(const std::string& name, std::span<const Names> spellings) {
  return std::any_of(spellings.begin(), spellings.end(),
                     [&](const Names& s) { return std::find(s.begin(), s.end(), name) != s.end(); });
}

bool is_one_of(const std::string& name, std::span<const std::string_view> list) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

}  // namespace

PointColumns meaning_of(const std::vector<std::string>& names) {
  std::vector<std::string> bares;
  for (const std::string& name : names) bares.push_back(bare(name));
  PointColumns columns;
  columns.position = find(bares, positions);
  columns.normal = find(bares, normals);
  columns.sensor = find(bares, sensors);
  columns.color = find(bares, colors);
  std::vector<bool> used(names.size());
  for (const Triple& triple : {columns.position, columns.normal, columns.sensor, columns.color})
    if (triple.present())
      for (const size_t k : triple.index) used[k] = true;
  for (size_t k = 0; k < names.size(); ++k) {
    if (used[k]) continue;
    if (bares[k] == "weight" && columns.weight == Triple::absent)
      columns.weight = k;
    else if (!(columns.color.present() && is_one_of(bares[k], transparencies)))
      columns.others.push_back(k);
  }
  return columns;
}

bool is_known_column(std::string_view name) {
  constexpr std::string_view known[] = {"weight",     "intensity", "i",    "scalarintensity", "reflectance",
                                        "confidence", "label",     "time", "gpstime",         "classification"};
  const std::string text = bare(name);
  return is_one_of(text, positions) || is_one_of(text, normals) || is_one_of(text, sensors) ||
         is_one_of(text, colors) || is_one_of(text, known);
}

std::string column_name(std::string_view name) {
  const auto is_around = [](char c) { return c == '"' || c == '\'' || is_blank(c); };
  while (!name.empty() && (is_around(name.front()) || name.front() == '/' || name.front() == '#'))
    name.remove_prefix(1);
  while (!name.empty() && is_around(name.back())) name.remove_suffix(1);
  constexpr std::string_view before = "scalar_";
  if (name.size() > before.size() && lower_case(name.substr(0, before.size())) == before)
    name.remove_prefix(before.size());
  std::string word(name);
  std::replace_if(
      word.begin(), word.end(), [](char c) { return c <= ' ' || c > '~'; }, '_');
  return word;
}

bool holds_labels(std::string_view name) {
  constexpr std::string_view labels[] = {
      "label",  "classification", "class",       "category",    "instance", "segment", "scanid", "pointsourceid",
      "object", "returnnumber",   "returnindex", "returncount", "ring",     "id",      "index",  "scannerchannel"};
  return is_one_of(bare(name), labels);
}

}  // namespace soapfilm::io
