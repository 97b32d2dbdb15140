// Batch of simulations in C. Each simulation is a row with its state. The threads take the rows in
// chunks, copy each into their mjData, call mj_step, and copy the new state back.
#include "engine.h"

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Number of chunks per thread, as in a batch of the library.
#define CHUNKS_PER_THREAD 8

struct shared {
  double* rows;
  int count, calls, width, chunk;
  // First row that no thread has taken, for each call.
  atomic_int* next;
  pthread_barrier_t barrier;
  double begin;
};

struct thread {
  struct shared* shared;
  int index;
  mjData* d;
};

// Calls `copy` for each array of the state of which a step reads the old value.
static int for_each_array(mjData* d, double* row, void (*copy)(double* array, double* part, int count)) {
  double* arrays[] = {&d->time, d->qpos, d->qvel, d->act, d->qacc_warmstart, d->ctrl, d->qfrc_applied,
                      d->xfrc_applied, d->mocap_pos, d->mocap_quat, d->userdata};
  const int sizes[] = {1, m->nq, m->nv, m->na, m->nv, m->nu, m->nv,
                       6 * m->nbody, 3 * m->nmocap, 4 * m->nmocap, m->nuserdata};
  int width = 0;
  for (size_t i = 0; i < sizeof(sizes) / sizeof(*sizes); i++) {
    if (copy && sizes[i] > 0) {
      copy(arrays[i], row + width, sizes[i]);
    }
    width += sizes[i];
  }
  return width;
}

static void load(double* array, double* part, int count) { memcpy(array, part, sizeof(double) * count); }

static void store(double* array, double* part, int count) { memcpy(part, array, sizeof(double) * count); }

static void* simulate(void* argument) {
  const struct thread* thread = argument;
  struct shared* shared = thread->shared;
  mjData* d = thread->d;
  pin_to(thread->index);
  for (int call = 0; call <= shared->calls; call++) {
    // All threads have completed the previous call.
    pthread_barrier_wait(&shared->barrier);
    if (call == 1 && thread->index == 0) {
      shared->begin = now();
    }
    int first;
    while ((first = atomic_fetch_add(&shared->next[call], shared->chunk)) < shared->count) {
      for (int i = first; i < first + shared->chunk && i < shared->count; i++) {
        double* row = shared->rows + (size_t)i * shared->width;
        for_each_array(d, row, load);
        memcpy(d->ctrl, controls + ((size_t)call * shared->count + i) * m->nu, sizeof(double) * m->nu);
        mj_step(m, d);
        for_each_array(d, row, store);
      }
    }
  }
  pthread_barrier_wait(&shared->barrier);
  return NULL;
}

void batch(mjData** d, int count, int calls, int threads) {
  struct shared shared = {.count = count, .calls = calls, .width = for_each_array(d[0], NULL, NULL)};
  const int chunks = CHUNKS_PER_THREAD * threads;
  shared.chunk = (count + chunks - 1) / chunks;
  shared.rows = check(malloc(sizeof(double) * count * shared.width));
  shared.next = check(calloc(calls + 1, sizeof(atomic_int)));
  generate_controls(count * (calls + 1));
  start(d[0]);
  for (int i = 0; i < count; i++) {
    for_each_array(d[0], shared.rows + (size_t)i * shared.width, store);
  }
  pthread_barrier_init(&shared.barrier, NULL, threads);
  struct thread work[MAX_THREADS];
  pthread_t ids[MAX_THREADS];
  for (int t = 0; t < threads; t++) {
    if (!d[t]) {
      d[t] = check(mj_makeData(m));
    }
    start(d[t]);
    work[t] = (struct thread){&shared, t, d[t]};
  }
  for (int t = 1; t < threads; t++) {
    pthread_create(&ids[t], NULL, simulate, &work[t]);
  }
  simulate(&work[0]);
  const double seconds = now() - shared.begin;
  for (int t = 1; t < threads; t++) {
    pthread_join(ids[t], NULL);
  }
  printf("%.9e %.17e\n", seconds, sum(shared.rows + (size_t)(count - 1) * shared.width + 1, m->nq));
  pthread_barrier_destroy(&shared.barrier);
  free(shared.next);
  free(shared.rows);
}
