#include "soapfilm/refine/fit/layers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

const Context one_thread(1);
constexpr int most_layers = test::sanitized ? 20 : 80;
using Values = std::vector<uint64_t>;

/// The sum over a layer and those next to it.
uint64_t around(const Values& values, int layer) {
  uint64_t sum = 0;
  const int last = static_cast<int>(values.size()) - 1;
  for (int i = std::max(layer - 1, 0); i <= std::min(layer + 1, last); ++i) sum += values[static_cast<size_t>(i)];
  return sum;
}

/// Stages that each sum up the values that the previous stage wrote in a layer and its neighbors.
class Pass {
 public:
  Pass(int layers, size_t stages)
      : values(stages + 1, Values(static_cast<size_t>(layers))), planes(static_cast<size_t>(layers) + 1) {
    for (int i = 0; i < layers; ++i) values[0][static_cast<size_t>(i)] = static_cast<uint64_t>(i * i + 1);
  }

  auto stage(size_t number) {
    return
        [this, number](int layer) { values[number + 1][static_cast<size_t>(layer)] += around(values[number], layer); };
  }
  /// Changes values between a layer and the next, so that the result depends on the order.
  auto add(size_t number) {
    return [this, number](int layer) {
      for (const size_t plane : {static_cast<size_t>(layer), static_cast<size_t>(layer) + 1})
        planes[plane] = 31 * planes[plane] + around(values[number], layer);
    };
  }

  std::vector<Values> values;
  Values planes;
};

template <size_t... Stage>
Pass run(int layers, const Context& context, std::index_sequence<Stage...>) {
  Pass pass(layers, sizeof...(Stage));
  layer_by_layer(layers, context, pass.stage(Stage)...);
  return pass;
}

template <size_t... Stage>
Pass run_apart(int layers, const Context& context, std::index_sequence<Stage...>) {
  Pass pass(layers, sizeof...(Stage));
  layer_by_layer(layers, context, pass.stage(Stage)..., EvenOddStage{pass.add(sizeof...(Stage))});
  return pass;
}

/// check(stages) for none to three of them.
template <class Check>
void for_each_depth(Check&& check) {
  check(std::make_index_sequence<0>());
  check(std::make_index_sequence<1>());
  check(std::make_index_sequence<2>());
  check(std::make_index_sequence<3>());
}

TEST(LayerByLayer, StagesFollowOneAnother) {
  const Pass pass = run(3, one_thread, std::make_index_sequence<2>());
  EXPECT_EQ(pass.values[1], (Values{3, 8, 7}));
  EXPECT_EQ(pass.values[2], (Values{11, 18, 15}));
}

TEST(LayerByLayer, OnAnyNumberOfThreads) {
  for (const int threads : {2, 3, 8}) {
    const Context context(threads);
    for (int layers = 0; layers <= most_layers; ++layers)
      for_each_depth([&](auto stages) {
        if constexpr (stages.size() > 0) {
          EXPECT_EQ(run(layers, context, stages).values, run(layers, one_thread, stages).values) << layers;
        }
      });
  }
}

TEST(LayerByLayer, EvenLayersAddBeforeOddOnesOnAnyNumberOfThreads) {
  for (const int threads : {1, 2, 3, 8}) {
    const Context context(threads);
    for (int layers = 0; layers <= most_layers; ++layers)
      for_each_depth([&](auto stages) {
        Pass expected(layers, stages.size());
        if constexpr (stages.size() > 0) expected = run(layers, one_thread, stages);
        for (int parity = 0; parity < 2; ++parity)
          for (int layer = parity; layer < layers; layer += 2) expected.add(stages.size())(layer);
        const Pass pass = run_apart(layers, context, stages);
        EXPECT_EQ(pass.values, expected.values) << layers;
        EXPECT_EQ(pass.planes, expected.planes) << layers << " layers, " << threads << " threads";
      });
  }
}

TEST(ForLayersApart, TakesEachOnce) {
  for (int layers = 0; layers < 6; ++layers) {
    std::vector<int> visits(static_cast<size_t>(layers));
    for_even_then_odd_layers(layers, Context(2), [&](int layer) { ++visits[static_cast<size_t>(layer)]; });
    EXPECT_EQ(visits, std::vector<int>(visits.size(), 1));
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
