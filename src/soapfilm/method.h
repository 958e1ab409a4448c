// The methods of reconstruction: ours, the paper's numerics, and the paper's rivals. docs/methods.md compares them.
#pragma once

#include <array>
#include <cstddef>

namespace soapfilm {

enum class Method {
  tv,            ///< total variation (4), primal-dual, coarse to fine on a band, certified
  tv_sor,        ///< the same energy by the paper's numerics, section 4.2
  poisson,       ///< the quadratic regulariser (6)
  graph_cut_6,   ///< the discrete optimum, 6 neighbours (Lempitsky and Boykov 2007)
  graph_cut_26,  ///< the same with 26 neighbours
  vrip,          ///< weighted signed distance of range scans (Curless and Levoy 1996)
};

/// As --method and report.json call them, in the order of the enumeration.
inline constexpr std::array<const char*, 6> method_names = {"tv",          "tv-sor",       "poisson",
                                                            "graph-cut-6", "graph-cut-26", "vrip"};

inline const char* name_of(Method method) { return method_names[static_cast<size_t>(method)]; }

/// Does the method have a dual, and so a bound of the optimum of (4)?
inline bool is_certified(Method method) { return method == Method::tv || method == Method::tv_sor; }

/// Does the surface depend on the weight of area, lambda? poisson's is linear in it, vrip knows none.
inline bool weighs_area(Method method) { return method != Method::poisson && method != Method::vrip; }

}  // namespace soapfilm
