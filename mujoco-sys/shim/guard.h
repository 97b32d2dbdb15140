// Guards for engine calls that can raise an engine error.
//
// The engine reports a fatal error by calling `mju_user_error` and relies on that call not returning. This handler jumps to the entry of the
// innermost guard of the same thread. The guards of a thread form a chain, because an engine callback may call the engine again.
#ifndef MUJOCO_SYS_GUARD_H_
#define MUJOCO_SYS_GUARD_H_

#include <stddef.h>

#include <mujoco/mujoco.h>

#ifdef __cplusplus
extern "C" {
#endif

// Jump buffer of a guard. The compiler's built-in setjmp stores three words and makes the function save its registers; it takes a third of
// the time of the C library's. `_setjmp` is the library's variant that does not save the signal mask, which would cost a system
// call. Local variables that do not change after the setjmp keep their values across the jump (C11 7.13.2.1).
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

// Return codes of guarded calls.
enum {
  MUJOCO_SYS_OK = 0,
  MUJOCO_SYS_ERROR = 1,          // mju_error was called; its text is in mujoco_sys_message()
  MUJOCO_SYS_OUT_OF_MEMORY = 2,  // std::bad_alloc, from the XML compiler
  MUJOCO_SYS_EXCEPTION = 3,      // another C++ exception; its text is in mujoco_sys_message()
};

// Installs the error and warning handlers and the checked collision functions, for the whole process. Warnings go to `warn`, or to
// standard error if it is NULL.
void mujoco_sys_install(void (*warn)(const char*));

// Data for which a full constraint buffer is an error instead of a warning, and whether one has
// been found in a call that goes on.
struct mujoco_sys_adhesion {
  mjData* data;
  int lost;
};

// Makes a full constraint buffer of a data an error in this thread. Models with an adhesion
// actuator need this: the engine accesses the constraints of each contact without checking that
// they exist. Writes the previous setting, which the caller passes to mujoco_sys_end_adhesion after
// the call, because a callback of one model may simulate another. That function returns 1 if the
// call must fail, although it has returned.
void mujoco_sys_begin_adhesion(mjData* d, struct mujoco_sys_adhesion* outer);
int mujoco_sys_end_adhesion(const struct mujoco_sys_adhesion* outer);

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
