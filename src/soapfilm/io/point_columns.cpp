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
                               {"fieldx", "fieldy", "fieldz"},
                               {"point0", "point1", "point2"},
                               {"points0", "points1", "points2"},
                               {"pointsx", "pointsy", "pointsz"},
                               {"position0", "position1", "position2"},
                               {"positions0", "positions1", "positions2"},
                               {"pos0", "pos1", "pos2"},
                               {"xyz0", "xyz1", "xyz2"},
                               {"xm", "ym", "zm"},
                               {"xmm", "ymm", "zmm"},
                               {"xworld", "yworld", "zworld"},
                               {"worldx", "worldy", "worldz"},
                               {"coordinates0", "coordinates1", "coordinates2"},
                               {"coordinatex", "coordinatey", "coordinatez"},
                               {"coords0", "coords1", "coords2"},
                               {"coord0", "coord1", "coord2"},
                               {"easting", "northing", "alt"},
                               {"easting", "northing", "h"},
                               {"easting", "northing", "up"},
                               {"easting", "northing", "elevationz"},
                               {"east", "north", "z"},
                               {"east", "north", "h"},
                               {"east", "north", "elev"},
                               {"east", "north", "alt"},
                               {"east", "north", "altitude"},
                               {"e", "n", "elevation"},
                               {"e", "n", "elev"},
                               {"e", "n", "height"},
                               {"e", "n", "u"},
                               {"e", "n", "up"},
                               {"e", "n", "alt"},
                               {"utmeasting", "utmnorthing", "elevation"},
                               {"utmeasting", "utmnorthing", "height"},
                               {"utmeasting", "utmnorthing", "altitude"},
                               {"utmeasting", "utmnorthing", "z"},
                               {"utmx", "utmy", "z"},
                               {"x", "y", "height"},
                               {"x", "y", "elevation"},
                               {"x", "y", "altitude"},
                               {"x", "y", "h"},
                               {"rechtswert", "hochwert", "h\xC3\xB6he"},
                               {"ostwert", "nordwert", "hoehe"},
                               {"ostwert", "nordwert", "h\xC3\xB6he"},
                               {"x0", "y0", "z0"},  // beside x y z a sensor's
                               {"x1", "y1", "z1"}};
constexpr Names normals[] = {{"nx", "ny", "nz"},
                             {"normalx", "normaly", "normalz"},
                             {"normal0", "normal1", "normal2"},
                             {"normals0", "normals1", "normals2"},
                             {"normalsx", "normalsy", "normalsz"},
                             {"nx0", "ny0", "nz0"},
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
                            {"colourred", "colourgreen", "colourblue"},
                            {"rgb0", "rgb1", "rgb2"},
                            {"rgba0", "rgba1", "rgba2"},
                            {"color0", "color1", "color2"},
                            {"colors0", "colors1", "colors2"}};
constexpr Names splats{"fdc0", "fdc1", "fdc2"};
constexpr std::string_view transparencies[] = {"alpha", "a", "af", "diffusealpha", "coloralpha"};

bool is_beyond_ascii(char c) { return static_cast<unsigned char>(c) >= 0x80; }

/// A name as it is compared.
std::string bare(std::string_view name) {
  std::string text;
  for (const char c : name) {
    if (c == '(' || c == '[') break;
    if (c >= 'A' && c <= 'Z')
      text += static_cast<char>(c - 'A' + 'a');
    else if ((c > ' ' || is_beyond_ascii(c)) && std::string_view("\"'_.-/#:").find(c) == std::string_view::npos)
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

/// Names of some, but not all channels of a color; none if there are no such. A single `r` may be a range.
std::string color_parts(const std::vector<std::string>& names, const std::vector<std::string>& bares) {
  for (const Names& spelling : colors) {
    std::string parts;
    size_t count = 0;
    for (const std::string_view channel : spelling) {
      const auto found = std::find(bares.begin(), bares.end(), channel);
      if (found == bares.end()) continue;
      parts += (count++ == 0 ? "" : ", ") + in_quotes(names[static_cast<size_t>(found - bares.begin())]);
    }
    const bool clear = spelling[2].find("blue") != std::string_view::npos;
    if (count > (clear ? 0u : 1u)) return parts;
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
  if (columns.sensor.index == columns.position.index) columns.sensor = {};
  columns.color = find(bares, colors);
  if (!columns.color.present()) columns.splat_color = find(bares, {&splats, 1});
  columns.color_parts = columns.color.present() ? std::string() : color_parts(names, bares);
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

bool keep_attributes(const std::vector<std::string>& attributes, const std::vector<std::string>& names,
                     PointColumns& columns) {
  const auto is_named = [&](const std::string& name) {
    return std::find(attributes.begin(), attributes.end(), name) != attributes.end();
  };
  const auto is_other = [&](size_t k) { return is_named(column_name(names[k])); };
  const auto found = std::count_if(columns.others.begin(), columns.others.end(), is_other);
  if (static_cast<size_t>(found) + is_named("color") != attributes.size()) return false;
  std::erase_if(columns.others, [&](size_t k) { return !is_other(k); });
  if (!is_named("color")) columns.color = columns.splat_color = {};
  return true;
}

void warn_of_color_parts(const PointColumns& columns, const std::string& path, std::vector<std::string>& warnings) {
  if (!columns.color_parts.empty())
    warnings.push_back(path + ": " + columns.color_parts +
                       " without the other channels of a color: kept as attributes, no colors");
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
  std::string word;
  const bool is_latin1 = !is_utf8_text(name);  // of older programs
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (is_latin1 && byte >= 0xA0) {
      word += static_cast<char>(0xC0 | byte >> 6);
      word += static_cast<char>(0x80 | (byte & 0x3F));
    } else {
      word += is_latin1 && byte >= 0x80 ? '_' : c;
    }
  }
  std::replace_if(
      word.begin(), word.end(), [](char c) { return (c <= ' ' && !is_beyond_ascii(c)) || c == 0x7f; }, '_');
  return word;
}

bool holds_labels(std::string_view name) {
  constexpr std::string_view labels[] = {
      "label",  "classification", "class",       "category",    "instance", "segment", "scanid", "pointsourceid",
      "object", "returnnumber",   "returnindex", "returncount", "ring",     "id",      "index",  "scannerchannel"};
  return is_one_of(bare(name), labels);
}

}  // namespace soapfilm::io
