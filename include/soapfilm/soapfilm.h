/* Soapfilm in C: reconstruct a watertight surface from arrays of samples, or from files, with a proof of its energy.
 * For bindings of other languages. Everything that the program can do is available through parameters and report, both
 * JSON (keys: docs/reference/report.md).
 *
 *   soapfilm_context* context = soapfilm_context_create(0);
 *   soapfilm_cloud* cloud = soapfilm_cloud_create();
 *   soapfilm_result* result = NULL;
 *   if (soapfilm_cloud_read(context, cloud, "scans.conf") ||
 *       soapfilm_reconstruct(context, cloud, "{\"place\": {\"voxel\": 0.002}}", &result) ||
 *       soapfilm_write_mesh(context, result, "mesh.ply"))
 *     fprintf(stderr, "%s\n", soapfilm_error(context));
 *
 * Only one thread at a time may use a context, except for soapfilm_cancel(); different threads may use different
 * contexts at once. Strings are UTF-8; returned ones belong to their object, valid until it changes or is freed. */
#ifndef SOAPFILM_SOAPFILM_H
#define SOAPFILM_SOAPFILM_H

#include <stddef.h>
#include <stdint.h>

#include "soapfilm/export.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct soapfilm_context soapfilm_context; /* each is destroyed by its own function; null is allowed */
typedef struct soapfilm_cloud soapfilm_cloud;
typedef struct soapfilm_result soapfilm_result;

typedef enum soapfilm_status {
  SOAPFILM_OK = 0,
  SOAPFILM_REFUSED = 1,       /* a value that the caller gave: a parameter, an array, samples without a volume */
  SOAPFILM_UNREADABLE = 2,    /* an input file or its contents */
  SOAPFILM_UNWRITABLE = 3,    /* an output file */
  SOAPFILM_OUT_OF_MEMORY = 4, /* more than the limit or than is free; nothing large was allocated */
  SOAPFILM_EMPTY = 5,         /* the optimum is the empty surface */
  SOAPFILM_CANCELLED = 6,
  SOAPFILM_FAILED = 7 /* a fault of the library */
} soapfilm_status;

SOAPFILM_API const char* soapfilm_version(void); /* such as "0.1.0" */

/* `threads` >= 1, or 0 for all that the process may use. Null if out of memory. */
SOAPFILM_API soapfilm_context* soapfilm_context_create(int threads);
SOAPFILM_API void soapfilm_context_destroy(soapfilm_context* context);
/* One line about the last call with this context that did not return SOAPFILM_OK; "" before. */
SOAPFILM_API const char* soapfilm_error(const soapfilm_context* context);
/* Stops the running call within milliseconds, or else the next one. From any thread or a signal handler. */
SOAPFILM_API void soapfilm_cancel(soapfilm_context* context);

/* Bytes that the process may take in a run with this context; 0: what the machine has free. Between runs. */
SOAPFILM_API void soapfilm_limit_memory(soapfilm_context* context, size_t bytes);
/* Folder for temporary files, and for arrays of runs larger than memory; null or "": $TMPDIR, else /tmp, and none. */
SOAPFILM_API void soapfilm_set_scratch_folder(soapfilm_context* context, const char* folder);

typedef enum soapfilm_event {
  SOAPFILM_STAGE = 0,   /* a stage begins; text: its name */
  SOAPFILM_ADVANCE = 1, /* fraction of the stage in [0, 1]; text: a short detail */
  SOAPFILM_INFO = 2,    /* text: a line */
  SOAPFILM_WARNING = 3  /* text: a line that should be shown; also in the report */
} soapfilm_event;

/* `callback` gets each event, on the calling thread; null: none. It must not throw. */
SOAPFILM_API void soapfilm_on_event(soapfilm_context* context,
                                    void (*callback)(void* user, soapfilm_event event, double fraction,
                                                     const char* text),
                                    void* user);

SOAPFILM_API soapfilm_cloud* soapfilm_cloud_create(void); /* empty; null if out of memory */
SOAPFILM_API void soapfilm_cloud_destroy(soapfilm_cloud* cloud);
SOAPFILM_API size_t soapfilm_cloud_size(const soapfilm_cloud* cloud); /* samples */

typedef enum soapfilm_type { SOAPFILM_FLOAT32 = 0, SOAPFILM_FLOAT64 = 1, SOAPFILM_UINT8 = 2 } soapfilm_type;

