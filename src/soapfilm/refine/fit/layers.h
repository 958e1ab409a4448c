// Passes over a band by layers of bricks along z: loops in which neighboring layers add to common values, and sequences
// of loops that reuse the cache. The results are the same for any number of threads.
#pragma once

#include <algorithm>
#include <cstddef>
#include <type_traits>

#include "soapfilm/core/parallel.h"

namespace soapfilm {

/// Layers [begin, end); `begin` is even.
struct LayerRange {
  LayerRange(int layers) : begin(0), end(layers) {}
  LayerRange(int first, int last) : begin(first), end(last) {}

  int size() const { return end - begin; }
  int begin, end;
};

/// Calls body(layer) for each: even layers in parallel, then odd ones, so that no two at a time touch common data.
template <class Body>
void for_even_then_odd_layers(LayerRange layers, const Context& context, Body&& body) {
  for (int parity = 0; parity < 2; ++parity)
    parallel_for(context, static_cast<size_t>((layers.size() + 1 - parity) / 2), 1,
                 [&](size_t i) { body(layers.begin + 2 * static_cast<int>(i) + parity); });
}

/// A last stage of layer_by_layer() that also adds to the next layer's values: the order of the sums is fixed, even
/// layers before odd ones.
template <class Body>
struct EvenOddStage {
  Body body;
};
template <class Body>
EvenOddStage(Body) -> EvenOddStage<Body>;

template <class Stage>
inline constexpr bool is_even_odd = false;
template <class Body>
inline constexpr bool is_even_odd<EvenOddStage<Body>> = true;

/// Consecutive layers that one thread takes through all stages. Each stage stays a layer behind the one before, also at
/// the slab's borders with others.
struct Slab {
  int begin, end;
  bool from_below, from_above;  ///< whether there is a slab there

  /// Whether a stage may process the layer before the neighboring slabs are done.
  bool holds(int stage, int layer) const {
    return layer >= begin + from_below * stage && layer < end - from_above * stage;
  }
  /// The same for a stage of type EvenOddStage, whose odd layers wait for both even layers next to them.
  int first_even(int stage) const { return from_below ? (begin + stage + 1) & ~1 : begin; }
  int last_even(int stage) const { return (end - from_above * stage - 1) & ~1; }
  int end_even_odd(int stage) const { return from_above ? last_even(stage) + 1 : end; }

  template <class Body>
  void run(int stage, int layer, Body& body) const {
    if (holds(stage, layer)) body(layer);
  }
  template <class Body>
  void run(int stage, int layer, EvenOddStage<Body>& apart) const {
    if (layer < first_even(stage) || layer >= end_even_odd(stage)) return;
    if (layer % 2 == 0 || layer + 1 == end) apart.body(layer);
    if (layer % 2 == 0 && layer > first_even(stage)) apart.body(layer - 1);
  }
};

/// The layers around the border of two slabs that both left for the end. Between those of one border and the next, a
/// stage of type EvenOddStage has an even layer that did not have to wait: they touch nothing in common.
struct SlabBorder {
  const Slab &below, &above;

  template <class Body>
  void run(int stage, Body& body) const {
    for (int layer = below.end - stage; layer < above.begin + stage; ++layer) body(layer);
  }
  template <class Body>
  void run(int stage, EvenOddStage<Body>& apart) const {
    const int begin = below.end_even_odd(stage), end = above.first_even(stage);  // from an odd layer up to an odd one
    for (int layer = begin + 1; layer < end; layer += 2) apart.body(layer);
    for (int layer = begin; layer < end; layer += 2) apart.body(layer);
  }
};

/// All layers of one stage, on all threads.
template <class Body>
void run_stage(LayerRange layers, const Context& context, Body& body) {
  parallel_for(context, static_cast<size_t>(layers.size()), 1,
               [&](size_t layer) { body(layers.begin + static_cast<int>(layer)); });
}
template <class Body>
void run_stage(LayerRange layers, const Context& context, EvenOddStage<Body>& apart) {
  for_even_then_odd_layers(layers, context, apart.body);
}

/// Calls each of the stages with every layer; the last one may be EvenOddStage. What a stage writes in a layer and in
/// those next to it is complete when the next stage comes to that layer, and mostly still in the cache: each stage
/// follows the one before at a distance of one layer through slabs of layers, each slab on one thread. Where slabs
/// meet, the later stages wait until both are done. Where there are too few layers for all threads, stages run one
/// after the other. A stage must not write what an earlier one reads in other layers.
template <class... Stages>
void layer_by_layer(LayerRange layers, const Context& context, Stages&&... stages) {
  if (layers.size() <= 0) return;
  constexpr int depth = sizeof...(Stages) - 1;
  constexpr bool apart[] = {is_even_odd<std::remove_cvref_t<Stages>>...};
  static_assert(std::none_of(apart, apart + depth, [](bool is) { return is; }), "only the last stage may be apart");
  const auto take_turn = [&](const Slab& slab, int turn) {
    int stage = 0;
    ((slab.run(stage, turn - stage, stages), ++stage), ...);
  };
  const int threads = context.threads();
  if (threads == 1) {
    const Slab all{layers.begin, layers.end, false, false};
    return parallel_for(context, static_cast<size_t>(layers.size() + depth), 1,
                        [&](size_t turn) { take_turn(all, layers.begin + static_cast<int>(turn)); });
  }

  constexpr int thinnest = 2 * depth + 2;  // with an even layer that does not wait at a border
  constexpr int thick = 2 * thinnest;      // most of its layers do not wait
  constexpr int slabs_per_thread = 6;
  const int most = std::min(layers.size() / thinnest, slabs_per_thread * threads);
  if (most < threads) return (run_stage(layers, context, stages), ...);
  const int slabs = std::clamp(layers.size() / thick, threads, most);
  const auto border = [&](int k) { return layers.begin + layers.size() * k / slabs; };
  const auto slab_at = [&](int k) { return Slab{border(k), border(k + 1), k > 0, k + 1 < slabs}; };
  parallel_for(context, static_cast<size_t>(slabs), 1, [&](size_t k) {
    const Slab slab = slab_at(static_cast<int>(k));
    for (int turn = slab.begin; turn < slab.end + depth; ++turn) take_turn(slab, turn);
  });
  parallel_for(context, static_cast<size_t>(slabs - 1), 1, [&](size_t k) {
    const Slab below = slab_at(static_cast<int>(k)), above = slab_at(static_cast<int>(k) + 1);
    int stage = 0;
    ((SlabBorder{below, above}.run(stage, stages), ++stage), ...);
  });
}

}  // namespace soapfilm
