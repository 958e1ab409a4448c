// How the area of the film is measured: the norm in TV(u) = sum over vertices of |grad u|.
#pragma once

namespace soapfilm {

/// isotropic:  |g| = sqrt(gx^2 + gy^2 + gz^2), area as it is; dual: |p| <= lambda, a ball.
/// anisotropic: |g| = |gx| + |gy| + |gz|, area seen along the axes; dual: |p_k| <= lambda, a cube. A film across the
///              grid costs up to sqrt(3) times one along it, so it steps; but the coarea formula holds exactly: the
///              thresholded optimum is an optimum, the one that graph-cut-6 finds.
enum class Norm { isotropic, anisotropic };

/// Mean over all directions of what the norm makes of a unit area: for a unit normal n, the mean of |nx| + |ny| + |nz|.
constexpr double mean_area(Norm norm) { return norm == Norm::isotropic ? 1.0 : 1.5; }

}  // namespace soapfilm
