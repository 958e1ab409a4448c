// Images of 8 bits per channel, and writing them to a file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "soapfilm/cloud.h"

namespace soapfilm {

using Rgba8 = std::array<uint8_t, 4>;

/// Rows from top to bottom, sRGB, alpha not premultiplied.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<Rgba8> pixels;

  Image() = default;
  Image(int w, int h, Rgba8 fill) : width(w), height(h), pixels(static_cast<size_t>(w) * h, fill) {}

  Rgba8& at(int x, int y) { return pixels[static_cast<size_t>(y) * width + x]; }
  const Rgba8& at(int x, int y) const { return pixels[static_cast<size_t>(y) * width + x]; }

  /// Paints over one pixel: `coverage` in [0, 1] of the color, over what is there. Pixels off the image are ignored.
  void blend(int x, int y, Rgb8 color, double coverage);
};

/// Writes a PNG, whole or not at all: RGB when every pixel is opaque, otherwise RGBA.
/// Throws OutputError when the place is not writable, ParameterError for an empty image.
void write_png(const std::string& path, const Image& image);

}  // namespace soapfilm
