#include "tools/render/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "soapfilm/core/parallel.h"
#include "soapfilm/error.h"
#include "tools/render/colormap.h"
#include "tools/render/font.h"
#include "tools/render/light.h"
#include "tools/render/scene.h"

namespace soapfilm {

namespace {

using namespace render_detail;

constexpr double margin = 0.04;  // of the panel, around the largest item
constexpr int most_pixels_along_a_side = 16384;
constexpr size_t rows_per_task = 4;
constexpr Rgb8 dark_ink{40, 40, 44};
constexpr Rgb8 light_ink{225, 225, 228};
using Range = std::pair<double, double>;

const std::vector<Vec3d>& positions_of(const RenderItem& item) {
  if (const auto* mesh = std::get_if<const Mesh*>(&item.shape)) return (*mesh)->vertices;
  return std::get<const PointCloud*>(item.shape)->positions;
}

const Column* attribute_of(const RenderItem& item, const std::string& name) {
  const auto* mesh = std::get_if<const Mesh*>(&item.shape);
  if (!mesh) return nullptr;
  for (const Column& a : (*mesh)->attributes) {
    if (a.name == name) return &a;
  }
  return nullptr;
}

void check_between(const char* name, int value, int low, int high) {
  if (value < low || value > high) {
    throw ParameterError(fmt::format("{} = {}, must be in {} .. {}", name, value, low, high));
  }
}

void check_params(const RenderParams& p) {
  check_between("width", p.width, 16, most_pixels_along_a_side);
  check_between("height", p.height, 16, most_pixels_along_a_side);
  check_between("columns", p.columns, 0, 1000);
  check_between("samples", p.samples, 1, 16);
  check_between("occlusion_rays", p.occlusion_rays, 0, 255);
  if (!(p.point_radius >= 0) || !std::isfinite(p.point_radius)) {
    throw ParameterError(fmt::format("point_radius = {:g}, must be >= 0", p.point_radius));
  }
  const ZoomBox& z = p.zoom;
  if (!(z.x0 < z.x1 && z.y0 < z.y1) || !std::isfinite(z.x1 - z.x0) || !std::isfinite(z.y1 - z.y0)) {
    throw ParameterError(
        fmt::format("zoom = {:g},{:g},{:g},{:g}, must have x0 < x1 and y0 < y1", z.x0, z.y0, z.x1, z.y1));
  }
  if (p.range && !(p.range->first < p.range->second && std::isfinite(p.range->second - p.range->first))) {
    throw ParameterError(
        fmt::format("range = {:g},{:g}, must be two numbers that increase", p.range->first, p.range->second));
  }
}

void check_item(const RenderItem& item, size_t number) {
  const auto& positions = positions_of(item);
  if (positions.empty()) throw ParameterError(fmt::format("item {} has 0 points, must have at least 1", number));
  for (size_t i = 0; i < positions.size(); ++i) {
    if (!is_finite(positions[i])) {
      const Vec3d& p = positions[i];
      throw ParameterError(fmt::format("item {}, vertex {} is ({}, {}, {}), must be finite", number, i, p.x, p.y, p.z));
    }
  }
  const auto* mesh = std::get_if<const Mesh*>(&item.shape);
  if (!mesh) return;
  if ((*mesh)->triangles.empty()) throw ParameterError(fmt::format("item {} has 0 triangles, must have 1", number));
  for (const Triangle& t : (*mesh)->triangles) {
    const uint32_t highest = std::max({t[0], t[1], t[2]});
    if (highest >= positions.size()) {
      throw ParameterError(
          fmt::format("item {} has a triangle with vertex {}, must be < {}", number, highest, positions.size()));
    }
  }
}

/// The values at the ends of the color map; those of the items unless given.
Range map_range(const std::vector<RenderItem>& items, const RenderParams& params) {
  if (params.color_by.empty()) return {0, 1};
  Range found{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  bool present = false;
  for (const RenderItem& item : items) {
    const Column* attribute = attribute_of(item, params.color_by);
    if (!attribute) continue;
    present = true;
    for (const float value : attribute->values) {
      if (!std::isfinite(value)) continue;
      found = {std::min<double>(found.first, value), std::max<double>(found.second, value)};
    }
  }
  if (!present)
    throw ParameterError(fmt::format("color_by = {}, no item has a vertex attribute of that name", params.color_by));
  if (params.range) return *params.range;
  if (found.first > found.second) return {0, 1};
  if (found.first == found.second) return {found.first, std::nextafter(static_cast<float>(found.first), 1e38f)};
  return found;
}

/// The layout of a picture, in pixels.
struct Layout {
  int columns = 1;
  int rows = 1;
  int caption_height = 0;
  int legend_height = 0;
  double text_height = 0;  // of a capital

  Layout(const std::vector<RenderItem>& items, const RenderParams& params) {
    const auto count = static_cast<int>(items.size());
    const int square = static_cast<int>(std::ceil(std::sqrt(count)));
    columns = params.columns > 0 ? std::min(params.columns, count) : count <= 4 ? count : square;
    rows = (count + columns - 1) / columns;
    text_height = std::max(8.0, 0.021 * std::min(params.width, params.height));
    const auto strip = static_cast<int>(std::lround(2.6 * text_height));
    const bool captions =
        std::any_of(items.begin(), items.end(), [](const auto& item) { return !item.caption.empty(); });
    if (captions) caption_height = strip;
    if (!params.color_by.empty()) legend_height = 2 * strip;
  }

  int width(const RenderParams& params) const { return columns * params.width; }
  int height(const RenderParams& params) const { return rows * (params.height + caption_height) + legend_height; }
};

/// The window of the picture plane that an item's panel shows before zooming.
class Framer {
 public:
  Framer(const std::vector<RenderItem>& items, const RenderParams& params, const ViewFrame& frame)
      : aspect_(static_cast<double>(params.width) / params.height) {
    for (const RenderItem& item : items) extents_.push_back(extent_of(positions_of(item), frame));
    if (params.framing == Framing::shared) {
      ViewExtent all = extents_.front();
      for (const ViewExtent& e : extents_) {
        all = {std::min(all.lo_x, e.lo_x), std::max(all.hi_x, e.hi_x), std::min(all.lo_y, e.lo_y),
               std::max(all.hi_y, e.hi_y)};
      }
      std::fill(extents_.begin(), extents_.end(), all);
    }
    for (const ViewExtent& e : extents_) half_heights_.push_back(half_height_for(e));
    if (params.framing != Framing::fitted) {
      std::fill(half_heights_.begin(), half_heights_.end(),
                *std::max_element(half_heights_.begin(), half_heights_.end()));
    }
  }

  ViewWindow window(size_t item) const {
    const ViewExtent& e = extents_[item];
    return {(e.lo_x + e.hi_x) / 2, (e.lo_y + e.hi_y) / 2, half_heights_[item]};
  }
  double aspect() const { return aspect_; }

 private:
  double half_height_for(const ViewExtent& e) const {
    const double needed = std::max((e.hi_y - e.lo_y) / 2, (e.hi_x - e.lo_x) / 2 / aspect_);
    return needed > 0 ? needed / (1 - 2 * margin) : 1;
  }

  double aspect_;
  std::vector<ViewExtent> extents_;
  std::vector<double> half_heights_;
};

/// One panel's pixels, its upper left corner at (left, top) of the image.
class Panel {
 public:
  Panel(const RenderItem& item, const RenderParams& params, const ViewFrame& frame, const ViewWindow& window,
        double aspect, Range range, const Context& context)
      : params_(params), scene_(make_scene(item, params, frame, window, aspect, range, context)) {}

  void draw(Image& image, int left, int top, const Context& context) const {
    parallel_for(context, static_cast<size_t>(params_.height), rows_per_task, [&](size_t row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < params_.width; ++x) image.at(left + x, top + y) = pixel(x, y);
    });
  }

 private:
  /// Scene units: the item's bounding ball around the center of the window becomes the unit ball.
  Scene make_scene(const RenderItem& item, const RenderParams& params, const ViewFrame& frame, const ViewWindow& window,
                   double aspect, Range range, const Context& context) {
    Box3d box;
    for (const Vec3d& p : positions_of(item)) box.extend(p);
    const ViewWindow shown = zoomed(window, params.zoom, aspect);
    const Vec3d center =
        frame.right * shown.x + frame.up * shown.y + frame.towards_viewer * dot(box.center(), frame.towards_viewer);
    double radius = 0;
    for (const Vec3d& p : positions_of(item)) radius = std::max(radius, norm(p - center));
    const double scale = radius > 0 ? 1 / radius : 1;
    pixel_size_ = 2 * shown.half_height / params.height * scale;
    return Scene(item, params, frame, center, scale, range, context);
  }

  Rgba8 pixel(int x, int y) const {
    const PixelPattern pattern(x, y);
    const int n = params_.samples;
    Vec3f sum{};
    int hits = 0;
    for (int s = 0; s < n * n; ++s) {
      const double px = x + (s % n + 0.5) / n - 0.5 * params_.width;
      const double py = y + (s / n + 0.5) / n - 0.5 * params_.height;
      const auto point = scene_.look_at(static_cast<float>(px * pixel_size_), static_cast<float>(-py * pixel_size_));
      if (!point) continue;
      ++hits;
      sum += shade(scene_, *point, pattern, s, params_.occlusion_rays);
    }
    const float all = static_cast<float>(n * n);
    if (params_.background) {
      const Rgb8 c = to_srgb((sum + to_linear(*params_.background) * (all - static_cast<float>(hits))) / all);
      return {c[0], c[1], c[2], 255};
    }
    if (hits == 0) return {0, 0, 0, 0};
    const Rgb8 c = to_srgb(sum / static_cast<float>(hits));
    return {c[0], c[1], c[2], static_cast<uint8_t>(std::lround(255.0 * hits / all))};
  }

  const RenderParams& params_;
  double pixel_size_ = 1;  // scene units
  Scene scene_;
};

/// The color of text: readable on the background, dark on a transparent one.
Rgb8 ink_for(const RenderParams& params) {
  if (!params.background) return dark_ink;
  const Vec3f c = to_linear(*params.background);
  return 0.21f * c.x + 0.72f * c.y + 0.07f * c.z < 0.2f ? light_ink : dark_ink;
}

/// Text centered at x, made smaller when it would be wider than `room`.
void draw_centered(Image& image, const std::string& text, double x, double baseline, double height, double room,
                   Rgb8 ink) {
  const double width = text_width(text, height);
  const double fit = width > room ? height * room / width : height;
  draw_text(image, text, x - text_width(text, fit) / 2, baseline, fit, ink);
}

void draw_legend(Image& image, const RenderParams& params, const Layout& layout, Range range) {
  const Rgb8 ink = ink_for(params);
  const double text = layout.text_height;
  const int length = std::min(image.width * 6 / 10, 60 * static_cast<int>(text));
  const int left = (image.width - length) / 2;
  const int top = image.height - layout.legend_height + static_cast<int>(2.2 * text);
  const int bottom = top + static_cast<int>(text);
  draw_centered(image, params.color_by, image.width / 2.0, top - 0.5 * text, text, length, ink);
  for (int x = 0; x < length; ++x) {
    const Rgb8 c = map_color((x + 0.5) / length);
    for (int y = top; y < bottom; ++y) image.blend(left + x, y, c, 1);
  }
  for (int k = 0; k <= 2; ++k) {
    const double value = range.first + (range.second - range.first) * k / 2;
    draw_centered(image, fmt::format("{:.4g}", value), left + length * k / 2.0, bottom + 1.6 * text, text, length, ink);
  }
}

}  // namespace

Image render(const std::vector<RenderItem>& items, const RenderParams& params, const Context& context) {
  check_params(params);
  if (items.empty()) throw ParameterError("there are 0 items to render, must be at least 1");
  for (size_t i = 0; i < items.size(); ++i) check_item(items[i], i + 1);
  const ViewFrame frame = view_frame(params.from, params.up);
  const Range range = map_range(items, params);
  const Layout layout(items, params);
  check_between("the picture's width", layout.width(params), 1, most_pixels_along_a_side);
  check_between("the picture's height", layout.height(params), 1, most_pixels_along_a_side);

  const Rgb8 back = params.background.value_or(Rgb8{0, 0, 0});
  const auto alpha = static_cast<uint8_t>(params.background ? 255 : 0);
  Image image(layout.width(params), layout.height(params), {back[0], back[1], back[2], alpha});
  const Framer framer(items, params, frame);
  for (size_t i = 0; i < items.size(); ++i) {
    const int left = static_cast<int>(i) % layout.columns * params.width;
    const int top = static_cast<int>(i) / layout.columns * (params.height + layout.caption_height);
    Panel(items[i], params, frame, framer.window(i), framer.aspect(), range, context).draw(image, left, top, context);
    draw_centered(image, items[i].caption, left + params.width / 2.0, top + params.height + 1.6 * layout.text_height,
                  layout.text_height, 0.94 * params.width, ink_for(params));
  }
  if (layout.legend_height > 0) draw_legend(image, params, layout, range);
  return image;
}

}  // namespace soapfilm
