// Embree's handles with owners; internal, included by no public header.
#pragma once

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <memory>
#include <stdexcept>

#include "soapfilm/core/parallel.h"

namespace soapfilm {

/// A scene and its device. Geometries are attached by their maker, then committed once.
class EmbreeScene {
 public:
  EmbreeScene() : device_(rtcNewDevice(config)) {
    if (!device_)
      throw std::runtime_error(fmt::format("Embree does not start, error {}", int{rtcGetDeviceError(nullptr)}));
    scene_.reset(rtcNewScene(device_.get()));
  }

  RTCDevice device() const { return device_.get(); }
  RTCScene get() const { return scene_.get(); }

  /// The only geometry of a scene: `count` items of `self`, known by their bounds and judged by visit() where a query
  /// comes near; `self` must stay where it is. Then commits.
  void build(void* self, size_t count, RTCBoundsFunction bounds, RTCPointQueryFunction visit, const Context& context) {
    const RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(count));
    rtcSetGeometryUserData(geometry, self);
    rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
    rtcSetGeometryPointQueryFunction(geometry, visit);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(get(), geometry);
    rtcReleaseGeometry(geometry);
    commit(context);
  }

  /// Builds the tree with the threads of `context`. Throws std::runtime_error when Embree cannot (out of memory).
  void commit(const Context& context) {
    confine(context, [this] { rtcJoinCommitScene(scene_.get()); });
    if (const RTCError error = rtcGetDeviceError(device_.get()); error != RTC_ERROR_NONE) {
      throw std::runtime_error(fmt::format("Embree cannot build its tree, error {}", int{error}));
    }
  }

 private:
  // Embree builds with oneTBB, which ThreadSanitizer does not understand. "threads=1" is for that build alone: it
  // limits oneTBB in the whole process while the device lives.
#ifdef SOAPFILM_STD_THREADS
  static constexpr const char* config = "threads=1";
#else
  static constexpr const char* config = "start_threads=0,set_affinity=0";
#endif

  struct Release {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  };
  std::unique_ptr<RTCDeviceTy, Release> device_;
  std::unique_ptr<RTCSceneTy, Release> scene_;
};

}  // namespace soapfilm
