// The guard that every call which can raise an engine error goes through.
//
// The engine reports a fatal error by calling `mju_user_error`, which must not return: the code after the call relies on
// that. The handler here jumps back to where the innermost guard of the same thread was entered. The guards of a thread
// form a chain, because a callback of the engine may enter the engine again.
#ifndef MUJOCO_SYS_GUARD_H_
#define MUJOCO_SYS_GUARD_H_

#include <stddef.h>

#include <mujoco/mujoco.h>

#ifdef __cplusplus
extern "C" {
#endif

// A way back to where a guard was entered. The compiler's own stores three words and has the function save its registers; it takes a
// third of the time of the library's. Of the latter `_setjmp` saves no signal mask, which would cost a system call. What a
// function had before the mark, and has not changed since, it has after the jump (C11 7.13.2.1).
#if defined(__x86_64__) && defined(__GNUC__) && !defined(_WIN32)
typedef void* mujoco_sys_mark[5];
#define MUJOCO_SYS_SET_MARK(mark) __builtin_setjmp(mark)
#define MUJOCO_SYS_RETURN_TO(mark) __builtin_longjmp(mark, 1)
#else
#include <setjmp.h>
typedef jmp_buf mujoco_sys_mark;
#define MUJOCO_SYS_SET_MARK(mark) _setjmp(mark)
#define MUJOCO_SYS_RETURN_TO(mark) longjmp(mark, 1)
#endif

struct mujoco_sys_guard {
  mujoco_sys_mark return_to;
  struct mujoco_sys_guard* outer;
};

// What a guarded call returns.
enum {
  MUJOCO_SYS_OK = 0,
  MUJOCO_SYS_ERROR = 1,          // mju_error was called; its text is in mujoco_sys_message()
  MUJOCO_SYS_OUT_OF_MEMORY = 2,  // std::bad_alloc, from the XML compiler
  MUJOCO_SYS_EXCEPTION = 3,      // another C++ exception; its text is in mujoco_sys_message()
};

// Makes the handlers the engine's own, for the whole process, and its collision functions checked ones. Warnings go to `warn`,
// or to standard error if it is NULL.
void mujoco_sys_install(void (*warn)(const char*));

// Whether a full constraint buffer is an error in this thread, instead of a warning. It has to be for a model with an actuator
// of the adhesion kind: the engine looks up the constraints of each contact and trusts that there are some. Returns what was so
// before, for the caller to put back: a callback of one model may simulate another.
int mujoco_sys_full_constraints_are_fatal(int fatal);

// The text of this thread's last caught error. Valid until the thread's next one.
const char* mujoco_sys_message(void);

// The number of significant digits with which mujoco_sys_mj_saveLastXML prints a number.
int mujoco_sys_xml_digits(void);

// For the loaders, which are in C++.
void mujoco_sys_set_message(const char* text);
struct mujoco_sys_guard** mujoco_sys_innermost(void);

#ifdef __cplusplus
}
#endif

#endif
