// Engines from PyPI contain LLVM's C++ library and its unwinder, whose symbols are hidden. A
// handler in code that GNU's compiler made cannot catch their exceptions: its personality routine
// reads the context of another unwinder, and crashes. The routine of this file does not read the
// context. It reports a handler, so that the unwinder runs the destructors of the engine's frames,
// and then jumps.
#include "exception.h"

#include <stddef.h>
#include <stdint.h>

#include "guard.h"

#if defined(__linux__) && (defined(__x86_64__) || defined(__aarch64__))

struct mujoco_sys_catcher {
  mujoco_sys_mark return_to;
  struct mujoco_sys_catcher* outer;
};

static _Thread_local struct mujoco_sys_catcher* innermost;
static _Thread_local const char* caught;

struct mujoco_sys_catcher** mujoco_sys_innermost_call(void) { return &innermost; }

// Constants of the Itanium C++ ABI.
enum { SEARCH_PHASE = 1, HANDLER_FRAME = 4, HANDLER_FOUND = 6, CONTINUE_UNWIND = 8 };
// "CLNGC++" and a byte that tells whether another exception is the primary one.
#define LLVM_CLASS UINT64_C(0x434c4e47432b2b)
// Words before the unwinder's header of an exception: from its type to the header. The name is the
// second word of a type.
#define TYPE_OFFSET 10

__attribute__((visibility("hidden"), used)) int mujoco_sys_personality(int version, int actions, uint64_t class,
                                                                       void** exception, void* context) {
  (void)context;
  if (version != 1 || class >> 8 != LLVM_CLASS || !innermost) return CONTINUE_UNWIND;
  if (actions & SEARCH_PHASE) return HANDLER_FOUND;
  if (!(actions & HANDLER_FRAME)) return CONTINUE_UNWIND;
  // A dependent exception has another layout.
  const char** type = class & 0xff ? NULL : exception[-TYPE_OFFSET];
  caught = type ? type[1] : "unknown";
  MUJOCO_SYS_RETURN_TO(innermost->return_to);
}

// Calls the function in a frame with this personality routine.
void mujoco_sys_call_behind(void (*function)(void*), void* argument);

#if defined(__x86_64__)
__asm__(
    ".text\n"
    ".hidden mujoco_sys_call_behind\n"
    ".globl mujoco_sys_call_behind\n"
    ".type mujoco_sys_call_behind, @function\n"
    "mujoco_sys_call_behind:\n"
    ".cfi_startproc\n"
    ".cfi_personality 0x1b, mujoco_sys_personality\n"
    "pushq %rbp\n"
    ".cfi_def_cfa_offset 16\n"
    ".cfi_offset %rbp, -16\n"
    "movq %rsp, %rbp\n"
    ".cfi_def_cfa_register %rbp\n"
    "movq %rdi, %rax\n"
    "movq %rsi, %rdi\n"
    "callq *%rax\n"
    "popq %rbp\n"
    ".cfi_def_cfa %rsp, 8\n"
    "retq\n"
    ".cfi_endproc\n"
    ".size mujoco_sys_call_behind, . - mujoco_sys_call_behind\n");
#else
__asm__(
    ".text\n"
    ".hidden mujoco_sys_call_behind\n"
    ".globl mujoco_sys_call_behind\n"
    ".type mujoco_sys_call_behind, %function\n"
    "mujoco_sys_call_behind:\n"
    ".cfi_startproc\n"
    ".cfi_personality 0x1b, mujoco_sys_personality\n"
    "stp x29, x30, [sp, #-16]!\n"
    ".cfi_def_cfa_offset 16\n"
    ".cfi_offset x29, -16\n"
    ".cfi_offset x30, -8\n"
    "mov x29, sp\n"
    ".cfi_def_cfa_register x29\n"
    "mov x9, x0\n"
    "mov x0, x1\n"
    "blr x9\n"
    "ldp x29, x30, [sp], #16\n"
    ".cfi_def_cfa sp, 0\n"
    "ret\n"
    ".cfi_endproc\n"
    ".size mujoco_sys_call_behind, . - mujoco_sys_call_behind\n");
#endif

const char* mujoco_sys_call(void (*function)(void*), void* argument) {
  struct mujoco_sys_catcher catcher;
  catcher.outer = innermost;
  if (MUJOCO_SYS_SET_MARK(catcher.return_to)) {
    innermost = catcher.outer;
    return caught;
  }
  innermost = &catcher;
  mujoco_sys_call_behind(function, argument);
  innermost = catcher.outer;
  return NULL;
}

#else

struct mujoco_sys_catcher** mujoco_sys_innermost_call(void) {
  static _Thread_local struct mujoco_sys_catcher* none;
  return &none;
}

const char* mujoco_sys_call(void (*function)(void*), void* argument) {
  function(argument);
  return NULL;
}

#endif
