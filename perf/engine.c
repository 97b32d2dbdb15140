// Reference implementation: the engine called from C. Reads one command per line, so that it can
// run alternately with others, and answers with the elapsed seconds and a checksum of the result.
//
//   engine --version                prints the version of the engine
//   engine MODEL.xml [KEYFRAME] < commands
//   step CALLS                    mj_step under random controls, after a warm-up of CALLS / 8 steps
//   rollout COUNT STEPS THREADS   COUNT simulations of STEPS each, recording qpos and qvel
//   batch COUNT CALLS THREADS     COUNT simulations of one step per call, each a row of states; after
//                                 one warm-up call
//   transition CALLS              mjd_transitionFD of A and B by central differences, after one
//                                 warm-up call
//
// Warm-up calls are not timed, because another process may have replaced the contents of the
// caches.
#include "engine.h"

#include <sched.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

mjModel* m;
double* controls;
static cpu_set_t processors;
static int key = -1;
static int controls_generated;

double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return t.tv_sec + 1e-9 * t.tv_nsec;
}

void pin_to(int thread) {
  int left = thread % CPU_COUNT(&processors), processor = 0;
  while (!CPU_ISSET(processor, &processors) || left-- > 0) {
    processor++;
  }
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(processor, &one);
  pthread_setaffinity_np(pthread_self(), sizeof(one), &one);
}

void* check(void* p) {
  if (!p) {
    fprintf(stderr, "engine: out of memory\n");
    exit(1);
  }
  return p;
}

void generate_controls(int count) {
  if (count <= controls_generated) {
    return;
  }
  controls = check(realloc(controls, sizeof(double) * count * (m->nu ? m->nu : 1)));
  controls_generated = count;
  uint64_t x = 1;
  for (int i = 0; i < count * m->nu; i++) {
    x = x * 6364136223846793005u + 1442695040888963407u;
    const double unit = (double)(x >> 11) / 9007199254740992.0 * 2 - 1;
    const double* range = m->actuator_ctrlrange + 2 * (i % m->nu);
    const int limited = m->actuator_ctrllimited[i % m->nu];
    controls[i] = 0.1 * unit * (limited ? range[1] : 1);
  }
}

void start(mjData* d) {
  if (key >= 0) {
    mj_resetDataKeyframe(m, d, key);
  } else {
    mj_resetData(m, d);
  }
}

static void set_controls(mjData* d, int step) {
  memcpy(d->ctrl, controls + (size_t)step * m->nu, sizeof(double) * m->nu);
}

double sum(const double* values, int count) {
  double result = 0;
  for (int i = 0; i < count; i++) {
    result += values[i];
  }
  return result;
}

struct share {
  int thread, first, last, steps;
  double* states;
  mjData* d;
};

static void* simulate(void* argument) {
  struct share* share = argument;
  pin_to(share->thread);
  const int width = m->nq + m->nv;
  for (int i = share->first; i < share->last; i++) {
    start(share->d);
    for (int step = 0; step < share->steps; step++) {
      set_controls(share->d, i * share->steps + step);
      mj_step(m, share->d);
      double* state = share->states + ((size_t)i * share->steps + step) * width;
      memcpy(state, share->d->qpos, sizeof(double) * m->nq);
      memcpy(state + m->nq, share->d->qvel, sizeof(double) * m->nv);
    }
  }
  return NULL;
}

static void rollout(mjData** d, int count, int steps, int threads) {
  struct share shares[MAX_THREADS];
  pthread_t ids[MAX_THREADS];
  const size_t size = (size_t)count * steps * (m->nq + m->nv);
  double* states = check(malloc(sizeof(double) * size));
  generate_controls(count * steps);
  for (int t = 0; t < threads; t++) {
    if (!d[t]) {
      d[t] = check(mj_makeData(m));
    }
    shares[t] = (struct share){t, count * t / threads, count * (t + 1) / threads, steps, states, d[t]};
  }
  const double begin = now();
  for (int t = 1; t < threads; t++) {
    pthread_create(&ids[t], NULL, simulate, &shares[t]);
  }
  simulate(&shares[0]);
  for (int t = 1; t < threads; t++) {
    pthread_join(ids[t], NULL);
  }
  const double seconds = now() - begin;
  const size_t last = size - m->nq - m->nv;
  printf("%.9e %.17e\n", seconds, sum(states + last, m->nq));
  free(states);
}

int main(int argc, char** argv) {
  if (argc < 2) {
    fprintf(stderr, "usage: engine MODEL.xml [KEYFRAME]\n");
    return 1;
  }
  if (!strcmp(argv[1], "--version")) {
    puts(mj_versionString());
    return 0;
  }
  char error[1000] = "";
  m = mj_loadXML(argv[1], NULL, error, sizeof(error));
  if (!m) {
    fprintf(stderr, "engine: %s\n", error);
    return 1;
  }
  if (argc > 2) {
    key = mj_name2id(m, mjOBJ_KEY, argv[2]);
    if (key < 0) {
      fprintf(stderr, "engine: no keyframe %s\n", argv[2]);
      return 1;
    }
  }
  sched_getaffinity(0, sizeof(processors), &processors);
  pin_to(0);
  mjData* d[MAX_THREADS] = {check(mj_makeData(m))};
  const int nx = 2 * m->nv + m->na;
  double* a = check(calloc(nx * nx + 1, sizeof(double)));
  double* b = check(calloc(nx * m->nu + 1, sizeof(double)));
  char line[256];
  while (fgets(line, sizeof(line), stdin)) {
    int calls, count, steps, threads;
    if (sscanf(line, "step %d", &calls) == 1) {
      const int warm_up = calls / 8;
      generate_controls(warm_up + calls);
      start(d[0]);
      double begin = 0;
      for (int i = 0; i < warm_up + calls; i++) {
        if (i == warm_up) {
          begin = now();
        }
        set_controls(d[0], i);
        mj_step(m, d[0]);
      }
      printf("%.9e %.17e\n", now() - begin, sum(d[0]->qpos, m->nq));
    } else if (sscanf(line, "rollout %d %d %d", &count, &steps, &threads) == 3 && threads >= 1 && threads <= MAX_THREADS) {
      rollout(d, count, steps, threads);
    } else if (sscanf(line, "batch %d %d %d", &count, &calls, &threads) == 3 && threads >= 1 && threads <= MAX_THREADS) {
      batch(d, count, calls, threads);
    } else if (sscanf(line, "transition %d", &calls) == 1) {
      start(d[0]);
      mjd_transitionFD(m, d[0], 1e-6, 1, a, b, NULL, NULL);
      const double begin = now();
      for (int i = 0; i < calls; i++) {
        mjd_transitionFD(m, d[0], 1e-6, 1, a, b, NULL, NULL);
      }
      printf("%.9e %.17e\n", now() - begin, sum(a, nx * nx));
    } else {
      fprintf(stderr, "engine: unknown command %s", line);
      return 1;
    }
    fflush(stdout);
  }
  return 0;
}
