#include "tools/measure/section_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>

#include "soapfilm/error.h"
#include "soapfilm/io/files.h"

namespace soapfilm {

namespace {

using Text = fmt::memory_buffer;

template <class... Values>
void add(Text& text, fmt::format_string<Values...> form, Values&&... values) {
  fmt::format_to(std::back_inserter(text), form, std::forward<Values>(values)...);
}

std::string csv(const std::vector<Section>& sections) {
  Text text;
  add(text, "section,contour,closed,x,y,z\n");
  for (size_t s = 0; s < sections.size(); ++s)
    for (size_t c = 0; c < sections[s].contours.size(); ++c)
      for (const Vec3d& p : sections[s].contours[c].points)
        add(text, "{},{},{},{},{},{}\n", s + 1, c + 1, sections[s].contours[c].closed ? 1 : 0, p.x, p.y, p.z);
  return fmt::to_string(text);
}

/// Pairs of a code and a value, each on a line of its own.
std::string dxf(const std::vector<Section>& sections) {
  Text text;
  add(text, "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n");
  for (size_t s = 0; s < sections.size(); ++s) {
    const std::string layer = fmt::format("SECTION_{}", s + 1);
    for (const Contour& contour : sections[s].contours) {
      constexpr int is_closed = 1, is_3d = 8, vertex_of_3d = 32;
      add(text, "0\nPOLYLINE\n8\n{}\n66\n1\n10\n0\n20\n0\n30\n0\n70\n{}\n", layer,
          is_3d + (contour.closed ? is_closed : 0));
      for (const Vec3d& p : contour.points)
        add(text, "0\nVERTEX\n8\n{}\n10\n{}\n20\n{}\n30\n{}\n70\n{}\n", layer, p.x, p.y, p.z, vertex_of_3d);
      add(text, "0\nSEQEND\n8\n{}\n", layer);
    }
  }
  add(text, "0\nENDSEC\n0\nEOF\n");
  return fmt::to_string(text);
}

std::string svg(const std::vector<Section>& sections) {
  const Plane frame = sections.empty() ? Plane{} : sections[0].plane;
  const PlaneAxes axes = axes_of(frame);
  Box3d box;
  const auto place = [&](Vec3d p) { return Vec3d{dot(p, axes.right), dot(p, axes.up), 0}; };
  for (const Section& section : sections)
    for (const Contour& contour : section.contours)
      for (const Vec3d& p : contour.points) box.extend(place(p));
  if (box.empty()) box.extend(Vec3d{});
  const double longest = box.longest() > 0 ? box.longest() : 1.0;
  const double margin = 0.02 * longest, width = box.size().x + 2 * margin, height = box.size().y + 2 * margin;
  constexpr double pixels = 1000;
  Text text;
  add(text, "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.0f}\" height=\"{:.0f}\" viewBox=\"{} {} {} {}\">\n",
      pixels * width / std::max(width, height), pixels * height / std::max(width, height), -margin, -margin, width,
      height);
  add(text, "<desc>Sections of a mesh by soapfilm measure. x = {} + x of the drawing, y = {} - y of it</desc>\n",
      box.lo.x, box.hi.y);
  for (size_t s = 0; s < sections.size(); ++s) {
    add(text,
        "<g id=\"section-{}\" fill=\"#9ab\" fill-opacity=\"{}\" fill-rule=\"evenodd\" stroke=\"#123\" "
        "stroke-width=\"{}\">\n<path d=\"",
        s + 1, sections.size() == 1 && sections[s].closed() ? 0.5 : 0.0, 0.002 * longest);
    for (const Contour& contour : sections[s].contours) {
      for (size_t i = 0; i < contour.points.size(); ++i) {
        const Vec3d p = place(contour.points[i]);
        add(text, "{}{:.6g} {:.6g}", i == 0 ? "M" : " L", p.x - box.lo.x, box.hi.y - p.y);
      }
      if (contour.closed) add(text, "Z");
    }
    add(text, "\"/>\n</g>\n");
  }
  add(text, "</svg>\n");
  return fmt::to_string(text);
}

}  // namespace

std::vector<std::string> section_extensions() { return {".svg", ".dxf", ".csv"}; }

void check_section_output(const std::string& path) {
  const std::vector<std::string> known = section_extensions();
  if (std::find(known.begin(), known.end(), std::filesystem::path(path).extension()) == known.end())
    throw ParameterError(fmt::format("contours = {}, must end in {}", path, fmt::join(known, ", ")));
}

void write_sections(const std::string& path, const std::vector<Section>& sections) {
  check_section_output(path);
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".svg") return write_text_file(path, svg(sections));
  if (extension == ".dxf") return write_text_file(path, dxf(sections));
  write_text_file(path, csv(sections));
}

}  // namespace soapfilm
