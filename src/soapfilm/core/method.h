// Properties of methods (docs/reference/methods.md compares them).
#pragma once

#include "soapfilm/params.h"

namespace soapfilm {

/// Whether the method has a dual, and so a bound of the optimum of (4).
inline bool is_certified(Method method) { return method == Method::tv || method == Method::tv_sor; }

/// Whether it is a minimum cut of a graph.
inline bool is_graph_cut(Method method) { return method == Method::graph_cut_6 || method == Method::graph_cut_26; }

/// Of a graph cut: how many neighbors a vertex is linked to.
inline int neighbors_of_cut(Method method) { return method == Method::graph_cut_6 ? 6 : 26; }

/// Whether places may have voxels of several sizes: the others work on the whole box.
inline bool adapts(Method method) { return method == Method::tv || is_graph_cut(method); }

/// Whether the surface depends on the weight of area, lambda. poisson's is linear in it, vrip has none.
inline bool uses_lambda(Method method) { return method != Method::poisson && method != Method::vrip; }

}  // namespace soapfilm
