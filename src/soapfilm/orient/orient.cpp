#include "soapfilm/orient/orient.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/gather.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/core/names.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/error.h"
#include "soapfilm/orient/estimate_normals.h"
#include "soapfilm/orient/far_planes.h"
#include "soapfilm/orient/local_surface.h"

namespace soapfilm {

namespace {

constexpr size_t samples_at_once = size_t{1} << 14;

/// Scans are searched by sample, so they must be in order.
void check(const PointCloud& cloud) {
  size_t end = 0;
  for (size_t k = 0; k < cloud.scans.size(); ++k) {
    const Scan& scan = cloud.scans[k];
    if (scan.begin < end || scan.end < scan.begin || scan.end > cloud.size())
      throw SamplesError(fmt::format("scan {}: samples {} to {}, must be in order from {} to {}", k, scan.begin,
                                     scan.end, end, cloud.size()));
    end = scan.end;
  }
}

/// Of so few samples that no planes are measured: the share of pairs of near neighbors that lie beside each other, not
/// above each other as the sides of a sheet do, and look to opposite sides. 0 for more samples.
double opposed_neighbors(const PointCloud& cloud, const std::vector<Vec3f>& directions) {
  constexpr size_t few = 400;  // sides.cpp judges more than 200 whose planes it knows
  constexpr size_t neighbors = 8;
  constexpr float opposed = -0.3f;  // cosine
  constexpr double beside = 0.5;    // of the distance, along the normal
  if (cloud.size() > few || cloud.size() <= neighbors) return 0;
  size_t pairs = 0, opposite = 0;
  std::vector<std::pair<double, size_t>> near(cloud.size());
  for (size_t i = 0; i < cloud.size(); ++i) {
    for (size_t k = 0; k < cloud.size(); ++k)
      near[k] = {dot(cloud.positions[k] - cloud.positions[i], cloud.positions[k] - cloud.positions[i]), k};
    std::nth_element(near.begin(), near.begin() + neighbors, near.end());
    for (size_t n = 0; n <= neighbors; ++n) {
      const auto [squared, k] = near[n];
      const Vec3d step = cloud.positions[k] - cloud.positions[i];
      const double height = std::abs(dot(step, static_cast<Vec3d>(directions[i])));
      if (k == i || !(height * height <= beside * beside * squared)) continue;
      ++pairs;
      opposite += dot(directions[i], directions[k]) < opposed;
    }
  }
  return pairs > 0 ? static_cast<double>(opposite) / static_cast<double>(pairs) : 0;
}

/// Zero when `v` is zero or not finite.
Vec3f unit_or_zero(Vec3d v) { return is_finite(v) ? static_cast<Vec3f>(normalized(v)) : Vec3f{}; }

Vec3d mean_position(const PointCloud& cloud, const Scan& scan) {
  const Vec3d first = cloud.positions[scan.begin];
  Vec3d sum;
  for (size_t i = scan.begin; i < scan.end; ++i) sum += cloud.positions[i] - first;
  return first + sum / static_cast<double>(scan.size());
}

/// The properties of a whole scan.
struct ScanFacts {
  std::optional<Vec3d> sensor;
  Vec3f view_direction;  ///< zero when unknown
};

/// The directions contained in the cloud, source by source.
class KnownDirections {
 public:
  KnownDirections(const PointCloud& cloud, const OrientSetup& params, const Context& context)
      : cloud_(cloud), facts_(cloud.scans.size()), elsewhere_{params.sensor, {}} {
    parallel_for(context, facts_.size(), 1, [&](size_t k) {
      const Scan& scan = cloud.scans[k];
      ScanFacts& facts = facts_[k];
      facts.sensor = scan.sensor ? scan.sensor : params.sensor;
      if (scan.view_direction)
        facts.view_direction = unit_or_zero(*scan.view_direction);
      else if (facts.sensor && scan.size() > 0)
        facts.view_direction = unit_or_zero(*facts.sensor - mean_position(cloud, scan));
    });
  }

