#include "soapfilm/opencl/device.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "soapfilm/error.h"
#include "soapfilm/grid/brick_grid.h"
#include "soapfilm/opencl/iteration_source.h"
#include "soapfilm/opencl/runtime.h"
#include "soapfilm/solve/level_solver.h"

namespace soapfilm {

namespace {

/// As in iteration.cl.
struct ClBox {
  cl_int lo[3], hi[3], open;
};

/// What lies beyond a brick's lower or upper face; bricks are their indices, planes of the rim first_plane - theirs.
enum ClFace : cl_int { nothing = -1, inactive = -2, first_plane = -3 };

/// A level's topology as iteration.cl reads it: 3 values for each brick.
struct ClTopology {
  std::vector<cl_int> below, above, first_vertex;
  std::vector<cl_uchar> held;  // of each brick

  explicit ClTopology(Level& level) : held(level.grid.size()) {
    std::transform(level.held.begin(), level.held.end(), held.begin(), [](Held h) { return static_cast<cl_uchar>(h); });
    const BrickGrid& grid = level.grid;
    for (size_t b = 0; b < grid.size(); ++b)
      for (int axis = 0; axis < 3; ++axis) {
        const int32_t low = grid.neighbors(b)[static_cast<size_t>(slot_down[axis])];
        const int32_t up = grid.neighbors(b)[static_cast<size_t>(slot_up[axis])];
        const float* plane = level.rim.plane(b, axis);
        const auto index = plane ? static_cast<cl_int>((plane - level.rim.flux().data()) / brick_area) : 0;
        below.push_back(low >= 0 ? low : plane ? first_plane - index : nothing);
        above.push_back(level.rests(up) ? inactive : up >= 0 ? up : nothing);
        first_vertex.push_back(grid.first_vertex(b)[axis]);
      }
  }
};

struct ClValues {
  const void* data;
  size_t bytes;
};
template <class T>
ClValues values(const std::vector<T>& all) {
  return {all.data(), all.size() * sizeof(T)};
}

class ClSolver final : public LevelSolver {
 public:
  ClSolver(std::shared_ptr<const ClRuntime> runtime, Level& level, const Context& context, size_t most_bytes)
      : LevelSolver(level, context), runtime_(std::move(runtime)), most_bytes_(most_bytes) {
    if (level.grid.size() == 0) return;
    cl_int code = CL_SUCCESS;
    queue_.reset(clCreateCommandQueue(runtime_->context.get(), runtime_->device, 0, &code));
    check(code, "clCreateCommandQueue");
    upload();
    primal_ = kernel("primal");
    dual_ = kernel("dual");
    ClBox box{{}, {}, level.box.open};
    for (int axis = 0; axis < 3; ++axis) {
      box.lo[axis] = level.box.free_lo[axis];
      box.hi[axis] = level.box.free_hi[axis];
    }
    set_arguments(primal_, u_, u_bar_, p_, rim_, f_, f_brick_, below_, first_vertex_, held_, box);
    set_arguments(dual_, p_, u_bar_, above_, first_vertex_, held_, box, cl_float{0}, cl_float{dual_radius(level)},
                  cl_int{level.norm == Norm::isotropic});
  }

  void sweep(StepSizes steps, int times) override {
    if (level_.grid.size() == 0) return;
    downloaded_ = false;
    constexpr cl_uint tau_of_primal = 10, sigma_of_dual = 6;
    set_argument(primal_, tau_of_primal, steps.tau);
    set_argument(dual_, sigma_of_dual, steps.sigma);
    for (int i = 0; i < times; ++i) {
      enqueue(primal_);
      enqueue(dual_);
    }
    check(clFinish(queue_.get()), "clFinish");
  }

  void download() override {
    if (level_.grid.size() == 0 || downloaded_) return;
    downloaded_ = true;
    read(u_, level_.u.brick(0), level_.u.bytes());
    read(p_, level_.p.brick(0), level_.p.bytes());
  }

 private:
  void check(cl_int code, const char* call) const { runtime_->check(code, call); }

