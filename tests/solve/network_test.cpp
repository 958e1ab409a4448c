#include "soapfilm/solve/network.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "soapfilm/core/random.h"

namespace soapfilm {
namespace TEST_FILE {

/// Random links, parallel ones too, between so few vertices that all labels can be tried.
std::vector<NetworkVertex> random_network(Random& random, uint32_t vertices) {
  std::vector<NetworkVertex> network(vertices);
  for (uint32_t v = 0; v < vertices; ++v) {
    network[v].unary = random.uniform() < 0.2 ? 0 : random.normal();
    for (uint32_t other = v + 1; other < vertices; ++other)
      while (random.uniform() < 0.4) network[v].links.emplace_back(other, random.uniform());
  }
  return network;
}

double energy_of(const std::vector<NetworkVertex>& network, uint32_t labels) {
  double sum = 0;
  for (size_t v = 0; v < network.size(); ++v) {
    const bool own = labels >> v & 1;
    if (own) sum += network[v].unary;
    for (const auto& link : network[v].links) sum += own != (labels >> link.first & 1) ? link.second : 0;
  }
  return sum;
}

MinCut cut_of(const std::vector<NetworkVertex>& network) {
  return min_cut(
      static_cast<uint32_t>(network.size()),
      [&](const auto& visit) {
        for (const NetworkVertex& vertex : network) visit(vertex);
      },
      Context(1));
}

TEST(Network, NoLabelsCostLess) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const auto vertices = static_cast<uint32_t>(1 + trial % 9);
    const std::vector<NetworkVertex> network = random_network(random, vertices);
    const MinCut cut = cut_of(network);
    uint32_t found = 0;
    for (uint32_t v = 0; v < vertices; ++v) found |= cut.inside[v] ? 1u << v : 0u;
    double bound = 0, least = 0;
    for (const NetworkVertex& vertex : network) bound += std::max(0.0, -vertex.unary);
    for (uint32_t labels = 0; labels < 1u << vertices; ++labels) least = std::min(least, energy_of(network, labels));
    EXPECT_NEAR(energy_of(network, found), least, 1e-12);
    EXPECT_NEAR(cut.flow - bound, least, 1e-12);
  }
}

TEST(Network, CountsItsLinks) {
  Random random(2);
  std::vector<NetworkVertex> network(1000);
  for (uint32_t v = 0; v < network.size(); ++v) {
    network[v].unary = random.normal();
    if (v > 0) network[v - 1].links.emplace_back(v, random.uniform());
  }
  EXPECT_GT(cut_of(network).flow, 0);
  EXPECT_EQ(cut_of(network).links, 999u);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
