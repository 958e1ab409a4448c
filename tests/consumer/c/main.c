/* Reconstructs a sphere from C arrays through the installed package alone, and checks what comes back. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "soapfilm/soapfilm.h"

struct row { /* a table of a caller: more than we need, float beside double */
  double position[3];
  int other;
  float normal[3];
  unsigned char color[3];
  float height;
};

static int failed(const char* what) {
  printf("failed: %s\n", what);
  return 1;
}

struct watch {
  soapfilm_context* context;
  int stages, cancels;
};

static void on_event(void* user, soapfilm_event event, double fraction, const char* text) {
  struct watch* watch = user;
  (void)fraction;
  if (event != SOAPFILM_STAGE) return;
  ++watch->stages;
  if (watch->cancels && strcmp(text, "solve") == 0) soapfilm_cancel(watch->context);
}

/* The streaming hook: scans with poses, a run after each; the last one is that of all scans at once. */
static int scans_as_they_come(soapfilm_context* context, soapfilm_samples half) {
  const double turned[16] = {0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, as_is[16] = {1, 0, 0, 0, 0, 1, 0, 0,
                                                                                          0, 0, 1, 0, 0, 0, 0, 1};
  const double stretched[16] = {2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  const char* coarse = "{\"place\": {\"resolution\": 32}}";
  soapfilm_cloud *growing = soapfilm_cloud_create(), *whole = soapfilm_cloud_create();
  soapfilm_result *early = NULL, *last = NULL, *at_once = NULL;
  half.column_count = 0;
  half.pose = as_is;
  if (soapfilm_cloud_append(context, growing, &half) || soapfilm_reconstruct(context, growing, coarse, &early))
    return failed(soapfilm_error(context));
  half.pose = stretched;
  if (soapfilm_cloud_append(context, growing, &half) != SOAPFILM_REFUSED) return failed("a pose that stretches");
  half.pose = turned;
  if (soapfilm_cloud_append(context, growing, &half) || soapfilm_reconstruct(context, growing, coarse, &last))
    return failed(soapfilm_error(context));
  half.pose = as_is;
  if (soapfilm_cloud_append(context, whole, &half)) return failed(soapfilm_error(context));
  half.pose = turned;
  if (soapfilm_cloud_append(context, whole, &half) || soapfilm_reconstruct(context, whole, coarse, &at_once))
    return failed(soapfilm_error(context));
  if (soapfilm_vertex_count(last) != soapfilm_vertex_count(at_once) ||
      soapfilm_vertex_count(last) == soapfilm_vertex_count(early) ||
      memcmp(soapfilm_vertices(last), soapfilm_vertices(at_once), 24 * soapfilm_vertex_count(last)) != 0)
    return failed("scans one after the other gave another mesh");
  soapfilm_result_destroy(early);
  soapfilm_result_destroy(last);
  soapfilm_result_destroy(at_once);
  soapfilm_cloud_destroy(growing);
  soapfilm_cloud_destroy(whole);
  return 0;
}

/* A tenth of the triangles, of a result and of arrays alike. */
static int simplified(soapfilm_context* context, const soapfilm_result* result) {
  soapfilm_result *small = NULL, *given = NULL, *again = NULL, *few = NULL;
  const size_t triangles = soapfilm_triangle_count(result), vertices = soapfilm_vertex_count(result);
  if (soapfilm_simplify(context, result, 0.005, 0, &small)) return failed(soapfilm_error(context));
  if (soapfilm_triangle_count(small) > triangles / 4 || !soapfilm_attribute(small, "height"))
    return failed("a simplified mesh");
  if (!strstr(soapfilm_report(small), "\"proved\": 0.00")) return failed("what was proved");
  if (soapfilm_mesh_create(context, soapfilm_vertices(result), vertices, soapfilm_triangles(result), triangles,
                           &given) ||
      soapfilm_simplify(context, given, 0.005, 0, &again) || soapfilm_simplify(context, given, 0, 100, &few))
    return failed(soapfilm_error(context));
  if (soapfilm_triangle_count(again) != soapfilm_triangle_count(small) ||
      memcmp(soapfilm_vertices(again), soapfilm_vertices(small), 24 * soapfilm_vertex_count(small)) != 0)
    return failed("arrays gave another simplified mesh");
  if (soapfilm_triangle_count(few) > 100) return failed("a number of triangles");
  soapfilm_result_destroy(few);
  if (soapfilm_simplify(context, given, -1, 0, &few) != SOAPFILM_REFUSED || few) return failed("a bad tolerance");
  if (soapfilm_mesh_create(context, soapfilm_vertices(result), vertices - 1, soapfilm_triangles(result), triangles,
                           &few) != SOAPFILM_REFUSED || few)
    return failed("an index out of range");
  soapfilm_result_destroy(small);
  soapfilm_result_destroy(given);
  soapfilm_result_destroy(again);
  return 0;
}

int main(void) {
  enum { count = 6000 };
  struct row* rows = calloc(count, sizeof *rows);
  const double golden = 2.399963229728653;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2.0 * i + 1) / count, r = sqrt(1 - z * z);
    const double at[3] = {r * cos(golden * i), r * sin(golden * i), z};
    for (int k = 0; k < 3; ++k) {
      rows[i].position[k] = 5 + 2 * at[k];
      rows[i].normal[k] = (float)at[k];
      rows[i].color[k] = (unsigned char)(100 + 50 * k);
    }
    rows[i].height = (float)at[2];
  }
  soapfilm_samples samples = {0};
  samples.count = count;
  samples.position.data = rows[0].position;
  samples.position.type = SOAPFILM_FLOAT64;
  samples.position.stride = sizeof *rows;
  samples.normal.data = rows[0].normal;
  samples.normal.type = SOAPFILM_FLOAT32;
  samples.normal.stride = sizeof *rows;
  samples.color.data = rows[0].color;
  samples.color.type = SOAPFILM_UINT8;
  samples.color.stride = sizeof *rows;
  soapfilm_column height = {"height", {&rows[0].height, SOAPFILM_FLOAT32, sizeof *rows}, 0};
  samples.columns = &height;
  samples.column_count = 1;

  soapfilm_context* context = soapfilm_context_create(2);
  soapfilm_cloud* cloud = soapfilm_cloud_create();
  soapfilm_result *result = NULL, *again = NULL;
  struct watch watch = {context, 0, 0};
  soapfilm_on_event(context, on_event, &watch);

  if (soapfilm_cloud_append(context, cloud, &samples)) return failed(soapfilm_error(context));
  if (scans_as_they_come(context, samples)) return 1;
  samples.column_count = 2;
  const soapfilm_column twice[2] = {height, height};
  samples.columns = twice;
  if (soapfilm_cloud_append(context, cloud, &samples) != SOAPFILM_REFUSED) return failed("a column given twice");
  free(rows);
  if (soapfilm_cloud_size(cloud) != count) return failed("the cloud's size");
  const char* parameters =
      "{\"place\": {\"resolution\": 64}, \"orient\": {\"up\": \"-y\"},"
      " \"surface\": {\"distance\": true, \"attributes\": [\"all\"]}}";
  if (soapfilm_reconstruct(context, cloud, parameters, &result))
    return failed(soapfilm_error(context));
  if (watch.stages < 8) return failed("stages were not told");

  /* A closed surface of genus 0, on the sphere. */
  const size_t vertices = soapfilm_vertex_count(result), triangles = soapfilm_triangle_count(result);
  if (triangles < 5000 || 2 * vertices != triangles + 4) return failed("the mesh is no closed surface of genus 0");
  const double* at = soapfilm_vertices(result);
  const float* distance = soapfilm_attribute(result, "distance");
  const float* heights = soapfilm_attribute(result, "height");
  const uint8_t* color = soapfilm_colors(result);
  if (!distance || !heights || !color || soapfilm_attribute(result, "no such")) return failed("attributes");
  if (!soapfilm_attribute_name(result, 1) || soapfilm_attribute_name(result, 2)) return failed("attribute names");
  for (size_t v = 0; v < vertices; ++v) {
    const double x = at[3 * v] - 5, y = at[3 * v + 1] - 5, z = at[3 * v + 2] - 5;
    if (fabs(sqrt(x * x + y * y + z * z) - 2) > 0.02) return failed("a vertex lies off the sphere");
    if (fabs(heights[v] - z / 2) > 0.05) return failed("a vertex' height");
    if (color[3 * v] != 100 || color[3 * v + 1] != 150 || color[3 * v + 2] != 200) return failed("a vertex' color");
    if (!(distance[v] >= 0 && distance[v] < 0.2f)) return failed("a vertex' distance");
  }
  const uint32_t* corner = soapfilm_triangles(result);
  for (size_t i = 0; i < 3 * triangles; ++i)
    if (corner[i] >= vertices) return failed("an index");

  /* The report has a proof, and as parameters it gives the same bytes. */
  if (!strstr(soapfilm_report(result), "\"certificate\"")) return failed("no certificate");
  if (!strstr(soapfilm_report(result), "\"up\": \"-y\"")) return failed("where up is, was not taken");
  if (soapfilm_reconstruct(context, cloud, soapfilm_report(result), &again)) return failed(soapfilm_error(context));
  if (soapfilm_vertex_count(again) != vertices ||
      memcmp(soapfilm_vertices(again), at, 3 * vertices * sizeof *at) != 0 ||
      memcmp(soapfilm_triangles(again), corner, 3 * triangles * sizeof *corner) != 0)
    return failed("the report gave another mesh");
  soapfilm_result_destroy(again);

  if (simplified(context, result)) return 1;

  /* Refusals are a status and a line; a cancelled run does not spoil the next one. */
  if (soapfilm_reconstruct(context, cloud, "{\"place\": {\"voxel\": -1}}", &again) != SOAPFILM_REFUSED || again ||
      !strstr(soapfilm_error(context), "voxel = -1"))
    return failed("a bad voxel was not refused");
  if (soapfilm_reconstruct(context, cloud, "{\"orient\": {\"up\": \"w\"}}", &again) != SOAPFILM_REFUSED || again)
    return failed("a bad axis was not refused");
  soapfilm_limit_memory(context, 1000000);
  if (soapfilm_reconstruct(context, cloud, NULL, &again) != SOAPFILM_OUT_OF_MEMORY || again)
    return failed("a run beyond the limit of memory was not refused");
  soapfilm_limit_memory(context, 0);
  if (soapfilm_reconstruct(context, cloud, "{\"memory\": {\"limit\": 5}}", &again) != SOAPFILM_REFUSED ||
      !strstr(soapfilm_error(context), "memory.limit = 5"))
    return failed("a limit of memory among the parameters was not refused");
  if (soapfilm_cloud_read(context, cloud, "/no/such/file.ply") != SOAPFILM_UNREADABLE) return failed("an absent file");
  if (soapfilm_write_mesh(context, result, "/no/such/folder/mesh.ply") != SOAPFILM_UNWRITABLE)
    return failed("an absent folder");
  watch.cancels = 1;
  if (soapfilm_reconstruct(context, cloud, NULL, &again) != SOAPFILM_CANCELLED) return failed("it was not cancelled");
  watch.cancels = 0;
  if (soapfilm_reconstruct(context, cloud, NULL, &again)) return failed(soapfilm_error(context));
  soapfilm_result_destroy(again);

  soapfilm_result_destroy(result);
  soapfilm_cloud_destroy(cloud);
  soapfilm_context_destroy(context);
  printf("soapfilm %s\n", soapfilm_version());
  return 0;
}
