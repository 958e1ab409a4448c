#include "tools/render/font.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace soapfilm {

namespace {

// One string per character from ' ' to '~': its width, then its strokes, each after a space. '-' begins a polyline, '~'
// the control polygon of a smooth curve (quadratic B-spline through its end points). All numbers are in half units:
// widths and x as '0' + number, y as 'A' + 6 + number. Capitals are 10 units high, the base line is y = 0, up is
// positive.
constexpr std::string_view glyphs[] = {
    "6",
    "2 -0[0M -0G0G",
    "6 -0[0U -6[6U",
    "> -4[2G -<[:G -0U>U -0M>M",
    "< ~<W:Y6Y0Y0U0Q6Q<Q<M<I6I2I0K -6]6E",
    "@ -@[0G ~4[0[0W0S4S8S8W8[4[ ~<O8O8K8G<G@G@K@O<O",
    "@ ~@G4S2U2Y4[6[8[:Y:U6S0O0K0G6G<G>M>O",
    "2 -0[0U",
    "4 ~4_0Y0O0E4A",
    "4 ~0_4Y4O4E0A",
    "< -6[6O -0W<Q -<W0Q",
    "< -6W6K -0Q<Q",
    "2 -2I0C",
    ": -0O:O",
    "2 -0G0G",
    ": -:]0E",
    "< ~6[0[0Q0G6G<G<Q<[6[",
    "8 -0W6[6G",
    "< ~0U0[6[<[<U<Q6M0G -0G<G",
    "< ~0Y2[6[<[<W<Q4Q ~4Q<Q<M<G6G2G0K",
    "< -:G:[0M<M",
    "< -<[2[2Q ~2Q4S6S<S<M<G6G2G0I",
    "< ~:[0U0M0G6G<G<M<S6S2S0M",
    "< -0[<[4G",
    "< ~6[0[0W0S6Q<O<K<G6G0G0K0O6Q<S<W<[6[",
    "< ~2G<M<U<[6[0[0U0O6O:O<U",
    "2 -0S0S -0I0I",
    "2 -2S2S -2I0C",
    "< -<W0Q<K",
    "< -0S<S -0M<M",
    "< -0W<Q0K",
    ": ~0W0[4[:[:W:S4Q4M -4G4G",
    "B ~<O<S8S6S6O6K8K<K<O ~<S<K>KBKBQB[:[0[0O0C:C<C>E",
    "> -0G6[8[>G -2M<M",
    "< -0Q0[6[ ~6[<[<W<Q6Q -0Q6Q ~6Q<Q<M<G6G -6G0G0Q",
    "> ~>W<[8[0[0Q0G8G<G>K",
    "> -6G0G0[6[ ~6[>[>Q>G6G",
    "< -<[0[0G<G -0Q:Q",
    "< -<[0[0G -0Q:Q",
    "> ~>W<[8[0[0Q0G8G>G>M>Q ->Q8Q",
    "> -0G0[ ->G>[ -0Q>Q",
    "2 -0G0[",
    "8 -8[8M ~8M8G4G0G0K",
    "< -0G0[ -<[0O -4S<G",
    ": -0[0G:G",
    "@ -0G0[8M@[@G",
    "> -0G0[>G>[",
    "@ ~8[0[0Q0G8G@G@Q@[8[",
    "< -0G0[6[ ~6[<[<U<O6O -6O0O",
    "@ ~8[0[0Q0G8G@G@Q@[8[ -:M@E",
    "< -0G0[6[ ~6[<[<U<Q6Q -6Q0Q -6Q<G",
    "< ~<W:[6[0[0W0Q6Q<Q<K<G6G2G0K",
    "> -0[>[ -7[7G",
    "> -0[0O ~0O0G7G>G>O ->O>[",
    "> -0[6G8G>[",
    "B -0[4G9W>GB[",
    "< -0[<G -<[0G",
    "> -0[7Q>[ -7Q7G",
    "< -0[<[0G<G",
    "4 -4_0_0A4A",
    ": -0]:E",
    "4 -0_4_4A0A",
    ": -0U5[:U",
    "< -0C<C",
    "4 -0[4W",
    ": ~0S2U6U:U:O -:O:G ~:O4O0O0K0G4G8G:K",
    "; -0[0G ~0O0U6U;U;N;G6G0G0M",
    ": ~:R8U6U0U0N0G6G8G:J",
    "; -;[;G ~;O;U5U0U0N0G5G;G;M",
    "; -0N;N ~;N;U6U0U0N0G6G9G;J",
    "7 ~8[4[3[3W -3W3G -0T7T",
    "; -;U;G ~;G;A6A2A1C ~;O;U5U0U0N0G5G;G;M",
    ": -0[0G ~0O0U6U:U:O -:O:G",
    "2 -0U0G -0[0[",
    "4 -4U4E ~4E4A0A -4[4[",
    ": -0[0G -:U0L -4O:G",
    "3 -0[0K ~0K0G3G",
    "@ -0U0G ~0O0U4U8U8O -8O8G ~8O8U<U@U@O -@O@G",
    ": -0U0G ~0O0U6U:U:O -:O:G",
    "< ~6U0U0N0G6G<G<N<U6U",
    "; -0U0A ~0O0U6U;U;N;G6G0G0M",
    "; -;U;A ~;O;U5U0U0N0G5G;G;M",
    "6 -0U0G ~0N1U7U",
    "9 ~9S7U4U0U0R0N5N9N9K9G5G2G0I",
    "7 -3Y3K ~3K3G5G7G -0T7T",
    ": -0U0M ~0M0G4G:G:M -:U:G",
    "; -0U6G;U",
    "@ -0U4G8S<G@U",
    ": -0U:G -:U0G",
    "; -0U6H -;U3A1A",
    ": -0U:U0G:G",
    "6 ~6_2_3Y3Q0P ~0P3O3G2A6A",
    "2 -0_0A",
    "6 ~0_4_3Y3Q6P ~6P3O3G4A0A",
    "< ~0O2S5S7O:O<S",
};

constexpr double units_per_cap = 10;
constexpr double gap = 2.6;            // between characters, units
constexpr double stroke_share = 0.13;  // width of the pen, of the height of a capital

struct Point {
  double x, y;
};
using Stroke = std::vector<Point>;

std::string_view glyph_of(char c) {
  const bool printable = c >= ' ' && c <= '~';
  return glyphs[(printable ? c : '?') - ' '];
}

double width_of(std::string_view glyph) { return (glyph[0] - '0') / 2.0; }

/// Chaikin's corner cutting, ends kept: tends to the quadratic B-spline of the control polygon.
Stroke smoothed(Stroke stroke) {
  for (int round = 0; round < 4; ++round) {
    Stroke cut{stroke.front()};
    for (size_t i = 0; i + 1 < stroke.size(); ++i) {
      const Point a = stroke[i];
      const Point b = stroke[i + 1];
      if (i > 0) cut.push_back({0.75 * a.x + 0.25 * b.x, 0.75 * a.y + 0.25 * b.y});
      if (i + 2 < stroke.size()) cut.push_back({0.25 * a.x + 0.75 * b.x, 0.25 * a.y + 0.75 * b.y});
    }
    cut.push_back(stroke.back());
    stroke = std::move(cut);
  }
  return stroke;
}

/// The strokes of a glyph in units.
std::vector<Stroke> strokes_of(std::string_view glyph) {
  std::vector<Stroke> strokes;
  for (size_t i = 1; i < glyph.size();) {
    const bool smooth = glyph[i + 1] == '~';
    Stroke stroke;
    for (i += 2; i < glyph.size() && glyph[i] != ' '; i += 2) {
      stroke.push_back({(glyph[i] - '0') / 2.0, (glyph[i + 1] - 'A' - 6) / 2.0});
    }
    strokes.push_back(smooth ? smoothed(stroke) : stroke);
  }
  return strokes;
}

double distance_to_segment(Point p, Point a, Point b) {
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const double length2 = dx * dx + dy * dy;
  const double t = length2 > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / length2, 0.0, 1.0) : 0.0;
  return std::hypot(p.x - a.x - t * dx, p.y - a.y - t * dy);
}

