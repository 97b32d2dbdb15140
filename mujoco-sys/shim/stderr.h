// Capture of the calling thread's output to the C library's `stderr`.
#ifndef MUJOCO_SYS_STDERR_H_
#define MUJOCO_SYS_STDERR_H_

#include <stddef.h>

// Begins a capture in this thread and returns a mark for mujoco_sys_capture_end. Captures nest.
size_t mujoco_sys_capture_begin(void);

// Ends the capture that returned this mark. Returns the text printed since, at most 4095 bytes,
// which is valid until this thread's next capture ends.
const char* mujoco_sys_capture_end(size_t mark);

#endif
