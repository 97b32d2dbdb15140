// Keywords and operations that Microsoft's C compiler names differently.
#ifndef MUJOCO_SYS_COMPILER_H_
#define MUJOCO_SYS_COMPILER_H_

#if defined(_MSC_VER) && !defined(__clang__)

#include <intrin.h>
#include <stdint.h>

#define MUJOCO_SYS_THREAD_LOCAL __declspec(thread)
#define MUJOCO_SYS_NOINLINE __declspec(noinline)
// Reads a pointer of this type that another thread may publish, and publishes a pointer.
#define MUJOCO_SYS_ACQUIRE(type, pointer) \
  ((type)(uintptr_t)_InterlockedCompareExchangePointer((void* volatile*)&(pointer), 0, 0))
#define MUJOCO_SYS_PUBLISH(pointer, value) \
  ((void)_InterlockedExchangePointer((void* volatile*)&(pointer), (void*)(uintptr_t)(value)))

#else

#define MUJOCO_SYS_THREAD_LOCAL _Thread_local
#define MUJOCO_SYS_NOINLINE __attribute__((noinline))
#define MUJOCO_SYS_ACQUIRE(type, pointer) ((type)__atomic_load_n(&(pointer), __ATOMIC_ACQUIRE))
#define MUJOCO_SYS_PUBLISH(pointer, value) __atomic_store_n(&(pointer), (value), __ATOMIC_RELEASE)

#endif

#endif  // MUJOCO_SYS_COMPILER_H_
