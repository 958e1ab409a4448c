// A page that shows meshes and samples in any browser: one file that asks no server for anything (viewer/).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

/// The mesh or cloud must outlive the call.
struct ViewItem {
  std::variant<const Mesh*, const PointCloud*> shape;
  std::string name;
  std::string report;  ///< JSON text of report.json, shown beside the picture; empty: none
};

enum class UpAxis { y, z };

struct ViewParams {
  std::string title;  ///< empty: the items' names
  std::string unit;   ///< of lengths, such as "m"; only shown
  UpAxis up = UpAxis::y;
  size_t triangles = 1000000;  ///< of each mesh at most about so many, larger ones are simplified; 0: all
  size_t samples = 1000000;    ///< of each cloud at most so many, chosen evenly at random; 0: all
};

/// Whether this build has the viewer (CMake option SOAPFILM_VIEWER: needs node and npm).
bool has_viewer();

/// The page as HTML. Coordinates are float around an origin in double, so that georeferenced ones lose nothing that is
/// seen. Two items stand side by side at first. What was simplified or thinned is told to the context and in the page.
/// The same items give the same bytes.
///
/// Throws ParameterError when there is no item, an item is empty, inconsistent or has a coordinate that is not finite,
/// a report is not a JSON object, or the page would be larger than browsers can read; OutputError if this build has no
/// viewer.
std::string viewer_page(const std::vector<ViewItem>& items, const ViewParams& params, const Context& context);

namespace view_detail {
/// viewer_page() with another page to fill, for tests.
std::string page_of(std::string_view page, const std::vector<ViewItem>& items, const ViewParams& params,
                    const Context& context);
}  // namespace view_detail

}  // namespace soapfilm
