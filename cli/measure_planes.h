// Planes as they are typed: z=1.5, z=0:10:0.5, X,Y,Z,NX,NY,NZ.
#pragma once

#include <string>
#include <vector>

#include "tools/measure/plane.h"

namespace soapfilm::cli {

/// What the texts are to be, for messages.
inline constexpr const char* plane_form = "x=X, y=Y, z=Z or a point and a normal X,Y,Z,NX,NY,NZ";

/// Whether a text is meant as a plane, not as the name of a file.
bool looks_like_plane(const std::string& text);

/// Throws ParameterError that quotes the option.
Plane parse_plane(const char* option, const std::string& text);

/// One plane, or those of z=FROM:TO:STEP, both ends included; at most 10,000.
std::vector<Plane> parse_planes(const char* option, const std::string& text);

}  // namespace soapfilm::cli