  /// Calls visit(i, facts) for samples [begin, end) with the properties of their scans.
  template <class Visit>
  void for_each(size_t begin, size_t end, Visit&& visit) const {
    const std::vector<Scan>& scans = cloud_.scans;
    auto scan = std::upper_bound(scans.begin(), scans.end(), begin, [](size_t i, const Scan& s) { return i < s.end; });
    for (size_t i = begin; i < end;) {
      while (scan != scans.end() && scan->end <= i) ++scan;
      const bool in_scan = scan != scans.end() && scan->begin <= i;
      const ScanFacts& facts = in_scan ? facts_[static_cast<size_t>(scan - scans.begin())] : elsewhere_;
      const size_t last = scan == scans.end() ? end : std::min(end, in_scan ? scan->end : scan->begin);
      for (; i < last; ++i) visit(i, facts);
    }
  }

  /// Zero where the source has none; not for `automatic` or `estimate`.
  Vec3f direction(DirectionSource source, size_t i, const ScanFacts& facts) const {
    switch (source) {
      case DirectionSource::normals:
        return cloud_.normals.empty() ? Vec3f{} : unit_or_zero(static_cast<Vec3d>(cloud_.normals[i]));
      case DirectionSource::sensor:
        if (!cloud_.sensors.empty() && is_finite(cloud_.sensors[i]))
          return unit_or_zero(cloud_.sensors[i] - cloud_.positions[i]);
        return facts.sensor ? unit_or_zero(*facts.sensor - cloud_.positions[i]) : Vec3f{};
      case DirectionSource::scan:
        return facts.view_direction;
      case DirectionSource::automatic:
      case DirectionSource::estimate:
        break;
    }
    return {};
  }

