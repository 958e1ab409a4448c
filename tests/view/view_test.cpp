#include "tools/view/view.h"

#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "soapfilm/core/random.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "tools/view/arrays.h"
#include "tools/view/page.h"
#include "tools/view/reduce.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace view_detail;
using nlohmann::ordered_json;

constexpr const char* small_page =
    "<title><!--soapfilm:title--></title><script id=\"scene\"><!--soapfilm:scene--></script>\n<!--soapfilm:data-->end";

/// A ball of latitudes and longitudes with an attribute.
Mesh ball(double radius, Vec3d center, uint32_t rows) {
  Mesh mesh;
  const uint32_t columns = 2 * rows;
  const auto at = [&](uint32_t r, uint32_t c) {
    return r == 0 ? 0 : r == rows ? 1 : 2 + (r - 1) * columns + c % columns;
  };
  mesh.vertices = {center + Vec3d{0, 0, radius}, center - Vec3d{0, 0, radius}};
  for (uint32_t r = 1; r < rows; ++r) {
    for (uint32_t c = 0; c < columns; ++c) {
      const double theta = M_PI * r / rows;
      const double phi = 2 * M_PI * c / columns;
      mesh.vertices.push_back(
          center + radius * Vec3d{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)});
    }
  }
  for (uint32_t r = 0; r < rows; ++r) {
    for (uint32_t c = 0; c < columns; ++c) {
      if (r + 1 < rows) mesh.triangles.push_back({at(r, c), at(r + 1, c), at(r + 1, c + 1)});
      if (r > 0) mesh.triangles.push_back({at(r, c), at(r + 1, c + 1), at(r, c + 1)});
    }
  }
  return mesh;
}