/// Paints the pixels within half a pen's width of any of the strokes, given in pixels.
void paint(Image& image, const std::vector<Stroke>& strokes, double pen, Rgb8 color) {
  Point lo{1e9, 1e9};
  Point hi{-1e9, -1e9};
  for (const Stroke& stroke : strokes) {
    for (const Point& p : stroke) {
      lo = {std::min(lo.x, p.x), std::min(lo.y, p.y)};
      hi = {std::max(hi.x, p.x), std::max(hi.y, p.y)};
    }
  }
  const double reach = pen / 2 + 1;
  for (int y = static_cast<int>(std::floor(lo.y - reach)); y <= hi.y + reach; ++y) {
    for (int x = static_cast<int>(std::floor(lo.x - reach)); x <= hi.x + reach; ++x) {
      double nearest = reach;
      for (const Stroke& stroke : strokes) {
        for (size_t i = 0; i + 1 < stroke.size(); ++i) {
          nearest = std::min(nearest, distance_to_segment({x + 0.5, y + 0.5}, stroke[i], stroke[i + 1]));
        }
      }
      image.blend(x, y, color, std::clamp(pen / 2 + 0.5 - nearest, 0.0, 1.0));
    }
  }
}

bool continues_character(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

}  // namespace

double text_width(std::string_view text, double cap_height) {
  double units = 0;
  for (const char c : text) {
    if (!continues_character(c)) units += width_of(glyph_of(c)) + gap;
  }
  return std::max(0.0, units - gap) * cap_height / units_per_cap;
}

void draw_text(Image& image, std::string_view text, double x, double baseline, double cap_height, Rgb8 color) {
  const double unit = cap_height / units_per_cap;
  const double pen = std::max(1.0, stroke_share * cap_height);
  for (const char c : text) {
    if (continues_character(c)) continue;
    const std::string_view glyph = glyph_of(c);
    auto strokes = strokes_of(glyph);
    for (Stroke& stroke : strokes) {
      for (Point& p : stroke) p = {x + p.x * unit, baseline - p.y * unit};
    }
    paint(image, strokes, pen, color);
    x += (width_of(glyph) + gap) * unit;
  }
}

}  // namespace soapfilm
