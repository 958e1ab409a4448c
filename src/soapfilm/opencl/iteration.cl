// The iteration of the solve in OpenCL C 1.2, one work item for each vertex of the band: brick after brick, in a brick
// x fastest. solve/level_solver.h has the operations and their order; the bits are the CPU's.
#pragma OPENCL FP_CONTRACT OFF

#define SIDE 8
#define AREA 64
#define VOLUME 512

// What lies beyond a brick's face, if not a brick (as an index): a plane of the rim (FIRST_PLANE - its index), nothing,
// or a brick that rests, to which the flux is fixed. ClFace in device.cpp has the same numbers.
#define NOTHING -1
#define INACTIVE -2
#define FIRST_PLANE -3

// The box: its free vertices from `lo` to `hi`, inclusive; whether it is open. ClBox in device.cpp is the same.
typedef struct {
  int lo[3];
  int hi[3];
  int open;
} Box;

bool in_range(int value, int lo, int hi) { return value >= lo && value <= hi; }

bool is_free(const Box* box, const int* v) {
  return in_range(v[0], box->lo[0], box->hi[0]) && in_range(v[1], box->lo[1], box->hi[1]) &&
         in_range(v[2], box->lo[2], box->hi[2]);
}

// Position of the value on a face: the two coordinates across the axis, the lower one fastest.
int on_face(int axis, int x, int y, int z) {
  return axis == 0 ? y + SIDE * z : axis == 1 ? x + SIDE * z : x + SIDE * y;
}

// p_axis of the vertex below vertex i of a brick along an axis.
float flux_below(__global const float* p, __global const float* rim, __global const int* below, size_t brick, int i,
                 int axis) {
  const int at[3] = {i & 7, i >> 3 & 7, i >> 6};
  const int stride = axis == 0 ? 1 : axis == 1 ? SIDE : AREA;
  __global const float* own = p + (brick * 3 + axis) * VOLUME;
  if (at[axis] > 0) return own[i - stride];
  const int face = below[brick * 3 + axis];
  if (face >= 0) return p[((size_t)face * 3 + axis) * VOLUME + i + 7 * stride];
  if (face == NOTHING) return 0.0f;
  return rim[(size_t)(FIRST_PLANE - face) * AREA + on_face(axis, at[0], at[1], at[2])];
}

__kernel void primal(__global float* u, __global float* u_bar, __global const float* p, __global const float* rim,
                     __global const float* f, __global const int* f_brick, __global const int* below,
                     __global const int* first_vertex, __global const uchar* held, const Box box, const float tau) {
  const size_t vertex = get_global_id(0), brick = vertex / VOLUME;
  if (held[brick]) return;
  const int i = (int)(vertex % VOLUME);
  __global const float* own = p + brick * 3 * VOLUME + i;
  const float dx = flux_below(p, rim, below, brick, i, 0) - own[0];
  const float dy = flux_below(p, rim, below, brick, i, 1) - own[VOLUME];
  const float dz = flux_below(p, rim, below, brick, i, 2) - own[2 * VOLUME];
  const float grad_t_p = dx + dy + dz;
  const int data = f_brick[brick];
  const float gain = data < 0 ? 0.0f : f[(size_t)data * VOLUME + i];
  const int v[3] = {first_vertex[brick * 3] + (i & 7), first_vertex[brick * 3 + 1] + (i >> 3 & 7),
                    first_vertex[brick * 3 + 2] + (i >> 6)};
  const float cap = is_free(&box, v) ? 1.0f : 0.0f;
  const float old = u[vertex], moved = old - tau * (grad_t_p - gain);
  const float now = fmin(fmax(moved, 0.0f), cap);
  u[vertex] = now;
  u_bar[vertex] = now + now - old;
}

// u_bar of the vertex above vertex i of a brick along an axis, 0 beyond the band; *fixed: so is the flux between them.
float u_bar_above(__global const float* u_bar, __global const int* above, size_t brick, int i, int axis, bool* fixed) {
  const int at[3] = {i & 7, i >> 3 & 7, i >> 6};
  const int stride = axis == 0 ? 1 : axis == 1 ? SIDE : AREA;
  *fixed = false;
  if (at[axis] < SIDE - 1) return u_bar[brick * VOLUME + i + stride];
  const int face = above[brick * 3 + axis];
  *fixed = face == INACTIVE;
  return face < 0 ? 0.0f : u_bar[(size_t)face * VOLUME + i - 7 * stride];
}

float squared(const float* a) { return a[0] * a[0] + a[1] * a[1] + a[2] * a[2]; }

__kernel void dual(__global float* p, __global const float* u_bar, __global const int* above,
                   __global const int* first_vertex, __global const uchar* held, const Box box, const float sigma,
                   const float lambda, const int isotropic) {
  const size_t vertex = get_global_id(0), brick = vertex / VOLUME;
  if (held[brick]) return;
  const int i = (int)(vertex % VOLUME);
  __global float* own = p + brick * 3 * VOLUME + i;
  const int v[3] = {first_vertex[brick * 3] + (i & 7), first_vertex[brick * 3 + 1] + (i >> 3 & 7),
                    first_vertex[brick * 3 + 2] + (i >> 6)};
  const float here = u_bar[vertex];
  float kept[3], q[3];
  bool fixed[3];
  for (int axis = 0; axis < 3; ++axis) {
    const float next = u_bar_above(u_bar, above, brick, i, axis, &fixed[axis]);
    if (box.open) {
      const int end[3] = {v[0] + (axis == 0), v[1] + (axis == 1), v[2] + (axis == 2)};
      fixed[axis] = fixed[axis] || !is_free(&box, v) || !is_free(&box, end);
    }
    const float old = own[axis * VOLUME];
    const float slope = next - here;
    const float moved = old + sigma * slope;
    kept[axis] = fixed[axis] ? old : 0.0f;
    q[axis] = fixed[axis] ? 0.0f : moved;
  }
  float scale = 1.0f;
  if (isotropic) {
    const float radius_squared = fmax(lambda * lambda - squared(kept), 0.0f), length_squared = squared(q);
    if (length_squared > radius_squared) scale = sqrt(radius_squared) / sqrt(length_squared);
  }
  for (int axis = 0; axis < 3; ++axis)
    if (!fixed[axis]) own[axis * VOLUME] = isotropic ? q[axis] * scale : fmin(fmax(q[axis], -lambda), lambda);
}
