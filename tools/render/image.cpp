#include "tools/render/image.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cmath>

#include "soapfilm/error.h"
#include "soapfilm/io/bytes/atomic_file.h"

namespace soapfilm {

void Image::blend(int x, int y, Rgb8 color, double coverage) {
  if (x < 0 || y < 0 || x >= width || y >= height || coverage <= 0) return;
  Rgba8& pixel = at(x, y);
  const double below = pixel[3] / 255.0 * (1 - coverage);
  const double alpha = coverage + below;
  for (int k = 0; k < 3; ++k) {
    pixel[k] = static_cast<uint8_t>(std::lround((color[k] * coverage + pixel[k] * below) / alpha));
  }
  pixel[3] = static_cast<uint8_t>(std::lround(255 * alpha));
}

void write_png(const std::string& path, const Image& image) {
  if (image.pixels.empty()) throw ParameterError(fmt::format("{}: the image has 0 pixels, needs at least 1", path));
  const bool opaque = std::all_of(image.pixels.begin(), image.pixels.end(), [](const Rgba8& p) { return p[3] == 255; });
  std::vector<uint8_t> rows;
  const int channels = opaque ? 3 : 4;
  rows.reserve(image.pixels.size() * static_cast<size_t>(channels));
  for (const Rgba8& p : image.pixels) rows.insert(rows.end(), p.begin(), p.begin() + channels);

  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = opaque ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
  std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(png), '\0');
  png_alloc_size_t size = bytes.size();
  if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, rows.data(), 0, nullptr)) {
    throw OutputError(fmt::format("{}: libpng refuses the image: {}", path, png.message));
  }
  bytes.resize(size);
  io::AtomicFile file(path);
  file.append(bytes);
  file.commit();
}

}  // namespace soapfilm
