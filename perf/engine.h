// Model, controls and helpers of the reference implementation in C.
#ifndef PERF_ENGINE_H
#define PERF_ENGINE_H

#define _GNU_SOURCE
#include <pthread.h>

#include <mujoco/mujoco.h>

// Maximum number of threads.
#define MAX_THREADS 64

extern mjModel* m;
// Controls of many steps, (step, nu).
extern double* controls;

// Generates the controls of `count` steps, up to a tenth of their ranges: equal in all languages.
void generate_controls(int count);

// Sets the initial state.
void start(mjData* d);

// Pins the calling thread to a processor, as all implementations do.
void pin_to(int thread);

// Returns a pointer, or ends the program if it is null.
void* check(void* p);

// Returns the time, s.
double now(void);

double sum(const double* values, int count);

// Measures `calls` steps of a batch, with one simulation for each thread, which it creates where
// `d` has none.
void batch(mjData** d, int count, int calls, int threads);

#endif
