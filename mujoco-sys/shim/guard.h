// Guards for engine calls that can raise an engine error.
//
// The engine reports a fatal error by calling `mju_user_error` and relies on that call not
// returning. This handler jumps to the entry of the innermost guard of the same thread. The guards
// of a thread form a chain, because an engine callback may call the engine again.
#ifndef MUJOCO_SYS_GUARD_H_
#define MUJOCO_SYS_GUARD_H_

#include <setjmp.h>
#include <stddef.h>

#include <mujoco/mujoco.h>

#ifdef __cplusplus
extern "C" {
#endif

// Jump buffer of a guard. The compiler's built-in setjmp stores three words and makes the function
// save its registers; it takes a third of the time of the C library's. `_setjmp` is the library's
// variant that does not save the signal mask, which would cost a system call. Windows has no such
// mask. Local variables that do not change after the setjmp keep their values across the jump (C11
// 7.13.2.1).
#if defined(__x86_64__) && defined(__GNUC__) && !defined(_WIN32)
typedef void* mujoco_sys_mark[5];
#define MUJOCO_SYS_SET_MARK(mark) __builtin_setjmp(mark)
#define MUJOCO_SYS_RETURN_TO(mark) __builtin_longjmp(mark, 1)
#else
typedef jmp_buf mujoco_sys_mark;
#if defined(_WIN32)
#define MUJOCO_SYS_SET_MARK(mark) setjmp(mark)
#else
#define MUJOCO_SYS_SET_MARK(mark) _setjmp(mark)
#endif
#define MUJOCO_SYS_RETURN_TO(mark) longjmp(mark, 1)
#endif

struct mujoco_sys_guard {
  mujoco_sys_mark return_to;
  struct mujoco_sys_guard* outer;
};

// Return codes of guarded calls.
enum {
  MUJOCO_SYS_OK = 0,
  MUJOCO_SYS_ERROR = 1,          // mju_error was called; its text is in mujoco_sys_message()
  MUJOCO_SYS_OUT_OF_MEMORY = 2,  // std::bad_alloc, from the XML compiler
  MUJOCO_SYS_EXCEPTION = 3,      // another C++ exception; its text is in mujoco_sys_message()
};

// Installs the error and warning handlers and the checked collision functions, for the whole
// process. Warnings go to `warn`, or to standard error if it is NULL.
void mujoco_sys_install(void (*warn)(const char*));

// Data whose full constraint buffer is handled, whether that is an error, the number of such
// warnings, and whether a call that goes on must fail.
struct mujoco_sys_full {
  mjData* data;
  int is_fatal;
  int count;
  int has_failed;
};

// Handles a full constraint buffer of a data in this thread. The engine then removes the
// constraints, but since 2.3 not their numbers, with which its later stages would read them; this
// clears the numbers. For models with an adhesion actuator it must be an error (`is_fatal`): the
// engine accesses the constraints of each contact without checking that they exist.
//
// The engine warns only while `warning[mjWARN_CNSTRFULL].number` is zero. Writes the previous
// setting, which the caller passes to mujoco_sys_end_full after the call, because a callback of one
// model may simulate another. That function writes the number of warnings to `count`, and returns 1
// if the call must fail, although it has returned.
void mujoco_sys_begin_full(mjData* d, int is_fatal, struct mujoco_sys_full* outer);
int mujoco_sys_end_full(const struct mujoco_sys_full* outer, int* count);

// Returns the text of this thread's last caught error. Valid until the thread's next error.
const char* mujoco_sys_message(void);

// Returns the number of significant digits of the numbers that mujoco_sys_mj_saveLastXML prints.
int mujoco_sys_xml_digits(void);

// Returns 1 during a guarded call of this thread, else 0.
int mujoco_sys_is_guarded(void);

// Used by the loaders in load.cc.
void mujoco_sys_set_message(const char* text);
void mujoco_sys_after_error(void);
struct mujoco_sys_guard** mujoco_sys_innermost(void);

#ifdef __cplusplus
}
#endif

#endif
