// A small stroke font for captions: printable ASCII, drawn for this program.
#pragma once

#include <string_view>

#include "tools/render/image.h"

namespace soapfilm {

/// Width in pixels of a line of text whose capitals are `cap_height` pixels high.
double text_width(std::string_view text, double cap_height);

/// Draws a line of text; (x, baseline) is its lower left corner in pixels. Each character beyond ASCII (UTF-8) is drawn
/// as a question mark.
void draw_text(Image& image, std::string_view text, double x, double baseline, double cap_height, Rgb8 color);

}  // namespace soapfilm