  void upload() {
    const ClTopology topology(level_);
    const Field<float>& f = *level_.f;
    AlignedArray<float>& rim = level_.rim.flux();
    const std::pair<ClBuffer*, ClValues> all[] = {{&u_, {level_.u.brick(0), level_.u.bytes()}},
                                                  {&u_bar_, {nullptr, level_.u.bytes()}},
                                                  {&p_, {level_.p.brick(0), level_.p.bytes()}},
                                                  {&rim_, {rim.data(), rim.bytes()}},
                                                  {&f_, {f.bricks() > 0 ? f.brick(0) : nullptr, f.bytes()}},
                                                  {&f_brick_, values(level_.f_brick)},
                                                  {&below_, values(topology.below)},
                                                  {&above_, values(topology.above)},
                                                  {&first_vertex_, values(topology.first_vertex)},
                                                  {&held_, values(topology.held)}};
    size_t bytes = 0, largest = 0;
    for (const auto& [buffer, content] : all) {
      bytes += content.bytes;
      largest = std::max(largest, content.bytes);
    }
    refuse_more_than(most_bytes_, bytes, "a level takes {} MB");
    refuse_more_than(runtime_->most_bytes_of_buffer, largest, "a level takes {} MB in one piece");
    for (const auto& [buffer, content] : all) *buffer = filled_buffer(content);
  }

  void refuse_more_than(size_t most, size_t bytes, fmt::format_string<size_t> message) const {
    constexpr size_t mega = 1000000;
    if (bytes > most)
      throw MemoryError(fmt::format("OpenCL device '{}': {}, {} MB are there: choose a lower resolution",
                                    runtime_->name, fmt::format(message, (bytes + mega - 1) / mega), most / mega));
  }

  /// Never empty: kernels take no null.
  ClBuffer filled_buffer(ClValues content) const {
    cl_int code = CL_SUCCESS;
    ClBuffer buffer(clCreateBuffer(runtime_->context.get(), CL_MEM_READ_WRITE, std::max(content.bytes, sizeof(float)),
                                   nullptr, &code));
    check(code, "clCreateBuffer");
    if (content.data && content.bytes > 0)
      check(clEnqueueWriteBuffer(queue_.get(), buffer.get(), CL_TRUE, 0, content.bytes, content.data, 0, nullptr,
                                 nullptr),
            "clEnqueueWriteBuffer");
    return buffer;
  }

  void read(const ClBuffer& buffer, void* to, size_t bytes) const {
    check(clEnqueueReadBuffer(queue_.get(), buffer.get(), CL_TRUE, 0, bytes, to, 0, nullptr, nullptr),
          "clEnqueueReadBuffer");
  }

  ClKernel kernel(const char* name) const {
    cl_int code = CL_SUCCESS;
    ClKernel made(clCreateKernel(runtime_->program.get(), name, &code));
    check(code, "clCreateKernel");
    return made;
  }

  template <class T>
  void set_argument(const ClKernel& kernel, cl_uint index, const T& value) const {
    check(clSetKernelArg(kernel.get(), index, sizeof(value), &value), "clSetKernelArg");
  }
  void set_argument(const ClKernel& kernel, cl_uint index, const ClBuffer& buffer) const {
    const cl_mem memory = buffer.get();
    check(clSetKernelArg(kernel.get(), index, sizeof(memory), &memory), "clSetKernelArg");
  }
  template <class... Values>
  void set_arguments(const ClKernel& kernel, const Values&... all) const {
    cl_uint index = 0;
    (set_argument(kernel, index++, all), ...);
  }

  void enqueue(const ClKernel& kernel) const {
    const size_t vertices = level_.grid.vertices(), group = brick_area;
    check(clEnqueueNDRangeKernel(queue_.get(), kernel.get(), 1, nullptr, &vertices, &group, 0, nullptr, nullptr),
          "clEnqueueNDRangeKernel");
  }

  std::shared_ptr<const ClRuntime> runtime_;
  size_t most_bytes_;
  bool downloaded_ = true;
  ClQueue queue_;
  ClBuffer u_, u_bar_, p_, rim_, f_, f_brick_, below_, above_, first_vertex_, held_;
  ClKernel primal_, dual_;
};

class ClDevice final : public Device {
 public:
  ClDevice(const std::string& name, size_t most_bytes)
      : runtime_(std::make_shared<const ClRuntime>(open_runtime(name, iteration_source))),
        most_bytes_(most_bytes > 0 ? std::min(most_bytes, runtime_->most_bytes) : runtime_->most_bytes) {}

  using Device::on;
  std::shared_ptr<LevelSolver> on(Level& level, const Context& context) const override {
    return std::make_shared<ClSolver>(runtime_, level, context, most_bytes_);
  }

 private:
  std::shared_ptr<const ClRuntime> runtime_;
  size_t most_bytes_;
};

}  // namespace

std::shared_ptr<const Device> opencl_device(const std::string& name, size_t most_bytes) {
  return std::make_shared<ClDevice>(name, most_bytes);
}

}  // namespace soapfilm