 private:
  const PointCloud& cloud_;
  std::vector<ScanFacts> facts_;
  ScanFacts elsewhere_;  ///< of samples that belong to no scan
};

constexpr std::array<DirectionSource, 3> known_sources{DirectionSource::normals, DirectionSource::sensor,
                                                       DirectionSource::scan};

void refuse_absent_source(DirectionSource source, const OrientReport& report) {
  const auto require = [&](DirectionSource asked, size_t found, const char* complaint) {
    if (source == asked && found == 0) throw ParameterError(fmt::format("directions = {}", complaint));
  };
  require(DirectionSource::normals, report.from_normals, "normals: no sample has a normal");
  require(DirectionSource::sensor, report.from_sensor,
          "sensor: no sample or scan has a scanner position, give one with --sensor");
  require(DirectionSource::scan, report.from_scan, "scan: no scan has a viewing direction or a scanner position");
}

void warn(const Context& context, OrientReport& report, std::string line) {
  context.progress().warn(line);
  report.warnings.push_back(std::move(line));
}

Vec3f towards_scanner(const KnownDirections& known, size_t i, const ScanFacts& facts) {
  const Vec3f direction = known.direction(DirectionSource::sensor, i, facts);
  return direction == Vec3f{} ? known.direction(DirectionSource::scan, i, facts) : direction;
}

Vec3d axis(Axis axis) {
  const auto code = static_cast<int>(axis);
  Vec3d unit;
  unit[code % 3] = code < 3 ? 1 : -1;
  return unit;
}

/// What is near in space is near on disk, but some places are in use at once.
void warn_of_slow_disk(const PointCloud& cloud, const Context& context, OrientReport& report) {
  constexpr uint64_t each = 15;  // bytes a sample: measured; with fewer much may be read all over again
  const uint64_t wanted = each * cloud.size(), room = context.memory_limit().value_or(available_memory_bytes());
  if (context.state().scratch_folder.empty() || wanted <= room) return;
  warn(
      context, report,
      fmt::format("{} samples without normals: finding them on disk is very slow with less than about {} of memory, {} "
                  "are there: give normals or scanner positions (--sensor), fewer samples, or more memory",
                  cloud.size(), format_bytes(wanted), format_bytes(room)));
}

/// Fills directions that are zero. `given`: normals whose signs are in doubt, or none.
EstimatedNormals estimate_open(const PointCloud& cloud, const OrientSetup& params, const KnownDirections& known,
                               std::span<const Vec3f> given, const Context& context, std::vector<Vec3f>& directions) {
  std::vector<uint32_t> wanted;
  for (size_t i = 0; i < cloud.size(); ++i)
    if (directions[i] == Vec3f{}) wanted.push_back(static_cast<uint32_t>(i));
  if (wanted.empty()) return {};
  std::vector<Vec3f> hints = directions;
  known.for_each(0, cloud.size(), [&](size_t i, const ScanFacts& facts) {
    if (directions[i] == Vec3f{}) hints[i] = towards_scanner(known, i, facts);
  });
  NormalParams how{params.neighbors,      params.radius,  params.from_within, axis(params.up.value_or(Axis::z)),
                   params.up.has_value(), cloud.is_survey};
  EstimatedNormals estimated = estimate_normals(cloud.positions, wanted, hints, given, how, context);
  for (size_t k = 0; k < wanted.size(); ++k) directions[wanted[k]] = estimated.normals[k];
  return estimated;
}

std::string plural(size_t count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

std::string shown(Axis up) {
  const std::string name = name_of(up);
  return name[0] == '-' ? name : "+" + name;
}

/// The line about sides that follow from the scene as a whole.
void assume_from_above(const EstimatedNormals& estimated, const PointCloud& cloud, const OrientSetup& params,
                       const Context& context, OrientReport& report) {
  report.assumed = fmt::format(
      "{} of {} samples have no direction: taken as seen from above ({}), since {} (if not: --up, or --sensor)",
      estimated.seen_from_above, cloud.size(), shown(params.up.value_or(Axis::z)),
      estimated.from_above == FromAbove::survey ? "they come from a survey's file" : "they are a flat wide layer");
  context.progress().info(report.assumed);
}

/// The line about sides that were guessed part by part.
std::string guess_of(const EstimatedNormals& estimated, const PointCloud& cloud, const OrientSetup& params) {
  constexpr double notable = 0.1;  // of the propagated samples
  const auto all = static_cast<double>(estimated.propagated);
  std::string help = "give normals, or scanner positions with --sensor";
  if (!params.from_within) help += "; seen from inside: --outside solid";
  std::string how;
  if (static_cast<double>(estimated.sheets_up) > notable * all) {
    how = fmt::format(", sheets towards {},", shown(params.up.value_or(Axis::z)));
    help += "; another side is up: --up";
  } else if (static_cast<double>(estimated.doubtful) > notable * all) {
    how = fmt::format(", though the shape hardly tells the sides of {:.0f} % of them,",
                      100 * static_cast<double>(estimated.doubtful) / all);
    help += "; all seen from one side: --up";
  }
  return fmt::format(
      "{} of {} samples have no direction: normals were estimated from {} neighbors and oriented {} by propagation "
      "over {}{} which is a guess ({})",
      estimated.propagated, cloud.size(), params.neighbors, params.from_within ? "inward" : "outward",
      plural(estimated.components, "connected part"), how.empty() ? "," : how, help);
}

void estimate(const PointCloud& cloud, const OrientSetup& params, const KnownDirections& known, const Context& context,
              std::vector<Vec3f>& directions, OrientReport& report) {
  if (std::find(directions.begin(), directions.end(), Vec3f{}) != directions.end())
    warn_of_slow_disk(cloud, context, report);
  const EstimatedNormals estimated = estimate_open(cloud, params, known, {}, context, directions);
  const std::vector<Vec3f>& normals = estimated.normals;
  report.without_direction = static_cast<size_t>(std::count(normals.begin(), normals.end(), Vec3f{}));
  report.estimated = normals.size() - report.without_direction;
  report.far_planes = estimated.far_planes;
  if (estimated.from_above != FromAbove::no)
    assume_from_above(estimated, cloud, params, context, report);
  else if (estimated.propagated > 0)
    warn(context, report, guess_of(estimated, cloud, params));
  if (report.without_direction > 0)
    warn(context, report,
         fmt::format("{} of {} samples have no direction and no neighbors that span a plane: they "
                     "are left out",
                     report.without_direction, cloud.size()));
}

/// The flux of x through a closed surface is three times its volume (divergence theorem): on the whole, outward normals
/// point away from the samples' middle, whatever the shape.
bool point_inward(const PointCloud& cloud, const std::vector<Vec3f>& directions, const Context& context) {
  const Vec3d first = cloud.positions[0];
  const auto sum = sum_chunks<Vec3d>(cloud.size(), samples_at_once, context, [&](size_t begin, size_t end) {
    Vec3d part;
    for (size_t i = begin; i < end; ++i) part += cloud.positions[i] - first;
    return part;
  });
  const Vec3d middle = first + sum / static_cast<double>(cloud.size());
  struct Flux {
    double outward = 0, most = 0;
    void operator+=(const Flux& other) { outward += other.outward, most += other.most; }
  };
  const auto flux = sum_chunks<Flux>(cloud.size(), samples_at_once, context, [&](size_t begin, size_t end) {
    Flux part;
    for (size_t i = begin; i < end; ++i) {
      const Vec3d from_middle = cloud.positions[i] - middle;
      part += {dot(static_cast<Vec3d>(directions[i]), from_middle), norm(from_middle)};
    }
    return part;
  });
  constexpr double inward = -0.1;  // thin shapes reach 0.2 to 0.5, a sphere 1
  return flux.outward < inward * flux.most;
}

}  // namespace

void validate(const OrientParams& params) {
  if (params.neighbors < 3 || params.neighbors > 1000)
    throw ParameterError(fmt::format("neighbors = {}, must be in [3, 1000]", params.neighbors));
  if (params.radius && !(*params.radius > 0 && std::isfinite(*params.radius)))
    throw ParameterError(fmt::format("radius = {:g}, must be > 0", *params.radius));
  if (params.sensor && !is_finite(*params.sensor)) throw ParameterError("sensor: its coordinates must be finite");
}

std::vector<Vec3f> orient(const PointCloud& cloud, const OrientSetup& params, const Context& context,
                          OrientReport& report) {
  validate(params);
  check(cloud);
  report = {};
  std::vector<Vec3f> directions;
  reserve_many(directions, cloud.size());
  directions.resize(cloud.size());
  const KnownDirections known(cloud, params, context);
  const size_t first = params.source == DirectionSource::automatic  ? 0
                       : params.source == DirectionSource::estimate ? known_sources.size()
                                                                    : static_cast<size_t>(params.source) - 1;
  struct Found {
    std::array<size_t, known_sources.size()> samples{};  ///< of each source
    void operator+=(const Found& other) {
      for (size_t s = 0; s < samples.size(); ++s) samples[s] += other.samples[s];
    }
  };
  const auto found = sum_chunks<Found>(cloud.size(), samples_at_once, context, [&](size_t begin, size_t end) {
    Found part;
    known.for_each(begin, end, [&](size_t i, const ScanFacts& facts) {
      for (size_t s = first; s < known_sources.size() && directions[i] == Vec3f{}; ++s) {
        directions[i] = known.direction(known_sources[s], i, facts);
        part.samples[s] += directions[i] != Vec3f{};
      }
    });
    return part;
  });
  report.from_normals = found.samples[0];
  report.from_sensor = found.samples[1];
  report.from_scan = found.samples[2];
  refuse_absent_source(params.source, report);
  // A scanner's side is outside by definition.
  report.inward = 2 * report.from_normals > cloud.size() && point_inward(cloud, directions, context);
  estimate(cloud, params, known, context, directions, report);
  return directions;
}

bool check_signs(const PointCloud& cloud, const OrientSetup& params, const SideStatistics& sides,
                 const Context& context, std::vector<Vec3f>& directions, OrientReport& report) {
  constexpr double most_on_sheets = 0.05;  // of the pairs
  constexpr double most_opposed = 0.1;     // of the pairs of few samples
  report.contradicting = sides.contradicting();
  if (report.from_normals == 0) return false;
  if (!sides.contradicts()) {
    report.contradicting = std::max(report.contradicting, opposed_neighbors(cloud, directions));
    if (report.contradicting <= most_opposed) return false;
  }
  const std::string found = fmt::format(
      "neighboring normals contradict each other ({:.2g} % of the pairs on one plane)", 100 * report.contradicting);
  if (params.source != DirectionSource::automatic) {
    warn(context, report, found + ": taken as given, as asked for; --directions auto does without their signs");
    return false;
  }
  const KnownDirections known(cloud, params, context);
  std::vector<Vec3f> turned = directions;
  size_t open = 0;
  known.for_each(0, cloud.size(), [&](size_t i, const ScanFacts& facts) {
    const Vec3f normal = known.direction(DirectionSource::normals, i, facts);
    if (normal == Vec3f{}) return;
    const Vec3f view = towards_scanner(known, i, facts);
    turned[i] = view == Vec3f{} ? view : dot(normal, view) < 0 ? -normal : normal;
    open += view == Vec3f{};
  });
  if (open > 0 && sides.on_sheets() > most_on_sheets) {
    warn(context, report,
         found +
             ": taken as given all the same, for the two sides of thin parts cannot be told apart without signs; "
             "mend them, or give scanner positions with --sensor");
    return false;
  }
  const EstimatedNormals propagated = estimate_open(cloud, params, known, cloud.normals, context, turned);
  directions.swap(turned);
  for (size_t i = 0; i < cloud.size(); ++i) report.reoriented += dot(directions[i], cloud.normals[i]) < 0;
  // The majority of the signs decides where it is clear, so whole parts may look inward now.
  report.inward = open > 0 && 2 * report.from_normals > cloud.size() && point_inward(cloud, directions, context);
  warn(context, report,
       found + ": used without their signs, " +
           (open == 0 ? "oriented towards the scanners"
                      : fmt::format("oriented {} by propagation over {}, which is a guess (give scanner positions "
                                    "with --sensor)",
                                    params.from_within || report.inward ? "inward" : "outward",
                                    plural(propagated.components, "connected part"))) +
           "; --directions normals takes them as given");
  return true;
}

void use_plane_normals(const PointCloud& cloud, LocalSurface& surface, const Context& context,
                       std::vector<Vec3f>& directions, OrientReport& report) {
  constexpr float least_incidence = 0.02f;  // cosine: below it the side is unknown
  const auto turn = [&](size_t i, Vec3f normal) {
    const float incidence = dot(normal, directions[i]);
    if (!(std::abs(incidence) > least_incidence)) return false;
    directions[i] = incidence > 0 ? normal : -normal;
    return true;
  };
  const auto has_own = [&](size_t i) { return !cloud.normals.empty() && cloud.normals[i] != Vec3f{}; };
  report.from_planes = sum_chunks<size_t>(cloud.size(), samples_at_once, context, [&](size_t begin, size_t end) {
    size_t turned = 0;
    for (size_t i = begin; i < end; ++i)
      if (surface.is_plane(i) && !has_own(i)) turned += turn(i, surface.normal[i]);
    return turned;
  });
  std::vector<uint32_t> on_lines;
  size_t no_plane = 0;
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (surface.is_plane(i) || has_own(i)) continue;
    ++no_plane;
    if (surface.line[i] && directions[i] != Vec3f{}) on_lines.push_back(static_cast<uint32_t>(i));
  }
  const std::vector<Vec3f> normals = far_planes(cloud.positions, on_lines, context);
  size_t far = 0;
  for (size_t k = 0; k < on_lines.size(); ++k) {
    const uint32_t i = on_lines[k];
    if (!turn(i, normals[k])) continue;
    ++far;
    surface.normal[i] = normals[k];
    if (!(surface.spacing[i] > 0)) surface.spacing[i] = std::sqrt(surface.area[i]);
  }
  report.far_planes = std::max(report.far_planes, far);
  report.from_planes += far;
  report.without_plane = no_plane - far;
}

}  // namespace soapfilm
