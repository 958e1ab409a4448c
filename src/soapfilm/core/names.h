// Names of enumeration values in parameters, reports and options: the only place.
#pragma once

#include <array>
#include <cstddef>

#include "soapfilm/params.h"

namespace soapfilm {

/// In the order of the enumeration.
template <class Enum>
inline constexpr std::array<const char*, 0> names_of{};
template <>
inline constexpr std::array<const char*, 6> names_of<Method>{"tv",          "tv-sor",       "poisson",
                                                             "graph-cut-6", "graph-cut-26", "vrip"};
template <>
inline constexpr std::array<const char*, 5> names_of<DirectionSource>{"auto", "normals", "sensor", "scan", "estimate"};
template <>
inline constexpr std::array<const char*, 6> names_of<Axis>{"x", "y", "z", "-x", "-y", "-z"};
template <>
inline constexpr std::array<const char*, 4> names_of<Border>{"auto", "air", "solid", "open"};
template <>
inline constexpr std::array<const char*, 2> names_of<Norm>{"isotropic", "anisotropic"};
template <>
inline constexpr std::array<const char*, 3> names_of<FoldSource>{"auto", "samples", "scans"};
template <>
inline constexpr std::array<const char*, 2> names_of<SorOrder>{"lexicographic", "red-black"};
template <>
inline constexpr std::array<const char*, 2> names_of<SorGradient>{"central", "forward"};
template <>
inline constexpr std::array<const char*, 2> names_of<HoleFill>{"smooth", "flat"};
template <>
inline constexpr std::array<const char*, 2> names_of<LinkWeights>{"edge-length", "cauchy-crofton"};

template <class Enum>
const char* name_of(Enum value) requires(names_of<Enum>.size() > 0) {
  return names_of<Enum>[static_cast<size_t>(value)];
}

}  // namespace soapfilm
