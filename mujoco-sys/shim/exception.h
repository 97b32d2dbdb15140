// Calls of the engine that may throw.
#ifndef MUJOCO_SYS_EXCEPTION_H_
#define MUJOCO_SYS_EXCEPTION_H_

#ifdef __cplusplus
extern "C" {
#endif

struct mujoco_sys_catcher;

// Calls a function. Returns the mangled name of the type of an exception that leaves it, or NULL,
// if the exception is of LLVM's C++ library, or of Microsoft's and this file compiled by GNU's
// compiler. The frames of the function are unwound. Other exceptions pass.
const char* mujoco_sys_call(void (*function)(void*), void* argument);

// Returns the innermost call of this thread, which a jump past a call must restore.
struct mujoco_sys_catcher** mujoco_sys_innermost_call(void);

#ifdef __cplusplus
}
#endif

#endif
