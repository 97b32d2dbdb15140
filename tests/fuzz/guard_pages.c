// Library to preload that places each array of a model or a simulation at the end of its own pages,
// between pages without access. An access of the engine beyond an array is then a crash instead of
// a read or write of the next array. With GUARD_PAGES=start the arrays are at the start of their
// pages, which finds accesses before an array. The arrays in the arena (contacts, constraints) stay
// where they are.

#define _GNU_SOURCE
#include <dlfcn.h>
#include <pthread.h>
#include <signal.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <ucontext.h>
#include <unistd.h>

#include <mujoco/mjxmacro.h>
#include <mujoco/mujoco.h>

#define PAGE 4096UL
#define MOST_ARRAYS_OF_ONE 1500
// Arrays of all objects. Each takes two of the 65530 mappings of a process; objects beyond the
// limit have no guard pages.
#define MOST_ARRAYS 28000

typedef struct {
  void** pointer;  // pointer of the engine's struct
  void* original;  // its value in the engine's buffer
  char* start;
  size_t size;
  const char* name;
} Array;

// Pages of a model or a simulation.
typedef struct {
  void* owner;
  char* start;
  size_t size;
  Array* arrays;
  int count;
} Pages;

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static Pages* all;
static int count, capacity;

static void print(const char* text) {
  if (write(STDERR_FILENO, text, strlen(text)) < 0) {
    _exit(1);
  }
}

static void print_number(long number) {
  char digits[24];
  char* at = digits + sizeof digits - 1;
  *at = 0;
  for (unsigned long rest = labs(number); rest || !*at; rest /= 10) {
    *--at = (char)('0' + rest % 10);
  }
  print(number < 0 ? "-" : "");
  print(at);
}

// Names the array next to the address, and the function.
static void report(int signal_number, siginfo_t* info, void* context) {
  (void)signal_number, (void)context;
  const char* address = info->si_addr;
  for (const Pages* pages = all; pages < all + count; pages++) {
    if (address < pages->start || address >= pages->start + pages->size) {
      continue;
    }
    const Array* nearest = pages->arrays;
    size_t least = SIZE_MAX;
    for (const Array* array = pages->arrays; array < pages->arrays + pages->count; array++) {
      const char* end = array->start + array->size;
      const size_t distance = address < array->start ? (size_t)(array->start - address) : (size_t)(address - end);
      if (distance < least) {
        nearest = array;
        least = distance;
      }
    }
    print("guard page: byte ");
    print_number(address - nearest->start);
    print(" of the array ");
    print(nearest->name);
    print(", which has ");
    print_number((long)nearest->size);
    print("\n");
#ifdef __x86_64__
    Dl_info function;
    if (dladdr((void*)((const ucontext_t*)context)->uc_mcontext.gregs[REG_RIP], &function) && function.dli_sname) {
      print("  in or after ");
      print(function.dli_sname);
      print("\n");
    }
#endif
  }
  signal(SIGSEGV, SIG_DFL);
}

// Removes the pages of an object from the list. The address of the object may be that of another
// one as soon as the engine has freed it.
static Pages taken(const void* owner) {
  Pages pages = {0};
  pthread_mutex_lock(&lock);
  for (int i = 0; i < count; i++) {
    if (all[i].owner == owner) {
      pages = all[i];
      all[i] = all[--count];
      break;
    }
  }
  pthread_mutex_unlock(&lock);
  return pages;
}

static void release(Pages pages) {
  if (pages.start) {
    munmap(pages.start, pages.size);
    free(pages.arrays);
  }
}

// Moves the arrays of an object back to the engine's buffer, which a copy to the object uses. The
// pages of an object that the engine has freed by itself are those of another object.
static void restore(void* owner) {
  const Pages pages = taken(owner);
  for (const Array* array = pages.arrays; array < pages.arrays + pages.count; array++) {
    if (*array->pointer == array->start) {
      memcpy(array->original, array->start, array->size);
      *array->pointer = array->original;
    }
  }
  release(pages);
}

static size_t whole_pages(size_t size) { return (size + PAGE - 1) / PAGE * PAGE; }

