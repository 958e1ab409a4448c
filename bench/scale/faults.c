// Preloaded into a program (LD_PRELOAD): one of its calls on files of a folder fails, as on a disk that is broken or
// full. failures.py compiles it and sets FAULT_UNDER (the folder), FAULT_CALL, FAULT_AT (which of these calls, from 1;
// 0: none), FAULT_ERROR (errno), FAULT_STAYS (1: all later ones fail, too) and FAULT_LOG (a file that gets the name of
// each call and the number of its process). Only soapfilm's own files count, not those of Open MPI. In the folder
// FAULT_NAMED no file can be without a name, as on a network's file system. FAULT_RATE: so many bytes a second each
// process can write to the files of FAULT_UNDER.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

static const char* setting(const char* name) {
  const char* value = getenv(name);
  return value ? value : "";
}

static void log_call(const char* call) {
  static atomic_int file;
  if (file == 0 && setting("FAULT_LOG")[0])
    file = (int)syscall(SYS_openat, AT_FDCWD, setting("FAULT_LOG"), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  char line[64];
  const int length = snprintf(line, sizeof line, "%s %d\n", call, (int)getpid());
  if (file > 0) syscall(SYS_write, file, line, length);
}

/// Whether this call is the one to fail; errno is set then.
static int fails(const char* call, const char* path) {
  static atomic_int done;
  const char* under = setting("FAULT_UNDER");
  if (!under[0] || !path || strncmp(path, under, strlen(under)) != 0) return 0;
  if (strncmp(program_invocation_short_name, "soapfilm", 8) != 0 || strstr(path, "/ompi.")) return 0;
  log_call(call);
  if (strcmp(call, setting("FAULT_CALL")) != 0) return 0;
  const int at = atoi(setting("FAULT_AT")), now = ++done;
  if (at == 0 || now < at || (now > at && !atoi(setting("FAULT_STAYS")))) return 0;
  errno = atoi(setting("FAULT_ERROR"));
  return 1;
}

/// The path of an open file; null if it has none.
static const char* path_of(int file, char path[PATH_MAX]) {
  char link[64];
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  const ssize_t length = syscall(SYS_readlink, link, path, PATH_MAX - 1);
  if (length < 0) return NULL;
  path[length] = 0;
  return path;
}

/// The same for the file that is open as `file`.
static int fails_on(const char* call, int file) {
  char path[PATH_MAX];
  if (file <= STDERR_FILENO) return 0;  // what is said is not a file of the run
  return fails(call, path_of(file, path));
}

/// The same of a write of `count` bytes, which takes its time.
static int fails_to_write(int file, size_t count) {
  char path[PATH_MAX];
  const char *under = setting("FAULT_UNDER"), *rate = setting("FAULT_RATE");
  if (rate[0] && under[0] && file > STDERR_FILENO && path_of(file, path) && !strncmp(path, under, strlen(under)))
    usleep((useconds_t)(1e6 * (double)count / atof(rate)));
  return fails_on("write", file);
}

/// Whether the call would open a file without a name where there are none; errno is set then.
static int needs_name(const char* path, int flags) {
  const char* folder = setting("FAULT_NAMED");
  if ((flags & O_TMPFILE) != O_TMPFILE || !folder[0] || strcmp(path, folder) != 0) return 0;
  errno = EOPNOTSUPP;
  return 1;
}

/// A function that fails with `failure` where `condition` holds, and else does what it does.
#define MAY_FAIL(type, name, parameters, arguments, condition, failure)            \
  type name parameters {                                                           \
    static type(*next) parameters;                                                 \
    if (!next) next = (type(*) parameters)dlsym(RTLD_NEXT, #name);                 \
    return (condition) ? (failure) : next arguments;                               \
  }

#define MAY_FAIL_TO_OPEN(name)                                                            \
  int name(const char* path, int flags, ...) {                                            \
    static int (*next)(const char*, int, ...);                                            \
    if (!next) next = (int (*)(const char*, int, ...))dlsym(RTLD_NEXT, #name);            \
    va_list rest;                                                                         \
    va_start(rest, flags);                                                                \
    const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) ? va_arg(rest, mode_t) : 0;       \
    va_end(rest);                                                                         \
    return needs_name(path, flags) || fails("open", path) ? -1 : next(path, flags, mode); \
  }

MAY_FAIL_TO_OPEN(open)
MAY_FAIL_TO_OPEN(open64)
MAY_FAIL(FILE*, fopen, (const char* path, const char* mode), (path, mode), fails("open", path), NULL)
MAY_FAIL(FILE*, fopen64, (const char* path, const char* mode), (path, mode), fails("open", path), NULL)
MAY_FAIL(ssize_t, read, (int file, void* to, size_t count), (file, to, count), fails_on("read", file), -1)
MAY_FAIL(ssize_t, write, (int file, const void* from, size_t count), (file, from, count), fails_to_write(file, count),
         -1)
MAY_FAIL(ssize_t, pwrite, (int file, const void* from, size_t count, off_t at), (file, from, count, at),
         fails_to_write(file, count), -1)
MAY_FAIL(ssize_t, pwrite64, (int file, const void* from, size_t count, off64_t at), (file, from, count, at),
         fails_to_write(file, count), -1)
MAY_FAIL(ssize_t, writev, (int file, const struct iovec* from, int count), (file, from, count),
         fails_on("write", file), -1)
MAY_FAIL(int, fsync, (int file), (file), fails_on("fsync", file), -1)
MAY_FAIL(int, sync_file_range, (int file, off64_t at, off64_t count, unsigned flags), (file, at, count, flags),
         fails_on("sync_file_range", file), -1)
MAY_FAIL(int, fallocate, (int file, int mode, off_t at, off_t count), (file, mode, at, count),
         fails_on("fallocate", file), -1)
MAY_FAIL(int, fallocate64, (int file, int mode, off64_t at, off64_t count), (file, mode, at, count),
         fails_on("fallocate", file), -1)
MAY_FAIL(int, posix_fallocate, (int file, off_t at, off_t count), (file, at, count), fails_on("reserve", file), errno)
MAY_FAIL(int, posix_fallocate64, (int file, off64_t at, off64_t count), (file, at, count), fails_on("reserve", file),
         errno)
MAY_FAIL(int, rename, (const char* from, const char* to), (from, to), fails("rename", to), -1)
MAY_FAIL(int, linkat, (int at, const char* from, int to_at, const char* to, int flags), (at, from, to_at, to, flags),
         fails("link", to), -1)
MAY_FAIL(void*, mmap, (void* at, size_t size, int how, int flags, int file, off_t from),
         (at, size, how, flags, file, from), fails_on("mmap", file), MAP_FAILED)
MAY_FAIL(void*, mmap64, (void* at, size_t size, int how, int flags, int file, off64_t from),
         (at, size, how, flags, file, from), fails_on("mmap", file), MAP_FAILED)
