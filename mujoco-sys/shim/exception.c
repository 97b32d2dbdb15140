// Engines from PyPI contain LLVM's C++ library and its unwinder, whose symbols are hidden. A
// handler in code that GNU's compiler made cannot catch their exceptions: its personality routine
// reads the context of another unwinder, and crashes. The routine of this file does not read the
// context. It reports a handler, so that the unwinder runs the destructors of the engine's frames,
// and then jumps.
//
// Engines for Windows are compiled by Microsoft's compiler, whose exceptions are those of the
// system. Code that GNU's compiler made cannot catch them either. There the handler of a frame of
// this file jumps, which unwinds the engine's frames.
#include "exception.h"

#include <stddef.h>
#include <stdint.h>

#include "compiler.h"
#include "guard.h"

#if (defined(__linux__) && (defined(__x86_64__) || defined(__aarch64__))) || \
    (defined(_WIN32) && defined(__GNUC__) && defined(__x86_64__))

struct mujoco_sys_catcher {
  mujoco_sys_mark return_to;
  struct mujoco_sys_catcher* outer;
};

static MUJOCO_SYS_THREAD_LOCAL struct mujoco_sys_catcher* innermost;
static MUJOCO_SYS_THREAD_LOCAL const char* caught;

struct mujoco_sys_catcher** mujoco_sys_innermost_call(void) { return &innermost; }

// Calls the function in a frame with the handler of exceptions below.
void mujoco_sys_call_behind(void (*function)(void*), void* argument);

#if defined(_WIN32)

#include <windows.h>

// Returns the type's name in the description of an exception of Microsoft's compiler, in which
// addresses are relative to the library. An exception that is thrown again has no description.
static const char* type_of(const EXCEPTION_RECORD* record) {
  const char* const base = (const char*)record->ExceptionInformation[3];
  const int32_t* const thrown = (const int32_t*)record->ExceptionInformation[2];
  if (!base || !thrown || !thrown[3]) return "unknown";
  const int32_t* const types = (const int32_t*)(base + thrown[3]);
  const int32_t* const type = (const int32_t*)(base + types[1]);
  return base + type[1] + 2 * sizeof(void*);
}

__attribute__((used)) EXCEPTION_DISPOSITION mujoco_sys_on_exception(EXCEPTION_RECORD* record, void* frame,
                                                                    CONTEXT* context, void* dispatcher) {
  (void)frame, (void)context, (void)dispatcher;
  const int is_cpp = record->ExceptionCode == 0xe06d7363 && record->NumberParameters >= 4;
  const int is_unwinding = (record->ExceptionFlags & (EXCEPTION_UNWINDING | EXCEPTION_EXIT_UNWIND)) != 0;
  if (!is_cpp || is_unwinding || !innermost) return ExceptionContinueSearch;
  caught = type_of(record);
  MUJOCO_SYS_RETURN_TO(innermost->return_to);
}

__asm__(
    ".text\n"
    ".globl mujoco_sys_call_behind\n"
    ".seh_proc mujoco_sys_call_behind\n"
    "mujoco_sys_call_behind:\n"
    "subq $40, %rsp\n"
    ".seh_stackalloc 40\n"
    ".seh_handler mujoco_sys_on_exception, @except\n"
    ".seh_endprologue\n"
    "movq %rcx, %rax\n"
    "movq %rdx, %rcx\n"
    "callq *%rax\n"
    "nop\n"
    "addq $40, %rsp\n"
    "retq\n"
    ".seh_endproc\n");

#else

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
  static MUJOCO_SYS_THREAD_LOCAL struct mujoco_sys_catcher* none;
  return &none;
}

const char* mujoco_sys_call(void (*function)(void*), void* argument) {
  function(argument);
  return NULL;
}

#endif
