// Contours as drawings: SVG, DXF, CSV.
#pragma once

#include <string>
#include <vector>

#include "tools/measure/section.h"

namespace soapfilm {

/// Extensions that write_sections() knows, each with its dot.
std::vector<std::string> section_extensions();

/// Throws ParameterError for another extension.
void check_section_output(const std::string& path);

/// SVG: in the axes of the first plane (axes_of()), relative to the lower left corner, which the file's description
/// names. DXF (R12): 3D polylines, a layer for each section. CSV: a line for each point,
/// "section,contour,closed,x,y,z". DXF and CSV have the coordinates of the mesh to their last digit. Written whole or
/// not at all. Throws ParameterError for another extension, OutputError.
void write_sections(const std::string& path, const std::vector<Section>& sections);

}  // namespace soapfilm