PointCloud cloud_of(size_t count, Vec3d center = {}) {
  PointCloud cloud;
  Random random(7);
  for (size_t i = 0; i < count; ++i)
    cloud.positions.push_back(center + Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
  cloud.scans.resize(1);
  cloud.scans[0].end = count;
  return cloud;
}

size_t count_of(const std::string& text, const std::string& part) {
  size_t count = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

std::string between(const std::string& text, const std::string& begin, const std::string& end) {
  const size_t from = text.find(begin) + begin.size();
  return text.substr(from, text.find(end, from) - from);
}

std::vector<unsigned char> from_base64(const std::string& text) {
  std::vector<unsigned char> bytes;
  uint32_t group = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    const int digit = c == '+' ? 62 : c == '/' ? 63 : c >= 'a' ? c - 'a' + 26 : c >= 'A' ? c - 'A' : c - '0' + 52;
    group = group << 6 | static_cast<uint32_t>(digit);
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes.push_back(static_cast<unsigned char>(group >> bits));
  }
  return bytes;
}

/// A page, read as the browser reads it.
struct Read {
  std::string html;
  ordered_json scene;

  template <class T>
  std::vector<T> array(const ordered_json& entry) const {
    const auto coded = from_base64(between(html, "id=\"data" + std::to_string(entry["id"].get<int>()) + "\">", "<"));
    std::vector<T> values(entry["count"].get<size_t>());
    const bool indices = entry["coding"] == "triangles";
    const int error =
        indices ? meshopt_decodeIndexBuffer(values.data(), values.size(), sizeof(T), coded.data(), coded.size())
                : meshopt_decodeVertexBuffer(values.data(), values.size(), sizeof(T), coded.data(), coded.size());
    EXPECT_EQ(error, 0);
    return values;
  }
  std::vector<Vec3d> world(size_t item) const {
    const ordered_json& o = scene["origin"];
    std::vector<Vec3d> out;
    for (const Vec3f p : array<Vec3f>(scene["items"][item]["positions"]))
      out.push_back(Vec3d{o[0], o[1], o[2]} + Vec3d(p));
    return out;
  }
};

Read page(const std::vector<ViewItem>& items, const ViewParams& params = {}, int threads = 1) {
  Read read{page_of(small_page, items, params, Context(threads)), {}};
  read.scene = ordered_json::parse(between(read.html, "id=\"scene\">", "</script>"));
  return read;
}

std::string refusal(const std::vector<ViewItem>& items) {
  try {
    page_of(small_page, items, {}, Context(1));
  } catch (const ParameterError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(View, NamesAndReportsStayData) {
  const Mesh mesh = ball(1, {}, 6);
  const std::string evil = "</script><script>alert(1)</script><!--&\"'\n\xff";
  const ordered_json report = {{"warnings", {evil.substr(0, evil.size() - 1)}}};
  ViewParams params;
  params.title = evil;
  const Read read = page({{&mesh, evil, report.dump()}}, params);
  const size_t arrays = count_of(read.html, "id=\"data");
  EXPECT_EQ(count_of(read.html, "</script"), 1 + arrays);
  EXPECT_EQ(count_of(read.html, "alert(1)"), 4u);  // title, and in the scene: title, name, report
  EXPECT_EQ(count_of(read.html, "<!--"), 0u);
  EXPECT_NE(read.html.find("<title>&lt;/script&gt;&lt;script&gt;"), std::string::npos);
  const std::string name = read.scene["items"][0]["name"];
  EXPECT_EQ(name, "</script><script>alert(1)</script><!--&\"'?\xef\xbf\xbd");
  EXPECT_EQ(read.scene["items"][0]["report"], report);
}

TEST(View, GeoreferencedPositionsLoseNothingThatIsSeen) {
  const Vec3d far{417233.2517, 5301234.8765, 512.125};
  const Mesh mesh = ball(40, far, 40);
  const Read read = page({{&mesh, "far", ""}});
  std::vector<Vec3d> shown = read.world(0);
  ASSERT_EQ(shown.size(), mesh.vertices.size());
  const auto by_place = [](Vec3d a, Vec3d b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); };
  for (const Vec3d p : mesh.vertices) {  // 80 in size: float around the origin keeps some 4e-6
    double least = 1;
    for (const Vec3d q : shown) least = std::min(least, norm(p - q));
    ASSERT_LT(least, 1e-5);
  }
  std::sort(shown.begin(), shown.end(), by_place);
  EXPECT_NEAR(read.scene["items"][0]["box"]["lo"][0].get<double>(), far.x - 40, 1e-9);
}

TEST(View, FloatCoordinatesAroundZeroStayAsTheyAre) {
  PointCloud cloud = cloud_of(500);
  for (Vec3d& p : cloud.positions) p = Vec3d(Vec3f(p));
  const Read read = page({{&cloud, "cloud", ""}});
  std::set<std::vector<double>> sent, kept;
  for (const Vec3d p : cloud.positions) sent.insert({p.x, p.y, p.z});
  for (const Vec3d p : read.world(0)) kept.insert({p.x, p.y, p.z});
  EXPECT_EQ(sent, kept);
}

TEST(View, AllTrianglesAreThereWithTheirOrientation) {
  const Mesh mesh = ball(2, {1, 2, 3}, 20);
  const Read read = page({{&mesh, "ball", ""}});
  const auto indices = read.array<uint32_t>(read.scene["items"][0]["indices"]);
  Mesh shown;
  shown.vertices = read.world(0);
  for (size_t i = 0; i < indices.size(); i += 3)
    shown.triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
  EXPECT_EQ(shown.triangles.size(), mesh.triangles.size());
  EXPECT_TRUE(check_topology(shown).watertight());
  EXPECT_NEAR(shown.volume(), mesh.volume(), 1e-5 * mesh.volume());
  EXPECT_EQ(read.scene["items"][0]["error"], 0.0);
}

TEST(View, LargeMeshesAreSimplifiedAndSaySo) {
  const Mesh mesh = ball(10, {100, 0, 0}, 150);
  ViewParams params;
  params.triangles = 5000;
  const Read read = page({{&mesh, "ball", ""}}, params);
  const ordered_json& item = read.scene["items"][0];
  EXPECT_LE(item["triangles"].get<size_t>(), 5000u);
  EXPECT_GT(item["triangles"].get<size_t>(), 4000u);
  EXPECT_EQ(item["source"]["triangles"], mesh.triangles.size());
  EXPECT_GT(item["error"].get<double>(), 0);
  EXPECT_LT(item["error"].get<double>(), 0.1);
  for (const Vec3d p : read.world(0))
    ASSERT_NEAR(norm(p - Vec3d{100, 0, 0}), 10, 1e-5);  // they are vertices of the mesh
}

TEST(View, ThinnedSamplesAreEvenAndAlwaysTheSame) {
  const std::vector<uint32_t> kept = thinned(100000, 5000);
  ASSERT_EQ(kept.size(), 5000u);
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
  EXPECT_EQ(std::adjacent_find(kept.begin(), kept.end()), kept.end());
  EXPECT_EQ(kept, thinned(100000, 5000));
  for (uint32_t begin = 0; begin < 100000; begin += 10000) {  // 500 expected in each tenth, standard deviation 21
    const auto count = std::count_if(kept.begin(), kept.end(), [&](uint32_t i) { return i / 10000 == begin / 10000; });
    EXPECT_NEAR(static_cast<double>(count), 500, 120);
  }
  EXPECT_EQ(thinned(10, 0).size(), 10u);
  EXPECT_EQ(thinned(10, 10).size(), 10u);
}

TEST(View, TheSameItemsGiveTheSameBytesForAnyNumberOfThreads) {
  const Mesh mesh = ball(1, {}, 60);
  const PointCloud cloud = cloud_of(5000);
  ViewParams params;
  params.triangles = 2000;
  params.samples = 1000;
  const std::vector<ViewItem> items{{&mesh, "a", ""}, {&cloud, "b", ""}};
  const std::string once = page(items, params).html;
  EXPECT_EQ(once, page(items, params).html);
  EXPECT_EQ(once, page(items, params, 4).html);
}

TEST(View, AttributesKeepTheirValuesAndRanges) {
  PointCloud cloud = cloud_of(1000);
  const float none = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> values(1000), classes(1000);
  for (size_t i = 0; i < 1000; ++i) {
    values[i] = i == 5 ? none : static_cast<float>(i);
    classes[i] = static_cast<float>(i % 3 * 2);
  }
  cloud.columns = {{"intensity", values}, {"class", classes, true}, {"nothing", std::vector<float>(1000, none)}};
  cloud.scans.resize(2);
  cloud.scans[0].end = 400;
  cloud.scans[1].name = "second";
  cloud.scans[1].begin = 400;
  cloud.scans[1].end = 1000;
  const Read read = page({{&cloud, "cloud", ""}});
  const ordered_json& attributes = read.scene["items"][0]["attributes"];
  ASSERT_EQ(attributes.size(), 3u);
  EXPECT_EQ(attributes[0]["lo"], 0.0F);
  EXPECT_EQ(attributes[0]["hi"], 999.0F);
  EXPECT_NEAR(attributes[0]["low"].get<double>(), 20, 2);
  EXPECT_NEAR(attributes[0]["high"].get<double>(), 979, 2);
  EXPECT_EQ(attributes[1]["codes"], ordered_json({0.0, 2.0, 4.0}));
  EXPECT_EQ(attributes[2]["labels"], ordered_json({"1", "second"}));
  const auto shown = read.array<float>(attributes[0]["data"]);
  const auto scan = read.array<float>(attributes[2]["data"]);
  std::set<float> seen;
  size_t nans = 0;
  for (size_t i = 0; i < shown.size(); ++i) {
    if (std::isnan(shown[i])) {
      ++nans;
      continue;
    }
    seen.insert(shown[i]);
    EXPECT_EQ(scan[i], shown[i] < 400 ? 0.0F : 1.0F);
  }
  EXPECT_EQ(nans, 1u);
  EXPECT_EQ(seen.size(), 999u);
}

TEST(View, NormalsArePackedWithinThousandthsOfADegree) {
  const auto unpack = [](std::array<int16_t, 2> packed) {
    Vec3d n{packed[0] / 32767.0, packed[1] / 32767.0, 0};
    n.z = 1 - std::abs(n.x) - std::abs(n.y);
    if (n.z < 0) {
      const double x = n.x;
      n.x = (1 - std::abs(n.y)) * (x >= 0 ? 1 : -1);
      n.y = (1 - std::abs(x)) * (n.y >= 0 ? 1 : -1);
    }
    return n / norm(n);
  };
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    Vec3d n{random.normal(), random.normal(), random.normal()};
    n = n / norm(n);
    ASSERT_LT(norm(unpack(pack_normal(Vec3f(n))) - n), 8e-5);
  }
  for (const Vec3f n : {Vec3f{0, 0, -1}, Vec3f{0, 0, 1}, Vec3f{-1, 0, 0}, Vec3f{0, -1, 0}})
    EXPECT_LT(norm(unpack(pack_normal(n)) - Vec3d(n)), 1e-4);
  EXPECT_EQ(pack_normal({0, 0, 0})[0], INT16_MIN);
  EXPECT_EQ(pack_normal({NAN, 0, 1})[0], INT16_MIN);
}

TEST(View, Base64AsInRfc4648) {
  const auto coded = [](const std::string& text) {
    return base64({reinterpret_cast<const unsigned char*>(text.data()), text.size()});
  };
  EXPECT_EQ(coded(""), "");
  EXPECT_EQ(coded("f"), "Zg==");
  EXPECT_EQ(coded("fo"), "Zm8=");
  EXPECT_EQ(coded("foobar"), "Zm9vYmFy");
  EXPECT_EQ(coded("\xff\xfe\xfd"), "//79");
}

TEST(View, RefusesWhatCannotBeShownInOneLine) {
  const Mesh good = ball(1, {}, 6);
  Mesh mesh = good;
  EXPECT_NE(refusal({}).find("0 items"), std::string::npos);
  mesh.vertices[3].y = NAN;
  EXPECT_NE(refusal({{&mesh, "m", ""}}).find("m: position 3 is ("), std::string::npos);
  mesh = good;
  mesh.triangles[2][1] = 9999;
  EXPECT_NE(refusal({{&mesh, "m", ""}}).find("triangle 2 has vertex 9999, must be below"), std::string::npos);
  mesh = good;
  mesh.colors.resize(3);
  EXPECT_NE(refusal({{&mesh, "m", ""}}).find("3 colors, must be"), std::string::npos);
  mesh = good;
  mesh.triangles.clear();
  EXPECT_NE(refusal({{&mesh, "m", ""}}).find("0 triangles"), std::string::npos);
  PointCloud cloud = cloud_of(10);
  cloud.scans[0].end = 11;
  EXPECT_NE(refusal({{&cloud, "c", ""}}).find("scan has samples 0 to 11"), std::string::npos);
  const PointCloud empty;
  EXPECT_NE(refusal({{&empty, "c", ""}}).find("0 positions"), std::string::npos);
  EXPECT_NE(refusal({{&good, "m", "[1]"}}).find("no JSON object"), std::string::npos);
  EXPECT_NE(refusal({{&good, "m", "{\"a\""}}).find("no JSON object"), std::string::npos);
  EXPECT_THROW(fill_page("<title></title>", "t", {}, {}), std::logic_error);
}

TEST(View, OnePointAndAFlatCloudCanBeShown) {
  PointCloud point = cloud_of(1, {1e6, 2e6, 3e6});
  const Read one = page({{&point, "p", ""}});
  EXPECT_GT(one.scene["items"][0]["radius"].get<double>(), 0);
  EXPECT_EQ(one.world(0)[0], point.positions[0]);
  PointCloud same = cloud_of(20);
  for (Vec3d& p : same.positions) p = {5, 5, 5};
  EXPECT_EQ(page({{&same, "p", ""}}).world(0).size(), 20u);
}

TEST(View, ThePageOfTheBuildHasItsPlaces) {
  if (!has_viewer()) GTEST_SKIP() << "built without the viewer";
  const Mesh mesh = ball(1, {}, 6);
  const std::string html = viewer_page({{&mesh, "ball.ply", ""}}, {}, Context(1));
  EXPECT_EQ(count_of(html, "<!--soapfilm:"), 0u);
  EXPECT_NE(html.find("<title>ball.ply</title>"), std::string::npos);
  EXPECT_EQ(count_of(html, "http-equiv=\"Content-Security-Policy\""), 1u);
  EXPECT_EQ(count_of(html, " src="), 0u);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