/* A column of a table anywhere in memory: row i begins at (char*)data + i * stride. */
typedef struct soapfilm_array {
  const void* data; /* null: there is no such column */
  soapfilm_type type;
  ptrdiff_t stride; /* bytes; 0: rows without gaps */
} soapfilm_array;

/* A value of each sample, carried to the vertices by {"surface": {"attributes": ["all"]}} or its name there. */
typedef struct soapfilm_column {
  const char* name;
  soapfilm_array values; /* 1 per row; not-a-number: none */
  int is_label;          /* 1: of several samples the most frequent value counts; 0: their mean */
} soapfilm_column;

/* A scan: samples that belong together. Set absent fields to zero: soapfilm_samples s = {0}. */
typedef struct soapfilm_samples {
  size_t count;
  soapfilm_array position; /* 3 values per row, input units, finite */
  soapfilm_array normal;   /* 3, outward, any length; zero or not finite: none */
  soapfilm_array sensor;   /* 3: scanner position of this sample; not finite: unknown */
  soapfilm_array weight;   /* 1, >= 0 */
  soapfilm_array color;    /* 3, SOAPFILM_UINT8 */
  const double* scanner;   /* 3 values: scanner position of the whole scan; null: unknown */
  const double* pose;      /* 16: rows of the matrix to the cloud's frame, the scanner's place if unknown; null: none */
  const char* name;        /* of the scan; null: none */
  const soapfilm_column* columns;
  size_t column_count;
} soapfilm_samples;

/* Appends a copy of the samples as a further scan, also between runs. If it fails, the cloud is unchanged. */
SOAPFILM_API soapfilm_status soapfilm_cloud_append(soapfilm_context* context, soapfilm_cloud* cloud,
                                                   const soapfilm_samples* samples);
/* Appends the contents of a file (docs/reference/formats.md). */
SOAPFILM_API soapfilm_status soapfilm_cloud_read(soapfilm_context* context, soapfilm_cloud* cloud, const char* path);

/* Reconstructs the surface. `parameters`: JSON, such as {"place": {"voxel": 0.002}} or the whole report of an earlier
 * run; absent keys keep their defaults; null: all defaults. The same cloud and parameters give the same mesh, bit for
 * bit. *result is null if it fails. */
SOAPFILM_API soapfilm_status soapfilm_reconstruct(soapfilm_context* context, const soapfilm_cloud* cloud,
                                                  const char* parameters, soapfilm_result** result);
SOAPFILM_API void soapfilm_result_destroy(soapfilm_result* result);

/* Triangles are counter-clockwise seen from outside. Arrays are valid as long as the result. */
SOAPFILM_API size_t soapfilm_vertex_count(const soapfilm_result* result);
SOAPFILM_API const double* soapfilm_vertices(const soapfilm_result* result); /* 3 per vertex, input units */
SOAPFILM_API size_t soapfilm_triangle_count(const soapfilm_result* result);
SOAPFILM_API const uint32_t* soapfilm_triangles(const soapfilm_result* result); /* 3 indices per triangle */
SOAPFILM_API const uint8_t* soapfilm_colors(const soapfilm_result* result);     /* 3 per vertex; null: none */
/* One value per vertex, such as "distance" after {"surface": {"distance": true}}; null: no such attribute. */
SOAPFILM_API const float* soapfilm_attribute(const soapfilm_result* result, const char* name);
SOAPFILM_API const char* soapfilm_attribute_name(const soapfilm_result* result, size_t index); /* null: no more */
SOAPFILM_API const char* soapfilm_report(const soapfilm_result* result);                       /* JSON */

/* A mesh from arrays as those above, as a result without a report. */
SOAPFILM_API soapfilm_status soapfilm_mesh_create(soapfilm_context* context, const double* vertices,
                                                  size_t vertex_count, const uint32_t* triangles, size_t triangle_count,
                                                  soapfilm_result** result);
/* Fewer triangles of a closed or open 2-manifold, each mesh proved to lie within `tolerance` of the other (input
 * units); if `triangles` > 0: at most so many, whatever `tolerance`. Report: {"triangles_before", "triangles",
 * "tolerance", "proved"}. *simplified is null if it fails. */
SOAPFILM_API soapfilm_status soapfilm_simplify(soapfilm_context* context, const soapfilm_result* result,
                                               double tolerance, size_t triangles, soapfilm_result** simplified);

/* Writes the mesh, completely or not at all: .ply, .obj, .glb or .stl. */
SOAPFILM_API soapfilm_status soapfilm_write_mesh(soapfilm_context* context, const soapfilm_result* result,
                                                 const char* path);

#ifdef __cplusplus
}
#endif

#endif
