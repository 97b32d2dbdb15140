// Two libraries print to the C library's `stderr`: the convex hull library of the engine's XML
// compiler, and the Wayland client of Mesa. During a capture the variable `stderr` refers to a
// stream that stores the output of capturing threads and forwards the output of other threads. File
// descriptor 2 does not change.
//
// Only glibc supports assigning `stderr` and streams with custom write functions. Other C libraries
// print the text.
#define _GNU_SOURCE
#include "stderr.h"

#include <stdio.h>
#include <string.h>

#include "compiler.h"

static MUJOCO_SYS_THREAD_LOCAL char text[4096];
static MUJOCO_SYS_THREAD_LOCAL size_t length;
static MUJOCO_SYS_THREAD_LOCAL unsigned depth;

#if defined(__GLIBC__)
#include <pthread.h>
#include <sys/types.h>

// True for a thread that has printed a message of the convex hull library during a capture of
// another thread. Newer compilers process meshes in several threads, which end with the
// compilation.
static _Thread_local int is_hull_thread;

static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
static unsigned captures;
static FILE* original;
// Never closed: a thread may still hold the pointer after the last capture.
static FILE* stream;

static ssize_t store_or_forward(void* cookie, const char* bytes, size_t count) {
  (void)cookie;
  if (depth == 0 && count >= 2 && memcmp(bytes, "QH", 2) == 0) is_hull_thread = 1;
  if (depth == 0 && is_hull_thread) return (ssize_t)count;
  if (depth == 0) return (ssize_t)fwrite(bytes, 1, count, __atomic_load_n(&original, __ATOMIC_ACQUIRE));
  const size_t room = sizeof(text) - 1 - length;
  const size_t kept = count < room ? count : room;
  memcpy(text + length, bytes, kept);
  length += kept;
  return (ssize_t)count;
}

static void replace_stream(void) {
  pthread_mutex_lock(&mutex);
  if (!stream) {
    const cookie_io_functions_t functions = {.write = store_or_forward};
    stream = fopencookie(NULL, "w", functions);
    if (stream) setvbuf(stream, NULL, _IONBF, 0);
  }
  if (captures++ == 0 && stream) {
    __atomic_store_n(&original, stderr, __ATOMIC_RELEASE);
    __atomic_store_n(&stderr, stream, __ATOMIC_RELEASE);
  }
  pthread_mutex_unlock(&mutex);
}

static void restore_stream(void) {
  pthread_mutex_lock(&mutex);
  if (--captures == 0 && stream) __atomic_store_n(&stderr, original, __ATOMIC_RELEASE);
  pthread_mutex_unlock(&mutex);
}
#else
static void replace_stream(void) {}
static void restore_stream(void) {}
#endif

size_t mujoco_sys_capture_begin(void) {
  if (depth == 0) length = 0;
  replace_stream();
  depth++;
  return length;
}

const char* mujoco_sys_capture_end(size_t mark) {
  depth--;
  restore_stream();
  text[length] = '\0';
  length = mark;
  return text + mark;
}