// Moves the arrays of an object to new pages.
static void move(void* owner, const Array* arrays, int number) {
  int used = 0;
  pthread_mutex_lock(&lock);
  for (int i = 0; i < count; i++) {
    used += all[i].count;
  }
  if (!capacity) {
    const struct sigaction action = {.sa_sigaction = report, .sa_flags = SA_SIGINFO | SA_ONSTACK};
    sigaction(SIGSEGV, &action, NULL);
  }
  pthread_mutex_unlock(&lock);

  Pages pages = {.owner = owner, .size = PAGE, .arrays = malloc(sizeof(Array) * (size_t)number)};
  for (int i = 0; i < number; i++) {
    if (arrays[i].size) {
      pages.arrays[pages.count++] = arrays[i];
      pages.size += whole_pages(arrays[i].size) + PAGE;
    }
  }
  const int flags = MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE;
  pages.start = used + pages.count > MOST_ARRAYS ? MAP_FAILED : mmap(NULL, pages.size, PROT_NONE, flags, -1, 0);
  if (pages.start == MAP_FAILED) {
    free(pages.arrays);
    return;
  }
  const char* mode = getenv("GUARD_PAGES");
  const int at_start = mode && !strcmp(mode, "start");
  char* at = pages.start + PAGE;
  for (Array* array = pages.arrays; array < pages.arrays + pages.count; array++) {
    const size_t size = whole_pages(array->size);
    if (mprotect(at, size, PROT_READ | PROT_WRITE)) {
      print("guard pages: the process has too many mappings\n");
      _exit(1);
    }
    array->start = at_start ? at : at + size - array->size;
    array->original = *array->pointer;
    memcpy(array->start, array->original, array->size);
    *array->pointer = array->start;
    at += size + PAGE;
  }

  pthread_mutex_lock(&lock);
  if (count == capacity) {
    capacity = capacity ? 2 * capacity : 64;
    all = realloc(all, sizeof(Pages) * (size_t)capacity);
  }
  all[count++] = pages;
  pthread_mutex_unlock(&lock);
}

// The sizes in the lists of arrays are names of variables or, in newer engines, arguments of these
// macros.
#undef MJ_M
#define MJ_M(n) n
#define X(type, field, rows, columns) \
  arrays[number++] = (Array){(void**)&m->field, NULL, NULL, sizeof(type) * (size_t)(m->rows) * (size_t)(columns), #field};

static mjModel* guarded_model(mjModel* m) {
  Array arrays[MOST_ARRAYS_OF_ONE];
  int number = 0;
  if (m) {
    restore(m);
    MJMODEL_POINTERS_PREAMBLE(m)
    (void)nq, (void)nv, (void)na, (void)nu, (void)nmocap;
    MJMODEL_POINTERS
    move(m, arrays, number);
  }
  return m;
}

#undef X
#define X(type, field, rows, columns) \
  arrays[number++] = (Array){(void**)&d->field, NULL, NULL, sizeof(type) * (size_t)(m->rows) * (size_t)(columns), #field};
#if mjVERSION_HEADER >= 300
#undef MJ_M
#define MJ_M(n) (m->n)
#endif

static mjData* guarded_data(const mjModel* m, mjData* d) {
  Array arrays[MOST_ARRAYS_OF_ONE];
  int number = 0;
  if (d) {
    restore(d);
#if mjVERSION_HEADER < 300
    const int nv = m->nv, njmax = m->njmax, nconmax = m->nconmax;
    (void)nconmax;
#endif
    MJDATA_POINTERS
    move(d, arrays, number);
  }
  return d;
}

// The function of the engine that a function of this library replaces.
#define ENGINE(function)                            \
  static __typeof__(&function) engine;              \
  if (!engine) {                                    \
    *(void**)&engine = dlsym(RTLD_NEXT, #function); \
  }

mjModel* mj_loadXML(const char* filename, const mjVFS* vfs, char* error, int error_sz) {
  ENGINE(mj_loadXML)
  return guarded_model(engine(filename, vfs, error, error_sz));
}

mjModel* mj_loadModel(const char* filename, const mjVFS* vfs) {
  ENGINE(mj_loadModel)
  return guarded_model(engine(filename, vfs));
}

#if mjVERSION_HEADER >= 3005000
#if mjVERSION_HEADER == 3005000
#define mjtSize int
#endif
mjModel* mj_loadModelBuffer(const void* buffer, mjtSize buffer_sz) {
  ENGINE(mj_loadModelBuffer)
  return guarded_model(engine(buffer, buffer_sz));
}
#endif

#if mjVERSION_HEADER >= 320
mjModel* mj_compile(mjSpec* s, const mjVFS* vfs) {
  ENGINE(mj_compile)
  return guarded_model(engine(s, vfs));
}
#endif

mjModel* mj_copyModel(mjModel* dest, const mjModel* src) {
  ENGINE(mj_copyModel)
  if (dest) {
    restore(dest);
  }
  return guarded_model(engine(dest, src));
}

mjData* mj_makeData(const mjModel* m) {
  ENGINE(mj_makeData)
  return guarded_data(m, engine(m));
}

mjData* mj_copyData(mjData* dest, const mjModel* m, const mjData* src) {
  ENGINE(mj_copyData)
  if (dest) {
    restore(dest);
  }
  return guarded_data(m, engine(dest, m, src));
}

void mj_deleteData(mjData* d) {
  ENGINE(mj_deleteData)
  const Pages pages = taken(d);
  engine(d);
  release(pages);
}

void mj_deleteModel(mjModel* m) {
  ENGINE(mj_deleteModel)
  const Pages pages = taken(m);
  engine(m);
  release(pages);
}
